# SPDX-License-Identifier: MIT
"""What scripts/external counts: readers of public data, boxes, pairs of boxes."""
