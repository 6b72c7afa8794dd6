"""What a user should read about a result: a class for each kind of note, with its data and the words for it.

A note prints as its sentence. Code that decides something reads kinds and data, never sentences. Most notes
follow from the numbers of a result, so a verification can derive which there must be. Two notes are equal
where kind and numbers are; the words that a toolkit has for its things do not count.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, Literal, get_args

from attrs import asdict, field, frozen

from workhold.errors import join_words
from workhold.fixels.toolkit import ToolkitWording

__all__ = [
    "KINDS",
    "STAGES",
    "AskedFor",
    "BestOnly",
    "ChosenOnly",
    "PushedByHand",
    "Cut",
    "FittedOutline",
    "KeptBest",
    "LeftUndecided",
    "Many",
    "MoreSystems",
    "NoFixture",
    "NoPair",
    "NoPlace",
    "Note",
    "Remark",
    "Seated",
    "Stage",
    "Stopped",
    "ToolkitsLeft",
    "UndecidedSystem",
    "make_notes",
    "round_to_two_digits",
]

# What rules the last fixtures out, from what is asked first to what is asked last: the part's shape, that no
# two pegs of one carrier touch it, that no whole set of pegs does, or that no set that touches holds it.
Stage = Literal["shape", "pair", "set", "hold"]
STAGES: tuple[Stage, ...] = get_args(Stage)


@frozen
class Note:
    """One thing to read about a result; it prints as its sentence.

    Attributes
    ----------
    kind : name of the kind in files.
    sentence : template of the sentence, with fields by name; only of kinds that have one template.
    """

    kind: ClassVar[str]
    sentence: ClassVar[str] = ""

    @property
    def words(self) -> str:
        """Sentence to print."""
        return self.sentence.format(**self.data)

    @property
    def data(self) -> dict[str, Any]:
        """ "kind" and the fields by name, without fields that equality ignores (the toolkit's words)."""
        return {"kind": self.kind, **asdict(self, filter=lambda one, _: bool(one.eq))}

    def __str__(self) -> str:
        return self.words


@frozen
class Remark(Note):
    """A sentence given as it is, without data to derive it from."""

    kind = "remark"
    sentence = "{text}"
    text: str


def make_notes(notes: Iterable[Note | str]) -> tuple[Note, ...]:
    """Return notes in the same order, each string among them made a :class:`Remark`."""
    return tuple(Remark(note) if isinstance(note, str) else note for note in notes)


@frozen
class NoFixture(Note):
    """Note on why a search finds no fixture.

    Parameters
    ----------
    stage : the step of the search that excludes the last fixtures; a toolkit may have its own words for each
        step.
    line : line of the program whose tool excludes most places for pegs; None if there is none.
    asked : names of requirements that are to blame; empty if only the part and the pitch are.
    """

    kind = "no_fixture"
    stage: Stage
    wording: ToolkitWording = field(eq=False, repr=False)
    line: int | None = None
    asked: tuple[str, ...] = ()

    @property
    def words(self) -> str:
        """Sentence for the stage, in the toolkit's own words if it has some."""
        wording, place = self.wording, STAGES.index(self.stage)
        together = f"No {wording.two} can touch the part together"
        centre = (
            "so the forces of all pegs meet in that point and nothing keeps the part from turning but friction, as in a "
            "plain vise."
        )
        if self.asked:
            with_it = f"With what was asked for ({join_words(self.asked)})"
            if self.stage == "shape":
                return (
                    f"{with_it} every place that is left for a peg lies along arcs about one centre, {centre}"
                )
            return f"{with_it} n{together[1:]}."
        if self.line is None:
            return (
                wording.reasons
                or (
                    f"Every face is an arc about one centre, {centre}",
                    f"{together}: the pitch is too large for it.",
                    f"No {wording.four} can touch the part at the same time inside their faces.",
                    f"Four pegs can touch the part at the same time, but no such set {wording.rules}.",
                )
            )[place]
        clear = f"clear of the program's tools, of which line {self.line} is most in the way."
        if wording.reasons:
            return f"{wording.reasons[place][:-1]}, {clear}"
        return (
            f"Every face that the program's tools leave, of which line {self.line} takes the most, is an arc "
            f"about one centre, {centre}",
            f"{together} {clear}",
            f"No {wording.four} can touch the part at the same time {clear}",
            f"Four pegs can touch the part at the same time, but no such set {wording.rules} {clear}",
        )[place]


@frozen
class NoPlace(Note):
    """Note that none of the ``verified`` candidates that would hold the part can stand in the toolkit.

    Parameters
    ----------
    with_body : whether a clamp has a body that a program's tools have to pass as well.
    """

    kind = "no_place"
    verified: int
    wording: ToolkitWording = field(eq=False, repr=False)
    with_body: bool = False

    @property
    def words(self) -> str:
        """Sentence to print."""
        also = ", and with its body clear of the program's tools" if self.with_body else ""
        within = f"{self.wording.within}{also}"
        return (
            f"{self.verified} {self.wording.sets} would hold the part, but none of them can stand in "
            f"{within}."
        )


@frozen
class NoPair(Note):
    """Note on why no two clamps hold the part.

    Parameters
    ----------
    seats : number of seats (locators and pose) at which pairs of clamps were tried.
    contacts : number of simultaneous contacts of the locators (or wall and locator) and one clamp.
    """

    kind = "no_pair"
    seats: int
    contacts: int

    @property
    def words(self) -> str:
        """Sentence to print."""
        if self.contacts == 0:
            return "No three locators and a clamp can touch the part at the same time inside their faces."
        if self.seats == 0:
            return (
                "Three locators and a clamp can touch the part, but there is no place for the second clamp "
                "that is needed."
            )
        return (
            f"No two clamps press the part against all three locators at any of the {self.seats} seats found."
        )


@frozen
class AskedFor(Note):
    """Note on the requirements of the query that leave no fixture; limits of the hardware are not named."""

    kind = "asked_for"
    rules: tuple[str, ...]

    @property
    def words(self) -> str:
        """Sentence to print."""
        return f"This holds with what was asked for: {join_words(self.rules)}."


@frozen
class BestOnly(Note):
    """Note that only the ``best`` fixtures were searched for, so the number of all is not known."""

    kind = "best_only"
    sentence = "Only the best {best} were sought, so how many fixtures there are in all was not counted."
    best: int


@frozen
class Cut(Note):
    """Note that a search was stopped while its fixtures were sorted or written."""

    kind = "cut"
    sentence = (
        "Stopped with {found:,} fixtures found: the best {listed:,} of them are listed; more would have taken "
        "long."
    )
    found: int
    listed: int


@frozen
class KeptBest(Note):
    """Note that a server keeps only the best of the fixtures found."""

    kind = "kept_best"
    sentence = "{found:,} fixtures were found; this server keeps the best {kept:,} of them."
    found: int
    kept: int


@frozen
class ChosenOnly(Note):
    """Note that the user has chosen some of the fixtures found."""

    kind = "chosen"
    sentence = "Of {found:,} fixtures found, {chosen:,} were chosen to be listed."
    found: int
    chosen: int


@frozen
class Stopped(Note):
    """Note that a server ended a search after its time limit."""

    kind = "stopped"
    sentence = (
        "The search was stopped after {seconds:g} s, the longest this server allows: this is a part of the "
        "fixtures only."
    )
    seconds: float


@frozen
class ToolkitsLeft(Note):
    """Note that a server ended a comparison of toolkits after its time limit."""

    kind = "toolkits_left"
    sentence = "Stopped after {seconds:g} s; the rest of the toolkits was not tried."
    seconds: float


@frozen
class Many(Note):
    """Note that only the best of about ``count`` fixtures are listed, because the query did not ask for all."""

    kind = "many"
    count: int
    listed: int

    @property
    def words(self) -> str:
        """Sentence to print."""
        about = round_to_two_digits(self.count)
        return f"There are about {about:,} fixtures: these are the best {self.listed:,}."


@frozen
class LeftUndecided(Note):
    """Note on the number of undecided candidates."""

    kind = "undecided"
    count: int

    @property
    def words(self) -> str:
        """Sentence to print."""
        some = "1 candidate is undecided" if self.count == 1 else f"{self.count} candidates are undecided"
        return (
            f"{some}: it cannot be shown whether they are fixtures; the result's proof names them with the "
            "reason."
        )


@frozen
class UndecidedSystem(Note):
    """Three left pegs, or two left and two right ones, that the algebra cannot decide.

    Parameters
    ----------
    faces : faces that the pegs touch.
    columns, rows : columns are counted from the first peg of the same jaw, rows from the first peg of all.
    """

    kind = "undecided_system"
    faces: tuple[int, ...]
    columns: tuple[int, ...]
    rows: tuple[int, ...]

    @property
    def words(self) -> str:
        """Sentence to print."""
        jaws = ["left"] * 3 if len(self.faces) == 3 else ["left", "left", "right", "right"]
        pegs = zip(jaws, self.columns, self.rows, self.faces, strict=True)
        where = [f"{jaw} column {column:+d}, row {row:+d} on face {face}" for jaw, column, row, face in pegs]
        return f"Undecided: pegs in {'; '.join(where)}."


@frozen
class MoreSystems(Note):
    """Note on the number of systems that the algebra cannot decide besides those that are named."""

    kind = "more_systems"
    sentence = "Undecided: {count} more systems of pegs and faces."
    count: int


@frozen
class FittedOutline(Note):
    """Note that the outline differs from the drawn one by up to ``departure`` mm."""

    kind = "fitted_outline"
    sentence = (
        "All that is claimed, completeness too, holds for the outline of lines and arcs, which is up to "
        "{departure:.2g} mm off the drawn one."
    )
    departure: float


@frozen
class Seated(Note):
    """Note that of the first ``looked_at`` fixtures only ``kept`` are listed, whose seating satisfies the
    query's rules.
    """

    kind = "seated"
    sentence = (
        "The seating of the first {looked_at:,} fixtures was worked out: {kept:,} of them are as asked, and no "
        "other is listed. Of fixtures beyond these nothing is known, and some may be as asked: look at more of "
        "them to see."
    )
    looked_at: int
    kept: int


@frozen
class PushedByHand(Note):
    """Note that fixtures with two clamps are not ordered by seating, although seating was asked for."""

    kind = "pushed_by_hand"
    sentence = (
        "With two clamps the part is pushed against its locators by hand, so fixtures are in the same order as "
        "without seating. How to put the part in is stated for each fixture."
    )


def round_to_two_digits(count: int) -> int:
    """Return a count rounded to two significant digits.

    >>> round_to_two_digits(2_247_282)
    2200000
    """
    return int(float(f"{count:.1e}"))


KINDS: Mapping[str, type[Note]] = {
    one.kind: one
    for one in (
        AskedFor,
        BestOnly,
        ChosenOnly,
        PushedByHand,
        Cut,
        FittedOutline,
        KeptBest,
        LeftUndecided,
        Many,
        MoreSystems,
        NoFixture,
        NoPair,
        NoPlace,
        Remark,
        Seated,
        Stopped,
        ToolkitsLeft,
        UndecidedSystem,
    )
}
