# SPDX-License-Identifier: MIT
"""How long steps will take."""

from .step import duration_text


class Progress:
    """Durations of the steps that are left, by the pace of those that ended: steps with an expected duration by the
    ratio of both, others by the mean of their kind."""

    def __init__(self, left):
        self.left = list(left)
        self._real = self._expected = 0.0
        self._others = []

    def _of(self, step):
        if step.seconds is not None:
            return step.seconds * (self._real / self._expected if self._expected > 0 else 1.0)
        return sum(self._others) / len(self._others) if self._others else None

    def text(self, step):
        durations = [self._of(one) for one in self.left]
        known = [seconds for seconds in durations if seconds is not None]
        unknown = len(durations) - len(known)
        whole = [f"about {duration_text(sum(known))}"] if known else []
        whole += [f"{unknown} step{'s' * (unknown > 1)} of unknown duration"] if unknown else []
        own = self._of(step)
        own = "duration unknown" if own is None else f"about {duration_text(own)}"
        return f"{own}; all {' and '.join(whole)}"

    def ended(self, step, seconds):
        """seconds: None if it did not run."""
        self.left.remove(step)
        if seconds is None:
            return
        if step.seconds is None:
            self._others.append(seconds)
        else:
            self._real, self._expected = self._real + seconds, self._expected + step.seconds
