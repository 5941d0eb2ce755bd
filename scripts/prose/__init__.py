# SPDX-License-Identifier: MIT
"""What scripts/check_prose checks: a module a group of rules."""
