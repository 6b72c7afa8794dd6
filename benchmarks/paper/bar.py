"""A bar on stderr: how much of the whole is done, and an estimate of the rest from what the sections took so far."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from time import perf_counter

from attrs import define, field

__all__ = ["Bar"]

WIDTH = 24
MINUTE = 60


@define
class Bar:
    """Progress over sections.

    Parameters
    ----------
    expected : seconds that each section takes, about.
    """

    expected: Mapping[str, float]
    begun: float = field(factory=perf_counter, init=False)
    finished: float = field(default=0.0, init=False)

    @property
    def whole(self) -> float:
        """Seconds expected of all sections."""
        return sum(self.expected.values()) or 1.0

    def left(self, share: float) -> float:
        """Seconds that the rest takes, at the pace so far; as expected while little is done."""
        spent = perf_counter() - self.begun
        expected = self.whole * (1.0 - share)
        pace = spent / (share * self.whole) if share * self.whole > 5.0 else 1.0
        return expected * pace

    def show(self, name: str, share: float, words: str) -> None:
        """Show how far a section has come, and what comes next."""
        done = (self.finished + share * self.expected[name]) / self.whole
        if not sys.stderr.isatty():
            return
        filled = round(WIDTH * done)
        left = clock(self.left(done))
        line = f"[{'#' * filled}{'.' * (WIDTH - filled)}] {done:4.0%}  about {left} left  {name}: {words}"
        sys.stderr.write(f"\r\x1b[2K{line[:118]}")
        sys.stderr.flush()

    def done(self, name: str, seconds: float, reason: str) -> None:
        """Tell that a section is done, or why it is not whole."""
        self.finished += self.expected[name]
        start = "\r\x1b[2K" if sys.stderr.isatty() else ""
        end = f", incomplete ({reason})" if reason else ""
        left = clock(self.left(self.finished / self.whole))
        sys.stderr.write(f"{start}{name}: {seconds:.0f} s{end}; about {left} left\n")
        sys.stderr.flush()


def clock(seconds: float) -> str:
    """Minutes and seconds."""
    minutes, rest = divmod(round(seconds), MINUTE)
    return f"{minutes}:{rest:02}"
