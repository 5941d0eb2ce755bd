# SPDX-License-Identifier: MIT
"""What scripts/method_drawings draws: two bodies, the methods' walks over them, and their pictures."""
