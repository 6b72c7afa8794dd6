"""Limits of what a file may ask of its reader: bytes, elements, depth and processor time, for every kind.

A file comes from anywhere, and what it costs to read must not depend on how it is written. Every reader takes
its limits from the table here, spends from a :class:`Budget`, and refuses a file that asks for more. The
manual's page of limits lists the same table.

Glossary
--------
element : what a reader goes through one by one: an element of a drawing, a row of a table, a move of a
    program.
depth : how many elements lie inside each other.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from attrs import frozen

from workhold.errors import InputError, list_causes

__all__ = ["LIMITS", "PART_BYTES", "UNLIMITED", "Budget", "FileLimits", "OverBudgetError"]

# Processor seconds for a drawing of any size: the largest plain ones take 15 s, most of them in libraries, which
# cannot be interrupted for up to 10 s.
SECONDS = 17.0
# The same for a STEP file, whose library needs more the larger it is, and for every million bytes of it.
STEP_SECONDS, STEP_SECONDS_PER_MILLION = 12.0, 2.0


class OverBudgetError(InputError):
    """A file asks for more than its reader may take; only level faces of solids go on, without the rest."""

    @staticmethod
    def is_behind(error: BaseException | None) -> bool:
        """Return whether such an error is what another was raised from, with its place."""
        return any(isinstance(one, OverBudgetError) for one in list_causes(error))


@frozen
class FileLimits:
    """How much a file of one kind may ask for.

    Parameters
    ----------
    what : such a file, in words that follow "more than a ... may".
    most_bytes : None where a file is read in blocks and may have any size.
    most_elements : how many elements the reader goes through, repeated ones counted each time.
    elements : what these are called.
    deepest : how many elements may lie inside each other.
    seconds, seconds_per_million : processor time for any such file, and for every million bytes of it; None
        where the work follows the bytes alone.
    remedy : what helps a file that asks for more.
    """

    what: str
    most_bytes: int | None
    most_elements: int | None = None
    elements: str = "elements"
    deepest: int | None = None
    seconds: float | None = None
    seconds_per_million: float = 0.0
    remedy: str = "save less in it"

    def allow_seconds_for(self, size: int) -> float | None:
        return None if self.seconds is None else self.seconds + self.seconds_per_million * size / 1e6


OUTLINE_ONLY = "save a drawing of the part's outline only"
# Reading takes about twenty times as much memory as a drawing has bytes.
PART_BYTES = 40_000_000
# A file that is read whole takes five times as much memory as it has bytes where one letter is a rare one.
WHOLE_BYTES = 50_000_000
LIMITS = {
    "svg": FileLimits(
        "an SVG drawing",
        PART_BYTES,
        250_000,
        "elements and commands of paths, those of <use> written out",
        200,
        SECONDS,
        remedy=OUTLINE_ONLY,
    ),
    # All of a drawing's together, and each style attribute; embedded fonts do not count.
    "style": FileLimits(
        "the style sheets of an SVG drawing",
        500_000,
        20_000,
        "selectors",
        10,
        remedy="write the styles as attributes",
    ),
    "dxf": FileLimits(
        "a DXF drawing",
        PART_BYTES,
        # The library takes some 10 s for them.
        100_000,
        "entities and vertices, those of blocks written out",
        50,
        SECONDS,
        remedy=OUTLINE_ONLY,
    ),
    "json": FileLimits(
        "a part in JSON",
        PART_BYTES,
        seconds=SECONDS,
        remedy="draw its outline with fewer segments",
    ),
    "step": FileLimits(
        "a STEP file",
        PART_BYTES,
        seconds=STEP_SECONDS,
        seconds_per_million=STEP_SECONDS_PER_MILLION,
    ),
    # Half a millisecond each; counted, so that a slow machine finds the same faces.
    "tops": FileLimits(
        "the level faces of a solid",
        None,
        12_000,
        "places",
        remedy="a clamp on top stands on none of the rest",
    ),
    "toolkit": FileLimits("a file that describes a toolkit", 1_000_000),
    "loads": FileLimits("a file that describes loads", 1_000_000),
    "tools": FileLimits(
        "a table of tools", 1_000_000, 10_000, "tools", remedy="give the tools of the program"
    ),
    "program": FileLimits(
        "a program",
        64_000_000,
        2_000_000,
        "moves, or blocks with those of its subprograms written out,",
        remedy="split it",
    ),
    "jobs": FileLimits("a file that describes jobs", 5_000_000, 20_000, "jobs", remedy="split it"),
    "supports": FileLimits("a file that describes supports", 120_000_000),
    "result": FileLimits(
        "a result file of another layout than workhold's own",
        WHOLE_BYTES,
        remedy="write one fixture on every line, as workhold does",
    ),
    "list": FileLimits("a list of fixtures to compare with", WHOLE_BYTES, 250_000, "fixtures"),
    # It only helps to estimate: one that asks for more is passed over.
    "measured": FileLimits("a list of how long tasks took", WHOLE_BYTES),
}
# Of data that this program has in memory already, such as a drawing of another library.
UNLIMITED = FileLimits("data in memory", None)


class Budget:
    """What reading one file may still take.

    Parameters
    ----------
    limits : of this kind of file.
    size : bytes of the file, for the processor time.

    Examples
    --------
    >>> budget = Budget(FileLimits("a table", None, 2, "rows", remedy="split it"))
    >>> budget.spend(2)
    >>> budget.spend()
    Traceback (most recent call last):
        ...
    workhold.files.budget.OverBudgetError: the file has more than the 2 rows that a table may have: split it.
    """

    # Elements after which the clock is looked at.
    PERIOD = 256

    def __init__(self, limits: FileLimits, size: int = 0) -> None:
        self.limits = limits
        self.seconds = limits.allow_seconds_for(size)
        # Only this thread's time counts: the machine may be busy, and other threads may read other files.
        self.started = time.thread_time()
        self.elements = 0
        self.letters = 0
        self.steps = 0
        self.depth = 0

    def spend(self, elements: int = 1) -> None:
        """Count elements that the reader goes through.

        Raises
        ------
        InputError
            Where there are more than the limit, or time is up.
        """
        self.elements += elements
        self.refuse_too_many_ahead(0)
        self.count_steps(elements)

    def refuse_too_many_ahead(self, elements: int) -> None:
        """Refuse elements that the reader is about to go through, where they are more than it may."""
        most = self.limits.most_elements
        if most is not None and self.elements + elements > most:
            raise OverBudgetError(
                f"the file has more than the {most:,} {self.limits.elements} that {self.limits.what} may "
                f"have: {self.limits.remedy}."
            )

    def count_letters(self, letters: int, label: str) -> None:
        """Count letters of a text that is part of a file; refuse more than such a file may have bytes.

        ``label`` is the text, in words that begin a sentence.
        """
        self.letters += letters
        most = self.limits.most_bytes
        if most is not None and self.letters > most:
            raise OverBudgetError(
                f"{label} has more than the {most:,} letters that {self.limits.what} may have: "
                f"{self.limits.remedy}."
            )

    def count_steps(self, steps: int = 1) -> None:
        """Count steps of work that are no elements, such as comparisons; only time limits them.

        Raises
        ------
        InputError
            Where time is up.
        """
        before = self.steps // self.PERIOD
        self.steps += steps
        if self.steps // self.PERIOD > before:
            self.check_time()

    def check_time(self) -> None:
        """Refuse the file if the reader has worked on it for longer than it may."""
        if self.seconds is not None and time.thread_time() - self.started > self.seconds:
            raise OverBudgetError(
                f"reading it was given up after {self.seconds:.0f} s, the most for {self.limits.what} of its "
                f"size: {self.limits.remedy}."
            )

    @contextmanager
    def count_nesting(self, label: str) -> Iterator[None]:
        """Count what is read inside as one level deeper; refuse what is deeper than the limit.

        ``label`` is the element, in words that begin a sentence.
        """
        try:
            self.enter(lambda: label)
            yield
        finally:
            self.leave()

    def enter(self, label: Callable[[], str]) -> None:
        """Count what is read from now on as one level deeper, until :meth:`leave`.

        Parameters
        ----------
        label : as in :meth:`count_nesting`, made where it is needed.

        Raises
        ------
        InputError
            Where it is deeper than the limit.
        """
        self.depth += 1
        if self.limits.deepest is not None and self.depth > self.limits.deepest:
            raise OverBudgetError(
                f"{label()} is nested more than {self.limits.deepest} levels deep: {self.limits.remedy}."
            )

    def leave(self) -> None:
        """Count what is read from now on as one level less deep."""
        self.depth -= 1
