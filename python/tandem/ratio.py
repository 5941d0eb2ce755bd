# SPDX-License-Identifier: MIT
"""A ratio of times with its interval."""

import dataclasses


@dataclasses.dataclass(frozen=True)
class Ratio:
    """A ratio new / old, its 95 % interval, and the standard error of its logarithm. The last three are None
    where no such interval exists."""

    value: float
    low: float | None
    high: float | None
    log_error: float | None
