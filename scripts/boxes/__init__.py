# SPDX-License-Identifier: MIT
"""What scripts/external and scripts/peers count: readers of public data and of frames, boxes, pairs of boxes."""
