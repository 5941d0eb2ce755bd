# SPDX-License-Identifier: MIT
"""Tables, figures and verdicts of a folder of 'tandem paper'."""
