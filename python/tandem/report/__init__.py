# SPDX-License-Identifier: MIT
"""Records, and a scene, as one page for a browser: what 'tandem report' and 'tandem view' write."""
