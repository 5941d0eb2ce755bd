# SPDX-License-Identifier: MIT
"""Finds the settings that differ among cells, for labels of tables and figures."""


def varying(cells):
    """{(family, setting): {value: None, ...}} for settings with several values among the cells of a family,
    in order of appearance. `cells`: pairs of a family and a list of settings, each a pair of a name and a
    value."""
    values = {}
    for family, settings in cells:
        for name, value in settings:
            values.setdefault((family, name), {})[value] = None
    return {key: own for key, own in values.items() if len(own) > 1}
