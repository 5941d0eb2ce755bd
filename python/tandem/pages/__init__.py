# SPDX-License-Identifier: MIT
"""The kit of all HTML pages: frame, style, tables, figures, lists and escaping."""
