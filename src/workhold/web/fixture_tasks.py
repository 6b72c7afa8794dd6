"""Tasks of workers about one fixture: files to download, its seating, and closings of the jaws.

Files to download are called papers: setup sheets, drawings for the CAM system and pictures.
"""

from __future__ import annotations

from collections.abc import Callable
from hashlib import sha256
from importlib.util import find_spec
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from attrs import evolve, frozen
from pydantic import Field

from workhold.asking.declaring import collect_declared_values
from workhold.asking.sheet import SheetQuestion
from workhold.drawing.scene import LengthUnit
from workhold.drawing.seating_words import SeatingSentences
from workhold.drawing.seats import write_caption
from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.pose import Pose
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.seating import Seating
from workhold.model.support_triples import ChosenSupports
from workhold.model.workpiece import Workpiece
from workhold.presenting.data import convert_finite
from workhold.seating.clamping import HandLoading, plan_hand_loading
from workhold.seating.pattern import Pattern
from workhold.units import Unit, find_unit
from workhold.web.request_forms import LARGEST, ChosenSupportsForm, Form, Number
from workhold.web.support_tasks import SupportsOrder, choose_supports
from workhold.web.worker import TaskContext

if TYPE_CHECKING:
    from workhold.files.step.part_shape import PartShape
    from workhold.model.requirements import Load

__all__ = [
    "AT_ONCE",
    "KINDS",
    "OF_BODIES",
    "Before",
    "ClosingForm",
    "ClosingOrder",
    "PaperOrder",
    "simulate_closing",
    "find_seating",
    "has_step",
    "make_paper",
    "describe_seating",
]

# What another set-up was asked for, and its fixture.
Before = tuple[Query, Fixture]
# What is made while a search goes on, too.
AT_ONCE = ("picture.svg", "assembly.glb")
# What shows the shape of the part.
OF_BODIES = ("setup.step", "assembly.glb")


@frozen(eq=False)
class PaperOrder:
    """An order of a paper of a fixture.

    Parameters
    ----------
    kind : one of :data:`KINDS`.
    result : for a sheet the whole result, since the sheet refers to other fixtures; else a result with this
        fixture only.
    rank, count : rank of the fixture, from 1, and number of all fixtures.
    question : contents of a sheet or a set-up.
    unit : unit of lengths.
    loads : loads used instead of the result's; None for the result's.
    result_hash : hash of the result's file; None where it is not known yet.
    supports : supports and clamp on top that are asked for, and the number of the set; None for none.
    before : previous set-up, on the part's other side; None for none.
    shape : shape of the part from its own file; None to show a prism.
    """

    kind: str
    result: Result
    rank: int
    count: int
    question: SheetQuestion
    unit: Unit
    loads: tuple[Load, ...] | None
    result_hash: str | None
    supports: ChosenSupportsForm | None = None
    before: Before | None = None
    shape: PartShape | None = None

    @property
    def index(self) -> int:
        """Index of the fixture in ``result``."""
        return self.rank - 1 if len(self.result) == self.count else 0

    @property
    def fixture(self) -> Fixture:
        """The fixture."""
        return self.result[self.index]

    def find_chosen_supports(self) -> ChosenSupports | None:
        """Return the chosen set of supports; None where no supports are asked for, or none hold the part."""
        if self.supports is None:
            return None
        asked = SupportsOrder(self.fixture, self.result.query, self.supports)
        return choose_supports(asked, self.supports.chosen)


def has_step() -> bool:
    """Return whether STEP files can be read and written: whether OCP is installed."""
    return find_spec("OCP") is not None


def make_paper(payload: PaperOrder, order: TaskContext) -> tuple[bytes, str | None]:
    """Return the bytes of the paper ordered, and the hash of the result's file if it was needed, else None."""
    return KINDS[payload.kind][1](payload)


def make_sheet_file(order: PaperOrder) -> tuple[bytes, str | None]:
    """Return (content of a setup sheet, hash of the result's file)."""
    from workhold.drawing.sheet import draw_setup_sheet
    from workhold.model.first_side import compare_with_first_side
    from workhold.presenting.papers import make_pages_file

    digest = order.result_hash or compute_hash(order.result)
    asked: dict[str, Any] = collect_declared_values(order.question) | {
        "loads": order.loads,
        "unit": order.unit,
    }
    chosen = order.find_chosen_supports()
    if chosen is not None:
        asked |= {"supports": chosen, "thickness": chosen.supports.request.thickness}
    if order.before is not None:
        asked["first_side"] = compare_with_first_side(order.fixture, order.result.query, *order.before)
    if order.question.material is not None:
        from workhold.presenting.bent import compute_sheet_bending

        asked["bending"] = compute_sheet_bending(order.fixture, asked, order.shape)
    pages = draw_setup_sheet(order.result, order.rank, result_hash=digest, **asked)
    assert order.question.day is not None
    return make_pages_file(pages, Path(order.kind).suffix, order.question.day), digest


def compute_hash(result: Result) -> str:
    """Return the SHA-256, in hexadecimal, of the file that the result would be saved in."""
    from workhold.files.result.writer import write_result_text

    digest = sha256()
    for text in write_result_text(result):
        digest.update(text.encode("utf-8"))
    return digest.hexdigest()


def make_setup_file(order: PaperOrder) -> tuple[bytes, str | None]:
    """Return (content of a set-up for CAM or of a list of pins, None)."""
    from workhold.presenting.papers import make_model_file

    ending = Path(order.kind).suffix
    if ending == ".step" and not has_step():
        from workhold.files.step.library import REQUIREMENT

        raise InputError(
            f"this server writes no STEP files: take the DXF, or install {REQUIREMENT} beside it."
        )
    settings = collect_declared_values(order.question) | {"unit": order.unit}
    if ending == ".csv":
        settings["zero"] = None
    chosen = order.find_chosen_supports() if ending == ".step" else None
    if chosen is not None:
        settings |= {"supports": chosen, "thickness": None}
    settings["shape"] = order.shape
    return make_model_file(order.fixture, order.result, ending, settings), None


def make_picture_file(order: PaperOrder) -> tuple[bytes, str | None]:
    """Return (picture of the fixture as SVG, None)."""
    from workhold.drawing.fixture_pictures import draw_fixture
    from workhold.drawing.path_drawn import make_planned_path
    from workhold.model.moved_setup import find_move_to_middle, move_fixture_by_holes

    result = order.result
    title = f"Fixture {order.rank} of {order.count}"
    path, move = (
        make_planned_path(result, order.index),
        find_move_to_middle(order.fixture, result.toolkit, result.workpiece),
    )
    fixture = move_fixture_by_holes(order.fixture, result.toolkit, move)
    path = None if path is None else evolve(path, fixture=fixture)
    svg = draw_fixture(fixture, result.workpiece, result.toolkit, title=title, path=path)
    return svg.encode("utf-8"), None


def make_bodies_file(order: PaperOrder) -> tuple[bytes, str | None]:
    """Return (content of a GLB file with the fixture, None)."""
    from workhold.presenting.assembly import Assembly

    chosen = order.find_chosen_supports()
    names = ("peg_length", "peg_height", *(("thickness",) if chosen is None else ()))
    lengths = {name: getattr(order.question, name) for name in names}
    assembly = Assembly.from_fixture(order.fixture, order.result, lengths, chosen, order.shape)
    if order.question.material is not None and chosen is None:
        from workhold.presenting.bent import compute_sheet_bending, make_bent_glb

        bending = compute_sheet_bending(order.fixture, collect_declared_values(order.question), order.shape)
        assert bending is not None
        return make_bent_glb(order.fixture, bending), None
    return assembly.make_file_content(".glb"), None


# What can be made: its content type, and what makes it.
KINDS: dict[str, tuple[str, Callable[[PaperOrder], tuple[bytes, str | None]]]] = {
    "sheet.pdf": ("application/pdf", make_sheet_file),
    "sheet.svg": ("image/svg+xml", make_sheet_file),
    "setup.dxf": ("image/vnd.dxf", make_setup_file),
    "setup.step": ("model/step", make_setup_file),
    "picture.svg": ("image/svg+xml", make_picture_file),
    "pins.csv": ("text/csv; charset=utf-8", make_setup_file),
    "assembly.glb": ("model/gltf-binary", make_bodies_file),
}


# A fixture and what it is of.
Held = tuple[Fixture, Workpiece, Toolkit]


class ClosingForm(Form):
    """The place of the part and the opening of the jaws at the start, in mm and degrees.

    ``turned_over`` tells that the part is turned over (x to -x in its own frame). The opening is 0 where the
    jaws hold the part; it is the distance that a clamp is drawn back. The unit is used for lengths in
    sentences.
    """

    theta_deg: Number
    x: Number
    y: Number
    opening: Annotated[float, Field(ge=0, le=LARGEST)]
    turned_over: bool = False
    unit: Literal["mm", "inch"] = "mm"


@frozen(eq=False)
class ClosingOrder:
    """An order to simulate a closing.

    Parameters
    ----------
    held : the fixture with part and toolkit.
    seating : its seating.
    form : where the part was put, and how far the jaws are open.
    """

    held: Held
    seating: Seating
    form: ClosingForm


def make_seating_sentences(held: Held, seating: Seating, unit: str) -> SeatingSentences:
    """Return an object that writes sentences about a seating, with lengths in the unit."""
    return SeatingSentences(seating, held[0], held[2], make_length_unit(held, unit))


def make_length_unit(held: Held, unit: str) -> LengthUnit:
    """Return the unit of lengths by name, with decimals that suit the toolkit's pitch."""
    return LengthUnit.from_typical_length(
        find_unit(unit), min(min(carrier.pitch) for carrier in held[2].carriers)
    )


def find_seating(held: Held, order: TaskContext) -> Seating | HandLoading:
    """Return the seating of a fixture, from the result if it is there, else computed now.

    For two clamps, return the steps of putting the part in by hand.
    """
    from workhold.seating.solver import SeatingSolver

    fixture, workpiece, toolkit = held
    if not toolkit.closes_at_once:
        return plan_hand_loading(fixture, workpiece, toolkit)
    seating: Seating = fixture.seating or SeatingSolver(workpiece, toolkit).solve(fixture)
    return seating


def describe_seating(held: Held, seating: Seating | HandLoading, unit: str) -> dict[str, Any]:
    """Return a seating as plain data: the fields of a result file, and further fields below; for two clamps
    only ``by_hand``.

    ``own`` is the index in ``seats`` of the fixture's own seat; ``nearest`` are the indices of the wrong
    seats within reach, the one whose reading is closest to the own one first. ``clamping`` is 1 if
    ``jaw_separation`` falls while the part is clamped, -1 if it rises. ``widest`` is the largest opening in
    mm, counted from where the jaws hold the part. ``done`` is a word for opened, and ``captions`` are lines
    of text for each seat.
    """
    if isinstance(seating, HandLoading):
        return {"by_hand": seating.to_fields(make_length_unit(held, unit).format_length)}
    words, seats = make_seating_sentences(held, seating, unit), list(seating.seats)
    travel = words.gauge.carrier.travel
    assert travel is not None
    # Of what clamps by opening, pegs that meet are the end.
    end = travel.most if seating.clamping > 0 and travel.most is not None else inf
    widest = min(Pattern.from_fixture(held[0], held[2]).widest, end) - seating.clamping * held[0].travel
    return {
        **seating.to_fields(),
        "own": seats.index(words.own),
        "nearest": [seats.index(seat) for seat in words.wrong],
        "clamping": seating.clamping,
        "widest": convert_finite(widest),
        "done": words.gauge.opening_words.done,
        "captions": [write_caption(words, seat) for seat in seats],
        "steps": words.list_steps(held[1]),
        "words": words.describe_wrong_seats(),
    }


def simulate_closing(payload: ClosingOrder, order: TaskContext) -> dict[str, Any] | None:
    """Return the path, the ending and the words of a simulated closing; None if it was cancelled.

    "way" has rows [degrees, x, y, opening] in mm; "seat" is an index in the seating's seats, or None.
    """
    from workhold.seating.closing_simulation import simulate_closing
    from workhold.seating.solver import SeatingSolver

    form, seating = payload.form, payload.seating
    fixture, workpiece, toolkit = payload.held
    pose = Pose(form.theta_deg, form.x, form.y)
    closed = simulate_closing(
        SeatingSolver(workpiece, toolkit),
        fixture,
        seating.seats,
        pose,
        form.opening,
        form.turned_over,
        order.cancel.is_set,
    )
    if order.cancel.is_set():
        return None
    opened = [seating.clamping * (travelled - fixture.travel) for travelled in closed.travels]
    return {
        "way": [[one.theta_deg, one.x, one.y, more] for one, more in zip(closed.poses, opened, strict=True)],
        "ending": closed.ending,
        "seat": None if closed.seat is None else seating.seats.index(closed.seat),
        "words": make_seating_sentences(payload.held, seating, form.unit).describe_ending(
            closed.ending, closed.seat, closed.travels[-1]
        ),
    }
