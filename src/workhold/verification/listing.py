"""The claims of a result about its fixtures and their seating, number for number as in its file.

Reading a result for use drops numbers that can be recomputed, such as the pegs' x and y, and replaces missing
data by the usual values. A verification has to see every number, and which are missing. Head and lines are
read by ``files.result.parts``, the one reader of result files. Fixtures stand in a file as JSON objects
(``verification.reading``) or in columns. The search's code is not used.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain, islice
from math import degrees, nan
from pathlib import Path
from typing import Any, overload

import numpy as np
from attrs import evolve, field, frozen
from numpy.typing import NDArray

from workhold.archive import is_archive, map_archive
from workhold.asking.declaring import list_declarations
from workhold.asking.search import SearchQuestion
from workhold.errors import InputError
from workhold.files.result.bending_forms import check_bending, read_head_bendings
from workhold.files.result.fixture_forms import check_seating, read_head_seatings
from workhold.files.result.forms import Head
from workhold.files.result.hold_text import is_friction_fixture
from workhold.files.result.holds import AnyHoldPart, read_holds
from workhold.files.result.notes import find_note_faults, read_notes
from workhold.files.result.parts import HEAD, check_head, describe_columns_from_head, parse_head, read_parts
from workhold.fixels.fields import OPTIONS
from workhold.fixels.support_hardware import HARDWARE
from workhold.fixels.toolkit import Toolkit
from workhold.model.clamps import compute_force_ratios
from workhold.model.fixture import ClampPair, Fixture, Peg
from workhold.model.notes import ChosenOnly, Note
from workhold.model.part_bending import BendingFigures
from workhold.model.pose import Pose
from workhold.model.quality import list_figures_in_columns
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.search_report import ProofReport
from workhold.model.seating import Seating
from workhold.model.solid import BESIDE_TOP
from workhold.verification.reading import add_working_forces, read_fixtures
from workhold.verification.rules.hardware import ToolkitRules

__all__ = [
    "SeatingClaim",
    "WrittenListing",
    "make_claim",
    "collect_claims",
    "read_listing",
]


@frozen
class SeatingClaim:
    """The seating that a file states for a fixture.

    Parameters
    ----------
    fields : the fields as they are written.
    seating : the same as a ``Seating`` of the model, which derives some values from others again.
    """

    fields: Mapping[str, Any]
    seating: Seating

    @property
    def capture_opening(self) -> float | None:
        """The capture opening that is claimed, in mm."""
        return self.seating.capture_opening


def make_claim(fields: Any, pose: Pose, query: Query, path: Path | str, number: int) -> SeatingClaim:
    """Return the seating claim of fixture ``number`` (from 1) from the fields of its seating in the file.

    ``path`` and ``number`` are for messages.

    Raises
    ------
    InputError
        When the fields cannot be used.
    """
    seating = check_seating(fields, pose, Path(path), number)
    return SeatingClaim(fields, seating.with_toolkit(query.toolkit, query.opening))


def add_seating_claims(
    fixtures: Sequence[Fixture], query: Query, path: Path | str = "the result"
) -> list[Fixture]:
    """Return the fixtures with their seatings as ``SeatingClaim``; given are fields of a file or a
    ``Seating``.

    Raises
    ------
    InputError
        When the fields of a seating cannot be used.
    """
    out = list(fixtures)
    for place, fixture in enumerate(out):
        seating = fixture.seating
        if seating is not None:
            fields = seating.to_fields() if isinstance(seating, Seating) else seating
            out[place] = evolve(fixture, seating=make_claim(fields, fixture.pose, query, path, place + 1))
    return out


def check_bendings(fixtures: Sequence[Fixture], path: Path | str) -> list[Fixture]:
    """Return the fixtures of a file, which have its fields of bending, with these as objects of the model.

    Raises
    ------
    InputError
        When the fields of a bending cannot be used.
    """
    return [
        fixture
        if fixture.bent is None
        else evolve(fixture, bent=check_bending(fixture.bent, Path(path), number))
        for number, fixture in enumerate(fixtures, 1)
    ]


Columns = Mapping[str, NDArray[Any]]

# Fixtures looked at together.
BLOCK = 1 << 14
LARGEST = 1e300
# Decimals of an angle in degrees.
DECIMALS = 10


@frozen(eq=False)
class FixturesInColumns(Sequence[Fixture]):
    """The fixtures of a file in columns, as a sequence that makes each fixture when it is asked for.

    The pegs of each fixture stand in holes of ``toolkit``, in the order of its type.

    Raises
    ------
    InputError
        When a fixture has an unknown type or a value that is not a number.
    """

    columns: Columns
    toolkit: Toolkit
    claims: tuple[SeatingClaim, ...] = ()
    bending: Mapping[int, BendingFigures] = field(factory=dict)

    def __attrs_post_init__(self) -> None:
        for start in range(0, len(self), BLOCK):
            block = {name: values[start : start + BLOCK] for name, values in self.columns.items()}
            usable = np.isin(block["arrangement"], range(len(self.toolkit.arrangements)))
            for name in ("theta", "position", "jaw_separation", "force"):
                usable &= (np.abs(block[name]).reshape(len(usable), -1) <= LARGEST).all(axis=1)
            usable &= ~np.isinf(block["quality"]).any(axis=1)
            if not usable.all():
                number = start + int(np.argmin(usable)) + 1
                raise InputError(f"number {number} in fixtures: it has no type, or a number that is none.")

    def __len__(self) -> int:
        return len(self.columns["arrangement"])

    def __iter__(self) -> Iterator[Fixture]:
        return (self[place] for place in range(len(self)))

    @overload
    def __getitem__(self, place: int) -> Fixture: ...

    @overload
    def __getitem__(self, place: slice) -> list[Fixture]: ...

    def __getitem__(self, place: int | slice) -> Fixture | list[Fixture]:
        if isinstance(place, slice):
            return [self[k] for k in range(len(self))[place]]
        made = self.make_fixture(place)
        # A place from the end is one from the start.
        place %= len(self)
        if place in self.bending:
            made = evolve(made, bent=self.bending[place])
        return evolve(made, seating=self.claims[place]) if place < len(self.claims) else made

    def make_fixture(self, place: int) -> Fixture:
        """Return the fixture at index ``place``, without its seating; numbers
        that columns do not hold are NaN.
        """
        numbers = {name: values[place].tolist() for name, values in self.columns.items()}
        arrangement, travelled = self.toolkit.arrangements[numbers["arrangement"]], numbers["jaw_separation"]
        pegs, pairs = [], isinstance(travelled, list)
        carriers = arrangement.carriers
        travels = [0.0] * (len(carriers) - 2) + travelled if pairs else [travelled] * len(carriers)
        each = (numbers[name] for name in ("column", "row", "face", "force"))
        for carrier, along, column, row, face, force in zip(carriers, travels, *each, strict=True):
            one = self.toolkit.carriers[carrier]
            x, y = one.compute_hole_center(column, row, along)
            if not one.contact.is_placed:
                # Where the part lies on it follows from the pose, and is not written.
                x = nan
            called = None if one.on is None or min(column, row) < 0 else one.name_place(column, row)
            # Nor which way a flat looks.
            looks = None if one.flat is None else nan
            pegs.append(
                Peg(one.name, column, row, x, y, face, 0.0 if pairs else force, called, flat_deg=looks)
            )
        pose = Pose(round(degrees(numbers["theta"]), DECIMALS), *numbers["position"])
        figures = zip(list_figures_in_columns(len(numbers["quality"])), numbers["quality"], strict=True)
        known = {figure.key: value for figure, value in figures if value == value}
        if not pairs:
            return Fixture(arrangement.name, tuple(pegs), pose, travelled, known, arrangement.direction)
        # The ends of its ratio follow from the reactions, and are not written.
        low, high = (float(end[0]) for end in compute_force_ratios(np.array([numbers["force"]])))
        reactions = tuple((one, other) for one, other in numbers["force"])
        pair = ClampPair((travelled[0], travelled[1]), (low, high), reactions, numbers["pairs"])
        listed = Fixture(arrangement.name, tuple(pegs), pose, travelled[0], known, arrangement.direction)
        return add_working_forces(listed, pair)


@frozen(eq=False)
class WrittenListing:
    """A result as written in its file.

    Parameters
    ----------
    query : the query.
    fixtures : as listed.
    counts, found, distinct : numbers of fixtures by type, as written.
    complete, notes, statistics, proof, pairs, seats, least_effective_error, bent_by : see ``Result``.
    faults : contradictions in the head of the file, one sentence each.
    """

    query: Query
    fixtures: Sequence[Fixture]
    counts: Mapping[str, int]
    found: Mapping[str, int]
    distinct: Mapping[str, int]
    complete: bool
    notes: Sequence[Note]
    statistics: Mapping[str, int]
    proof: ProofReport | None
    faults: tuple[str, ...] = ()
    pairs: int | None = None
    seats: int | None = None
    least_effective_error: float | None = None
    bent_by: str | None = None

    @property
    def is_whole(self) -> bool:
        """Whether the search was complete and every fixture found is listed."""
        return self.complete and dict(self.found) == dict(self.counts) and self.query.best is None

    @property
    def is_chosen(self) -> bool:
        """Whether a note says that somebody chose the listed fixtures. Then no claim is made about the
        others.
        """
        return ChosenOnly(sum(self.found.values()), len(self.fixtures)) in self.notes

    @property
    def hardware(self) -> ToolkitRules:
        return ToolkitRules.from_query(self.query)

    @property
    def bent_count(self) -> int:
        """Number of fixtures that are listed first, in an order of bending; 0 of a file in the usual order."""
        return 0 if self.bent_by is None else sum(fixture.bent is not None for fixture in self.fixtures)

    def find_bent_faults(self) -> Iterator[str]:
        """Yield one sentence where fixtures are not in the order of the figure of bending that the file names.

        Those whose bending is stated come first, the least first.
        """
        count, by = self.bent_count, self.bent_by
        if by is None:
            return
        if not count:
            yield f"fixtures are listed by {by}, and none has it"
        values = list[float]()
        for place, fixture in enumerate(self.fixtures[:count], 1):
            figure = None if fixture.bent is None else fixture.bent.figures.get(by)
            if figure is None:
                yield f"fixtures are listed by {by}, and fixture {place} does not have it"
                return
            if values and figure < values[-1]:
                yield f"fixture {place} has a smaller {by} than the one before it"
                return
            values.append(figure)


def collect_claims(result: Result) -> WrittenListing:
    """Return the claims of a result that is in memory, not in a file."""
    return WrittenListing(
        result.query,
        add_seating_claims(list(result), result.query),
        result.counts,
        result.found,
        result.distinct,
        result.complete,
        result.notes,
        result.statistics,
        result.proof,
        pairs=result.pairs,
        seats=result.seats,
        least_effective_error=result.least_effective_error,
        bent_by=result.bent_by,
    )


def read_listing(path: str | Path) -> WrittenListing:
    """Return the claims of a result file.

    Raises
    ------
    InputError
        When the file cannot be read, is not a result file, or describes no usable workpiece or toolkit.
    """
    path = Path(path)
    head, taken, seatings, bendings = read_head_and_fixtures(path)
    try:
        query = head.to_query()
        types, notes = query.toolkit.types, read_notes(head, query)
        return WrittenListing(
            query,
            make_friction_fixtures(taken, query)
            if query.toolkit.holds_by_friction
            else complete_fixtures(taken, seatings, bendings, ToolkitRules.from_query(query), query, path),
            read_counts_by_type(head.counts, "counts", types),
            read_counts_by_type(head.found, "found", types, head.counts),
            read_counts_by_type(head.distinct, "distinct", types, head.counts),
            head.complete,
            notes,
            head.statistics,
            None if head.proof is None else head.proof.to_proof(),
            (
                *find_missing_keys(head),
                *find_turned_loops(head.workpiece.loops, query),
                *find_note_faults(head, notes),
            ),
            head.pairs,
            head.seats,
            head.least_effective_error,
            head.bent_by,
        )
    except InputError as error:
        raise InputError(f"{path} cannot be verified: {error}") from error


def make_friction_fixtures(taken: Any, query: Query) -> list[Fixture]:
    """Return the fixtures of flat jaws or of straps; ``taken`` is what ``read_head_and_fixtures`` returned as
    fixtures.

    Raises
    ------
    InputError
        When they are fixtures of another kind.
    """
    if not isinstance(taken, list) or not all(isinstance(one, AnyHoldPart) for one in taken):
        raise InputError(f"its fixtures are not those of a {query.toolkit.noun}.")
    return [
        evolve(
            part.to_fixture(query.toolkit, query.unit_force),
            bent=None if part.bending is None else part.bending.to_figures(),
        )
        for part in taken
    ]


def read_head_and_fixtures(
    path: Path,
) -> tuple[Head, list[Fixture] | list[AnyHoldPart] | Columns, list[Any], dict[int, Any]]:
    """Return (head of a file, its fixtures or columns, seatings, bendings by index).

    The seatings are those of the first fixtures of a file in columns; they and the bendings are empty for a file with a
    fixture in each line, where each fixture holds its own.
    """
    try:
        if is_archive(path):
            # All of it is read once, to compare its checksums.
            text, columns = map_archive(path, describe_columns_from_head, HEAD, whole=True)
            data = parse_head(text)
            bendings = read_head_bendings(data, path, len(columns["arrangement"]))
            return check_head(data, path), columns, read_head_seatings(data, path), bendings
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}.") from error
    return *read_parts(path, read_any_fixtures), [], {}


def read_any_fixtures(items: Iterable[Any], path: Path) -> list[Fixture] | list[AnyHoldPart]:
    """Return the fixtures with pegs, of flat jaws or of straps; the first item decides which."""
    iterator = iter(items)
    first = list(islice(iterator, 1))
    together = chain(first, iterator)
    return (
        read_holds(together, path)
        if first and is_friction_fixture(first[0])
        else read_fixtures(together, path)
    )


def complete_fixtures(
    fixtures: list[Fixture] | list[AnyHoldPart] | Columns,
    seatings: Sequence[Any],
    bendings: Mapping[int, Any],
    hardware: ToolkitRules,
    query: Query,
    path: Path,
) -> Sequence[Fixture]:
    """Return the fixtures, with the travels of their clamps, their seating claims and their bending added.

    ``seatings`` are those of the first fixtures of a file in columns, ``bendings`` those by index.

    Raises
    ------
    InputError
        When a fixture is of another kind, or a seating cannot be used.
    """
    if not isinstance(fixtures, list):
        listed = FixturesInColumns(fixtures, hardware.toolkit)
        if len(seatings) > len(listed):
            raise InputError(
                f"the seating of {len(seatings)} fixtures is stated, but {len(listed)} are listed."
            )
        poses = [fixture.pose for fixture in listed[: len(seatings)]]
        numbered = enumerate(zip(seatings, poses, strict=True), 1)
        claims = tuple(make_claim(fields, pose, query, path, k) for k, (fields, pose) in numbered)
        bending = {row: check_bending(one, path, row + 1) for row, one in bendings.items()}
        return evolve(listed, claims=claims, bending=bending)
    out = []
    for number, fixture in enumerate(fixtures, 1):
        if not isinstance(fixture, Fixture):
            raise InputError(f"its fixtures are not those of a {query.toolkit.noun}.")
        try:
            out.append(hardware.complete_fixture(fixture))
        except InputError as error:
            raise InputError(f"fixture {number} cannot be used: {error}.") from error
    return check_bendings(add_seating_claims(out, query, path), path)


def find_missing_keys(head: Head) -> list[str]:
    """Return one sentence for each key that the file's form requires and the head lacks.

    For such a key a reader would silently take the default.
    """
    # Of a vise and a toolkit one is enough, a missing account is named in any case, and a fit decides
    # nothing. A departure counts in the tolerance of the faces, which is there.
    spared = {"toolkit" if head.toolkit is None else "vise", "proof", "tolerance.fit"}
    # Where nobody counted pairs and seats a note says so, for which the account looks.
    spared |= {"workpiece.departure", "tolerance.departure", "pairs", "seats", "thickness"}
    spared |= {"restrictions.touch", "max_location_error"}
    # Where steps count, its absence is a fault of the order.
    spared |= {"least_effective_error"}
    # Few files are in an order of bending.
    spared |= {"bent_by"}
    # What acts along z, and how high, is written where it is said.
    spared |= {f"loads.{number}.{key}" for number in range(len(head.loads)) for key in ("upward", "height")}
    # Only of a raw block is there a part inside.
    of_part = (f"workpiece.finished.{key}" for key in type(head.workpiece).model_fields)
    spared |= {"raw", "workpiece.finished", *of_part}
    # An older file has the sentences alone.
    spared |= {"note_data"}
    # A toolkit without flats, or heights of its own, says nothing of them.
    silent = [row.name for row in OPTIONS if row.is_silent] + list(HARDWARE)
    spared |= {f"{key}.{name}" for key in ("vise", "toolkit") for name in silent}
    # A prism has no solid, and where the bands are there, nothing rests on the numbers of the solid's faces.
    roles = () if head.outlines is None else tuple(head.outlines)
    spared |= {f"outlines.{role}.{key}" for role in roles for key in ("solid_faces", "runs")}
    spared |= set() if roles else {"outlines"}
    spared |= {
        "workpiece.solid_faces",
        "workpiece.runs",
        "workpiece.bottom",
        "workpiece.top",
        "workpiece.top_heights",
        "workpiece.unclear_heights",
        *(f"workpiece.{key}" for key in BESIDE_TOP),
    } | ({"solid", "workpiece.bands"} if head.solid is None else set())
    has_pairs = getattr(head.toolkit, "clamps", 1) > 1
    stated = {"contact_margin", "best", "jaw_force"} | ({"listing"} if has_pairs else set())
    if getattr(head, "seating", None) is not None:
        stated |= {"seating", "opening", "foolproof"}
    # Flat jaws are as high as they are.
    if head.program is not None and not hasattr(head.toolkit, "jaw_height"):
        stated.add("peg_height")
    spared |= {row.name for row in list_declarations(SearchQuestion)} - stated
    spared |= set() if has_pairs else {"toolkit.clamps"}
    spared |= {"program"} if head.program is None else set()
    return [f"the key {key} is missing" for key in head.list_keys_not_given() if key not in spared]


def read_counts_by_type(
    counts: Mapping[str, int] | None, key: str, types: Sequence[str], usual: Mapping[str, int] | None = None
) -> Mapping[str, int]:
    """Return the numbers of fixtures by type; ``usual`` if ``counts`` is None.

    ``key`` names the numbers in messages.

    Raises
    ------
    InputError
        When the keys are not exactly ``types``.
    """
    counts = usual if counts is None else counts
    if counts is None or set(counts) != set(types):
        raise InputError(
            f"{key} does not give a number for each of the types {', '.join(types)} and no other."
        )
    return counts


def find_turned_loops(loops: Sequence[Any], query: Query) -> list[str]:
    """Return one sentence for each loop, numbered from 0, that does not have the material on its left.

    A reader reverses such a loop, which makes the numbers of its segments ambiguous.
    """
    return [
        f"loop {index} does not have the material on its left"
        for index, (written, used) in enumerate(zip(loops, query.workpiece.loops, strict=True))
        if written != used.tolist()
    ]
