"""Limits of the work that a file may cause its reader: bytes, elements, depth and processor time, for every
kind.

Files come from unknown sources, and the cost of reading one must stay limited however it is written. Every
reader takes its limits from the table here, spends from a :class:`Budget`, and refuses a file that asks for
more. The manual's page of limits lists the same table.

Glossary
--------
element : a unit of a reader's work: an element of a drawing, a row of a table, a move of a program.
depth : number of elements that lie inside each other.
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
    """Raised for a file that asks for more work than its reader may spend.

    It ends the reading, with one exception: level faces of a solid that take too much work are left out, and
    the rest is read.
    """

    @staticmethod
    def is_behind(error: BaseException | None) -> bool:
        """Return whether an error is an OverBudgetError, or was raised from one."""
        return any(isinstance(one, OverBudgetError) for one in list_causes(error))


@frozen
class FileLimits:
    """Limits for a file of one kind.

    Parameters
    ----------
    what : phrase for such a file in messages; it is "a table" in "more than the 2 rows that a table may
        have".
    most_bytes : None where a file is read in blocks and may have any size.
    most_elements : number of elements the reader may visit, repeated ones counted each time; None for no
        limit.
    elements : word for these elements in messages, such as "rows".
    deepest : number of elements that may lie inside each other; None for no limit.
    seconds, seconds_per_million : processor time allowed is ``seconds`` plus ``seconds_per_million`` for
        every million bytes; None for no limit, when the work is proportional to the bytes.
    remedy : advice for a file that asks for more.
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
        """Return the processor seconds for a file of ``size`` bytes; None for no limit."""
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
    "freecad": FileLimits(
        "a FreeCAD file with a vise",
        PART_BYTES,
        1_000_000,
        "elements",
        100,
        SECONDS,
        remedy="save the vise in a file of its own",
    ),
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
    """The work that may still be spent on reading one file.

    Parameters
    ----------
    limits : limits for this kind of file.
    size : size of the file in bytes, from which the limit of processor time follows.

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
        """Count elements that the reader visits.

        Raises
        ------
        OverBudgetError
            When there are more than the limit, or time is up.
        """
        self.elements += elements
        self.refuse_too_many_ahead(0)
        self.count_steps(elements)

    def refuse_too_many_ahead(self, elements: int) -> None:
        """Raise OverBudgetError if ``elements`` more would exceed the limit; nothing is counted."""
        most = self.limits.most_elements
        if most is not None and self.elements + elements > most:
            raise OverBudgetError(
                f"the file has more than the {most:,} {self.limits.elements} that {self.limits.what} may "
                f"have: {self.limits.remedy}."
            )

    def count_letters(self, letters: int, label: str) -> None:
        """Count characters of a text that is part of a file; raise OverBudgetError when their total exceeds
        the number of bytes that such a file may have.

        ``label`` names the text at the beginning of the message.
        """
        self.letters += letters
        most = self.limits.most_bytes
        if most is not None and self.letters > most:
            raise OverBudgetError(
                f"{label} has more than the {most:,} letters that {self.limits.what} may have: "
                f"{self.limits.remedy}."
            )

    def count_steps(self, steps: int = 1) -> None:
        """Count steps of work that are not elements, such as comparisons; only time limits them.

        Raises
        ------
        OverBudgetError
            When time is up; it is checked every ``PERIOD`` steps.
        """
        before = self.steps // self.PERIOD
        self.steps += steps
        if self.steps // self.PERIOD > before:
            self.check_time()

    def check_time(self) -> None:
        """Raise OverBudgetError if the reader has worked on the file for longer than it may."""
        if self.seconds is not None and time.thread_time() - self.started > self.seconds:
            raise OverBudgetError(
                f"reading it was given up after {self.seconds:.0f} s, the most for {self.limits.what} of its "
                f"size: {self.limits.remedy}."
            )

    @contextmanager
    def count_nesting(self, label: str) -> Iterator[None]:
        """Count the block as one level deeper; raise OverBudgetError if that is deeper than the limit.

        ``label`` names the element at the beginning of the message.
        """
        try:
            self.enter(lambda: label)
            yield
        finally:
            self.leave()

    def enter(self, label: Callable[[], str]) -> None:
        """Count everything until :meth:`leave` as one level deeper.

        Parameters
        ----------
        label : returns the name of the element for the beginning of the message.

        Raises
        ------
        OverBudgetError
            When it is deeper than the limit.
        """
        self.depth += 1
        if self.limits.deepest is not None and self.depth > self.limits.deepest:
            raise OverBudgetError(
                f"{label()} is nested more than {self.limits.deepest} levels deep: {self.limits.remedy}."
            )

    def leave(self) -> None:
        """Undo one :meth:`enter`."""
        self.depth -= 1
