"""Progress bar of `progress=True` while a calibration is fitted."""

import sys


class Bar:
    """A bar of the stages on standard error."""

    STAGES = 4

    def __init__(self) -> None:
        self.done = 0

    def __call__(self, stage: str) -> None:
        """Shows the stage that begins."""
        self.done = min(self.done + 1, self.STAGES)
        bar = "#" * self.done + "." * (self.STAGES - self.done)
        end = "\n" if self.done == self.STAGES else ""
        print(f"\r[{bar}] {stage:<40}", end=end, file=sys.stderr, flush=True)
