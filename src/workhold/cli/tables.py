"""Tables and sentences for the terminal."""

from __future__ import annotations

import sys
from math import degrees, hypot, pi
from typing import TYPE_CHECKING, TextIO

import typer
from attrs import define, field

from workhold.model.units import MILLIMETRE, Unit
from workhold.plain import plain, shortened

if TYPE_CHECKING:
    from workhold.geometry.face import Face
    from workhold.model.fixture import Fixture
    from workhold.model.proof import Proof, Undecided
    from workhold.model.quality import Figure
    from workhold.model.result import Result
    from workhold.model.workpiece import Workpiece

__all__ = [
    "counts_sentence",
    "face_table",
    "figure_text",
    "fixture_tables",
    "heading",
    "Table",
    "plural",
    "print_tables",
    "proof_sentences",
    "quality_table",
    "result_table",
]

# Undecided candidates that are named on the terminal.
MOST_NAMED = 3


@define
class Table:
    """Rows of words under a line of headings.

    Parameters
    ----------
    columns : the headings; a column whose heading begins with ``>`` has its content on the right.
    rows : the words, one for each column.
    """

    columns: tuple[str, ...]
    rows: list[tuple[str, ...]] = field(factory=list)

    def add_row(self, *words: str) -> None:
        """Add a row at the end."""
        self.rows.append(words)

    def lines(self) -> list[str]:
        """The table as text: the headings, a rule below them, and a line for each row."""
        right = [column.startswith(">") for column in self.columns]
        headings = tuple(column.lstrip(">") for column in self.columns)
        widths = [max(map(len, column)) for column in zip(headings, *self.rows, strict=True)]

        def line(words: tuple[str, ...]) -> str:
            pairs = zip(words, widths, right, strict=True)
            return "   ".join(f"{w:>{n}}" if at_right else f"{w:<{n}}" for w, n, at_right in pairs).rstrip()

        return [line(headings), "─" * (sum(widths) + 3 * (len(widths) - 1)), *map(line, self.rows)]


def print_tables(*parts: Table | str, stream: TextIO | None = None) -> None:
    """Print tables and sentences to a stream, stdout by default; headings are bold on a terminal."""
    stream = stream or sys.stdout
    for part in parts:
        heading, *lines = map(plain, part.lines() if isinstance(part, Table) else (shortened(part),))
        if lines and stream.isatty():
            heading = typer.style(heading, bold=True)
        stream.write("\n".join([heading, *lines]) + "\n")
    stream.flush()


def plural(count: int, word: str) -> str:
    """A number and its noun.

    >>> plural(1, "fixture"), plural(2, "fixture")
    ('1 fixture', '2 fixtures')
    """
    return f"{count} {word}" if count == 1 else f"{count} {word}s"


def counts_sentence(result: Result) -> str:
    """How many fixtures there are, of which type, and how many differ under the part's symmetry."""
    total = sum(result.found.values())
    kinds = ", ".join(f"{count} of type {kind}" for kind, count in result.found.items())
    sentence = (
        f"{plural(total, 'fixture')}: {kinds}; {sum(result.distinct.values())} distinct under the part's symmetry"
    )
    if len(result) < total:
        sentence += f"; the best {len(result)} are kept"
    return sentence


def proof_sentences(result: Result, written: str | None = None) -> list[str]:
    """The account of the search in a line, and below it the first candidates that are undecided.

    Parameters
    ----------
    written : the name of the JSON file that lists all of them, if there is one.
    """
    proof = result.proof
    if proof is None:
        return []
    lost = len(proof.undecided)
    sentence = f"{proof_head(proof, result.complete)}: {proof_counts(proof)}"
    if lost == 0:
        return [f"{sentence}, none undecided."]
    named = [f"  {undecided_words(item)}." for item in proof.undecided[:MOST_NAMED]]
    if lost > MOST_NAMED:
        others = "The other one is" if lost == MOST_NAMED + 1 else f"The other {lost - MOST_NAMED} are"
        where = f'under "proof" in {written}' if written else 'under "proof" in a JSON file written with --out'
        named.append(f"  {others} {where}.")
    return [f"{sentence}, {lost} undecided:", *named]


def proof_head(proof: Proof, complete: bool) -> str:
    """What the account proves: that all fixtures are listed, or only that those listed are fixtures."""
    if proof.cells == 0:
        # The paper's algebra does not go through ranges of orientation: its candidates come from polynomials.
        return "Proven one by one"
    if not complete:
        return "Proven so far"
    return "Not proven throughout" if proof.undecided else "Proven"


def proof_counts(proof: Proof) -> str:
    """How many candidates there were, and what became of them."""
    settled = max(proof.escalated - len(proof.undecided), 0)
    candidates = "1 candidate" if proof.candidates == 1 else f"{proof.candidates:,} candidates"
    if proof.cells == 0:
        candidates += " of the polynomials"
    return f"{candidates}, {proof.verified:,} verified, {settled:,} decided by interval arithmetic"


def undecided_words(item: Undecided) -> str:
    """One undecided candidate: where it is and why."""
    faces = ", ".join(str(face) for face in item.faces)
    return f"Type {item.type} on faces {faces} at {item.theta_deg:.6f} degrees: {item.reason}"


def result_table(result: Result, count: int, unit: Unit = MILLIMETRE) -> Table:
    """The best fixtures, one line each, with lengths in a unit."""
    opening = f">opening {unit.abbreviation}"
    figures = listed_figures(result)
    headings = [f">{heading(figure, unit)}" for figure in figures]
    table = Table((">rank", "type", "left holes", "right holes", opening, ">angle deg", *headings))
    for rank, fixture in enumerate(result[:count], 1):
        holes = {jaw: " ".join(peg.hole for peg in fixture.pegs if peg.jaw == jaw) for jaw in ("left", "right")}
        table.add_row(
            str(rank),
            fixture.type,
            holes["left"],
            holes["right"],
            unit.number(fixture.jaw_separation),
            f"{fixture.pose.theta_deg:.3f}",
            *(figure_text(figure, fixture.quality[figure.key], unit) for figure in figures),
        )
    return table


def listed_figures(result: Result) -> list[Figure]:
    """The figures of quality shown with each fixture: those it is ranked by, and the closure margin."""
    from workhold.model.quality import FIGURES

    by_key = {figure.key: figure for figure in FIGURES}
    known = result[0].quality if len(result) else {}
    keys = dict.fromkeys([*result.query.ranking, "closure_margin"])
    return [by_key[key] for key in keys if key in known]


def heading(figure: Figure, unit: Unit) -> str:
    """A figure's name and unit."""
    of = unit.abbreviation if figure.unit == "mm" else figure.unit
    return f"{figure.words} {of}".rstrip()


def figure_text(figure: Figure, value: float, unit: Unit) -> str:
    """A figure's value as a number of its unit."""
    if figure.unit == "mm":
        return unit.number(value, unit.decimals + 1)
    return f"{value:.1f}" if figure.unit == "N" else f"{value:.4f}"


def quality_table(fixture: Fixture, unit: Unit = MILLIMETRE) -> Table:
    """All figures of quality of a fixture, and what they mean."""
    from workhold.model.quality import FIGURES

    table = Table(("figure", ">value", "unit", "better", "meaning"))
    for figure in FIGURES:
        if figure.key in fixture.quality:
            of = unit.abbreviation if figure.unit == "mm" else figure.unit
            better = "more" if figure.more_is_better else "less"
            value = figure_text(figure, fixture.quality[figure.key], unit)
            table.add_row(figure.words, value, of, better, figure.meaning)
    return table


def fixture_tables(fixture: Fixture, rank: int, total: int, unit: Unit = MILLIMETRE) -> tuple[Table | str, ...]:
    """How to set up one fixture, with lengths in a unit: what to turn, and where each peg goes."""
    x, y = f">x {unit.abbreviation}", f">y {unit.abbreviation}"
    pegs = Table(("hole", "jaw", x, y, ">face", ">force per jaw force"))
    for peg in fixture.pegs:
        pegs.add_row(peg.hole, peg.jaw, unit.number(peg.x), unit.number(peg.y), str(peg.face), f"{peg.force:.3f}")
    pose = fixture.pose
    return (
        f"Fixture {rank} of {total}, type {fixture.type}",
        f"Jaw separation {unit.text(fixture.jaw_separation)}",
        f"The part is turned by {pose.theta_deg:.3f} degrees, its origin lies at {place((pose.x, pose.y), unit)} "
        f"{unit.abbreviation} from the left jaw's hole L-A1",
        pegs,
    )


def face_table(workpiece: Workpiece, unit: Unit = MILLIMETRE) -> Table:
    """The numbered faces of a part, with lengths in a unit."""
    table = Table((">face", "kind", f"size {unit.abbreviation}", "from", "to", "loop"))
    first = 0
    loop_of = {}
    for index, loop in enumerate(workpiece.loops):
        loop_of.update(dict.fromkeys(range(first, first + len(loop)), "outer" if index == 0 else f"hole {index}"))
        first += len(loop)
    for face in workpiece.faces:
        table.add_row(str(face.number), *face_words(face, unit), loop_of[face.number])
    return table


def face_words(face: Face, unit: Unit) -> tuple[str, str, str, str]:
    """Kind, size, start and end of a face, with lengths in a unit."""
    from workhold.geometry.segment import Arc

    segment = face.segment
    start, end = place(segment.start, unit), place(segment.end, unit)
    if not isinstance(segment, Arc):
        length = hypot(segment.end[0] - segment.start[0], segment.end[1] - segment.start[1])
        return "line", f"length {unit.number(length)}", start, end
    kind = "arc, convex" if segment.sign > 0 else "arc, concave"
    radius = unit.number(segment.radius)
    if segment.half_sweep > pi - 1e-9:
        return kind, f"radius {radius}, full circle", f"about {place(segment.center, unit)}", ""
    return kind, f"radius {radius}, sweep {degrees(2 * segment.half_sweep):.2f} deg", start, end


def place(point: tuple[float, float], unit: Unit) -> str:
    """The coordinates of a point in mm, as numbers of a unit."""
    return f"({unit.number(point[0])}, {unit.number(point[1])})"
