"""Tasks that make something to take away: setup sheets, drawings for the CAM system, pictures."""

from __future__ import annotations

from collections.abc import Callable
from datetime import date
from hashlib import sha256
from importlib.util import find_spec
from typing import Any

from attrs import frozen

from workhold.errors import InputError
from workhold.model.fixture import Fixture
from workhold.model.result import Result
from workhold.web.worker import Order

__all__ = ["KINDS", "PaperOrder", "has_step", "make_paper"]

# What can be made: its content type.
KINDS = {
    "sheet.pdf": "application/pdf",
    "sheet.svg": "image/svg+xml",
    "setup.dxf": "image/vnd.dxf",
    "setup.step": "model/step",
    "picture.svg": "image/svg+xml",
    "pins.csv": "text/csv; charset=utf-8",
}


@frozen(eq=False)
class PaperOrder:
    """What to make of which fixture.

    Parameters
    ----------
    kind : one of :data:`KINDS`.
    result : all fixtures for a sheet, which tells of the others; else one of no other.
    rank, count : of the fixture, from 1, and how many there are.
    paper : "a4" or "letter".
    unit : "mm" or "inch".
    day : written on the sheet.
    wishes : what is asked of a sheet or a set-up, named as in :func:`workhold.drawing.result_sheet.result_details` and
        :func:`workhold.files.dxf.setup.setup_dxf`; lengths in mm.
    result_hash : of the result's file, or None where it is not known yet.
    """

    kind: str
    result: Result
    rank: int
    count: int
    paper: str
    unit: str
    day: date
    wishes: dict[str, Any]
    result_hash: str | None

    @classmethod
    def of(cls, kind: str, result: Result, rank: int, *options: Any) -> PaperOrder:
        """An order that carries no more of a result than is needed."""
        small = result
        if not kind.startswith("sheet"):
            small = result.part(slice(rank - 1, rank))
        return cls(kind, small, rank, len(result), *options)

    @property
    def fixture(self) -> Fixture:
        """The fixture."""
        return self.result[self.rank - 1 if len(self.result) == self.count else 0]


def has_step() -> bool:
    """Whether STEP files can be read and written."""
    return find_spec("OCP") is not None


def make_paper(payload: PaperOrder, order: Order) -> tuple[bytes, str | None]:
    """The bytes of what was ordered, and the hash of the result's file if it was needed."""
    return MAKERS[payload.kind](payload)


def sheet(order: PaperOrder) -> tuple[bytes, str | None]:
    """The setup sheet."""
    from workhold.drawing.result_sheet import result_sheet
    from workhold.drawing.scene import stacked
    from workhold.units import unit_named

    digest = order.result_hash or hash_of(order.result)
    pages = result_sheet(
        order.result,
        order.rank,
        result_hash=digest,
        day=order.day,
        paper=order.paper,
        unit=unit_named(order.unit),
        **{name: wish for name, wish in order.wishes.items() if name != "clearance"},
    )
    if order.kind == "sheet.svg":
        return stacked(pages).encode("utf-8"), digest
    from workhold.drawing.pdf import svg_to_pdf

    return svg_to_pdf(pages, order.day), digest


def hash_of(result: Result) -> str:
    """SHA-256 of the result's file."""
    from workhold.files.result.writer import result_text

    digest = sha256()
    for text in result_text(result):
        digest.update(text.encode("utf-8"))
    return digest.hexdigest()


def setup_drawing(order: PaperOrder) -> tuple[bytes, str | None]:
    """The set-up as DXF."""
    from workhold.files.dxf.setup import CLEARANCE, setup_dxf
    from workhold.model.part_zero import part_zero
    from workhold.units import unit_named

    result = order.result
    zero = part_zero(result.workpiece, order.wishes["zero"], unit_named(order.unit))
    clearance = order.wishes["clearance"]
    clearance = CLEARANCE if clearance is None else clearance
    return setup_dxf(order.fixture, result.workpiece, result.toolkit, zero, clearance), None


def setup_solid(order: PaperOrder) -> tuple[bytes, str | None]:
    """The set-up as STEP."""
    if not has_step():
        from workhold.files.step.library import REQUIREMENT

        raise InputError(f"this server writes no STEP files: take the DXF, or install {REQUIREMENT} beside it.")
    from workhold.files.step.setup import setup_step
    from workhold.model.part_zero import part_zero
    from workhold.units import unit_named

    result = order.result
    zero = part_zero(result.workpiece, order.wishes["zero"], unit_named(order.unit))
    sizes = {name: order.wishes[name] for name in ("thickness", "peg_length", "peg_height")}
    return setup_step(order.fixture, result.workpiece, result.toolkit, zero=zero, **sizes), None


def picture(order: PaperOrder) -> tuple[bytes, str | None]:
    """The picture to set the vise from."""
    from workhold.drawing.fixture_picture import draw_fixture

    result = order.result
    title = f"Fixture {order.rank} of {order.count}"
    return draw_fixture(order.fixture, result.workpiece, result.toolkit, title=title).encode("utf-8"), None


def pins(order: PaperOrder) -> tuple[bytes, str | None]:
    """The list of pins."""
    from workhold.files.pin_list import pin_list
    from workhold.model.dowel import fit_words
    from workhold.units import unit_named

    toolkit, fit = order.result.toolkit, order.result.query.tolerance.fit
    known = None if fit is None else fit_words(fit, 2 * toolkit.plates[0].peg_radius)
    wishes = order.wishes
    text = pin_list(order.fixture, toolkit, unit_named(order.unit), wishes["dowel"] or known, wishes["peg_length"])
    return text.encode("utf-8"), None


MAKERS: dict[str, Callable[[PaperOrder], tuple[bytes, str | None]]] = {
    "sheet.pdf": sheet,
    "sheet.svg": sheet,
    "setup.dxf": setup_drawing,
    "setup.step": setup_solid,
    "picture.svg": picture,
    "pins.csv": pins,
}
