# SPDX-License-Identifier: MIT
"""Writes records and a scene as one page for a browser, for 'tandem report' and 'tandem view'."""
