# SPDX-License-Identifier: MIT
"""Settings that differ among cells: what labels of tables and figures name."""


def varying(cells):
    """{(family, setting): {value: None, ...}} of settings with several values among the cells of a family, in order of appearance.
    `cells` are pairs of a family and its settings, which are pairs of a name and a value."""
    values = {}
    for family, settings in cells:
        for name, value in settings:
            values.setdefault((family, name), {})[value] = None
    return {key: own for key, own in values.items() if len(own) > 1}
