"""Pictures that a notebook shows, setup sheets, and set-ups for a CAM system or as a list of pins."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import date
from hashlib import file_digest
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workhold.asking.declaring import collect_declared_values
from workhold.asking.sheet import SheetQuestion
from workhold.conventions import AGREEMENT
from workhold.drawing.fixture_pictures import draw_best_thumbnails, draw_fixture
from workhold.drawing.part_pictures import draw_features
from workhold.drawing.path_drawn import make_planned_path
from workhold.drawing.render import render
from workhold.drawing.sheet_facts import find_shift_on_plate
from workhold.errors import InputError
from workhold.files.atomic import write_bytes
from workhold.files.replacing import refuse_output
from workhold.listing.identity import make_entries
from workhold.model.jaw_hold import JawHold
from workhold.model.moved_setup import move_fixture_by_holes
from workhold.model.setup import choose_part_zero
from workhold.model.support_triples import ChosenSupports
from workhold.presenting.assembly import STEP_ENDINGS, Assembly, read_part_shape
from workhold.presenting.markup import LARGE, make_image
from workhold.units import find_unit

if TYPE_CHECKING:
    from workhold.model.fixture import Fixture
    from workhold.model.requirements import Load
    from workhold.model.result import Result
    from workhold.model.support_triples import Supports
    from workhold.model.workpiece import Workpiece

__all__ = [
    "MODEL_ENDINGS",
    "PAPER_ENDINGS",
    "Picture",
    "draw_and_save_fixture",
    "make_model_file",
    "make_pages_file",
    "draw_and_save_result",
    "save_sheet",
    "draw_and_save_workpiece",
    "write_model",
    "write_paper",
]


class Picture(str):
    """SVG text, which a notebook shows as a picture."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        """Return the picture as an HTML image."""
        return make_image(self, "A picture of workhold", LARGE)

    def save(self, path: str | Path, *, overwrite: bool = False) -> Picture:
        """Write the picture to a file and return the picture.

        Parameters
        ----------
        path : of a file whose name ends in .svg or .png.
        overwrite : whether to replace an existing file that workhold has not written.

        Raises
        ------
        InputError
            For another ending, and when the file cannot be written or replaced.
        """
        refuse_output(path, force=overwrite)
        write_bytes(path, render(str(self), Path(path).suffix))
        return self


def save_picture(svg: str, path: str | Path | None, overwrite: bool) -> Picture:
    """Return SVG text as a picture; unless ``path`` is None, also write it there."""
    picture = Picture(svg)
    return picture if path is None else picture.save(path, overwrite=overwrite)


def draw_and_save_workpiece(
    workpiece: Workpiece,
    path: str | Path | None = None,
    *,
    peg_radius: float | None = None,
    unit: str = "mm",
    overwrite: bool = False,
) -> Picture:
    """Return a picture of the workpiece with numbered faces; unless ``path`` is None, also write it there.

    See :meth:`workhold.Workpiece.draw`.
    """
    return save_picture(
        draw_features(workpiece, peg_radius=peg_radius, unit=find_unit(unit)), path, overwrite
    )


def draw_and_save_fixture(
    fixture: Fixture,
    path: str | Path | None = None,
    *,
    title: str | None = None,
    unit: str = "mm",
    overwrite: bool = False,
) -> Picture:
    """Return a picture of the fixture to set up from; unless ``path`` is None, also write it there.

    See :meth:`workhold.Fixture.draw`.
    """
    listed = fixture.listing
    words = f"Fixture {listed.rank} of {listed.count}" if title is None else title
    result, planned = listed.result, make_planned_path(listed.result, listed.row)
    svg = draw_fixture(
        fixture, result.workpiece, result.toolkit, title=words, unit=find_unit(unit), path=planned
    )
    return save_picture(svg, path, overwrite)


def draw_and_save_result(
    result: Result, path: str | Path | None = None, *, unit: str = "mm", overwrite: bool = False
) -> Picture:
    """Return a picture with thumbnails of the best fixtures; unless ``path`` is None, also write it there.

    See :meth:`workhold.Result.draw`.
    """
    if not len(result):
        raise InputError(" ".join(("there is no fixture to draw.", *map(str, result.reasons))))
    return save_picture(draw_best_thumbnails(result, make_entries(result), find_unit(unit)), path, overwrite)


PAPER_ENDINGS = (".pdf", ".svg", ".png")
MODEL_ENDINGS = (".dxf", ".step", ".stp", ".csv")
# A PNG is so many pixels wide; a second page makes it higher.
PNG_WIDTH = 2400
# What of a sheet's wishes a set-up for a CAM system has too.
SIZES = ("thickness", "peg_length", "peg_height")


def save_sheet(
    fixture: Fixture,
    path: str | Path,
    *,
    unit: str = "mm",
    loads: Sequence[Load] | None = None,
    result_file: str | Path | None = None,
    supports: Supports | None = None,
    best: int = 1,
    part: str | Path | None = None,
    overwrite: bool = False,
    **asked: Any,
) -> None:
    """Write the setup sheet of a fixture, or its set-up for a CAM system, as the ending of ``path`` says.

    See :meth:`workhold.Fixture.save_sheet`.
    """
    from workhold.statics.loads import read_jaw_stiffness

    listed, ending = fixture.listing, Path(path).suffix.lower()
    if fixture != listed.result[listed.row]:
        raise InputError(
            "this fixture was changed since it was listed: take the sheet of the one in its result."
        )
    refuse_output(path, (result_file, part), overwrite)
    if result_file is not None:
        refuse_other_result(result_file, fixture)
    settings = {**collect_declared_values(SheetQuestion(**asked)), "unit": find_unit(unit)}
    if supports is not None:
        if ending in MODEL_ENDINGS and ending not in STEP_ENDINGS:
            raise InputError(f"{path} has no supports: let the name end in .pdf, .svg, .png or .step.")
        settings["supports"] = ChosenSupports.from_fixture(fixture, supports, best)
    if part is not None:
        if ending not in STEP_ENDINGS and settings["material"] is None and fixture.bent is None:
            raise InputError(
                f"{path} has no shape of the part: let the name end in .step, name the part's material, or leave part out."
            )
        settings["shape"] = read_part_shape(part, listed.result.workpiece)
    if ending in MODEL_ENDINGS:
        write_model(path, listed.result, listed.row + 1, settings)
        return
    settings["jaw"] = read_jaw_stiffness(settings["jaw"])
    settings["day"] = settings["day"] or date.today()
    settings |= {"number": listed.rank, "count": listed.count, "others": listed.others, "loads": loads}
    write_paper(path, listed.result, listed.row + 1, result_file, settings)


def refuse_other_result(result_file: str | Path, fixture: Fixture) -> None:
    """Raise InputError for a result file that does not list this fixture at its rank."""
    from workhold.files.result.one_fixture import read_one

    listed = fixture.listing
    read, row = read_one(result_file, listed.rank), listed.rank - 1
    asked, there = listed.result.query, read.query
    belongs = asked.workpiece.is_alike(there.workpiece) and asked.toolkit == there.toolkit
    if not belongs or not is_set_up_alike(fixture, read[row]):
        raise InputError(
            f"{result_file} has another fixture in place {listed.rank}: give the file that this result was "
            "saved in."
        )


def is_set_up_alike(one: Fixture, other: Fixture) -> bool:
    """Return whether two fixtures have the same type, holes and faces, and pose and travel equal to
    ``AGREEMENT``.
    """
    pegs = [[(peg.hole, peg.touched) for peg in fixture.pegs] for fixture in (one, other)]
    numbers = [
        (fixture.pose.theta_deg, fixture.pose.x, fixture.pose.y, fixture.travel) for fixture in (one, other)
    ]
    return (
        (one.type, one.direction) == (other.type, other.direction)
        and pegs[0] == pegs[1]
        and all(abs(a - b) <= AGREEMENT for a, b in zip(*numbers, strict=True))
    )


def write_paper(
    path: str | Path, result: Result, rank: int, result_file: str | Path | None, settings: dict[str, Any]
) -> None:
    """Write a setup sheet.

    Parameters
    ----------
    path : of a file whose name ends in .pdf, .svg or .png.
    rank : of the fixture in the result, from 1.
    result_file : the file that the result is in, whose hash is written on the sheet; None for a result of no
        file.
    settings : arguments of :func:`workhold.drawing.sheet_facts.collect_sheet_details`, and the ``shape`` of
        the part.

    Raises
    ------
    InputError
        For another ending, impossible values, and when a file cannot be read or written.
    """
    from workhold.drawing.sheet import draw_setup_sheet

    ending = Path(path).suffix.lower()
    if ending not in PAPER_ENDINGS:
        endings = ", ".join((*PAPER_ENDINGS, *MODEL_ENDINGS[:-1]))
        raise InputError(
            f"{path} names no kind of setup sheet: let the name end in {endings} or {MODEL_ENDINGS[-1]}."
        )
    shape = settings.pop("shape", None)
    if settings.get("material") is not None or result[rank - 1].bent is not None:
        from workhold.presenting.bent import find_sheet_bending

        settings["bending"] = find_sheet_bending(result[rank - 1], settings, shape)
    pages = draw_setup_sheet(result, rank, result_hash=compute_file_hash(result_file), **settings)
    write_bytes(path, make_pages_file(pages, ending, settings["day"]))


def make_pages_file(pages: Sequence[str], ending: str, day: date) -> bytes:
    """Return the bytes of a file of SVG pages: a PDF dated ``day``, or one SVG or PNG with the pages one
    below the other.

    Parameters
    ----------
    ending : one of :data:`PAPER_ENDINGS`.
    """
    from workhold.drawing.pdf import convert_svg_to_pdf
    from workhold.drawing.render import convert_svg_to_png, stack_pages

    if ending == ".pdf":
        return convert_svg_to_pdf(pages, day)
    return (
        stack_pages(pages).encode("utf-8")
        if ending == ".svg"
        else convert_svg_to_png(stack_pages(pages), PNG_WIDTH)
    )


def compute_file_hash(result_file: str | Path | None) -> str:
    """Return the SHA-256 of a file in hexadecimal; "" if ``result_file`` is None."""
    if result_file is None:
        return ""
    try:
        with Path(result_file).open("rb") as stream:
            return file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise InputError(f"{result_file} cannot be read: {error.strerror or error}.") from error


def write_model(path: str | Path, result: Result, rank: int, settings: dict[str, Any]) -> None:
    """Write the set-up for a CAM system, or the list of its pins.

    Parameters
    ----------
    path : of a file whose name ends in .dxf, .step, .stp or .csv.
    rank : of the fixture in the result, from 1.
    settings : the fields of a :class:`workhold.asking.sheet.SheetQuestion`, and the ``unit``. For a STEP file
        also ``supports``, a chosen set of them, and the ``shape`` of the part.

    Raises
    ------
    InputError
        For an impossible part zero, and when the file cannot be written.
    """
    ending = Path(path).suffix.lower()
    write_bytes(path, make_model_file(result[rank - 1], result, ending, settings))


def make_model_file(fixture: Fixture, result: Result, ending: str, settings: dict[str, Any]) -> bytes:
    """Return the bytes of a set-up's file for a CAM system, or of its list of pins; see
    :func:`write_model`.
    """
    toolkit, unit = result.toolkit, settings["unit"]
    zero = choose_part_zero(result.workpiece, settings["zero"], unit)
    at, clearance, chosen = settings["at"], settings["clearance"], settings.get("supports")
    if chosen is None:
        fixture = move_fixture_by_holes(fixture, toolkit, find_shift_on_plate(fixture, result, at))
    elif at is not None:
        chosen = chosen.move_to_hole(at)
    if isinstance(fixture.hold, JawHold) and ending in (".csv", ".dxf"):
        raise InputError(
            f"a {ending} of a set-up is of pegs, and a {toolkit.noun} has none: let the name end in .step, or take the "
            "setup sheet."
        )
    if ending == ".csv":
        from workhold.files.result.fixture_text import write_pin_list
        from workhold.model.dowels import describe_fit

        fit, diameter = result.query.tolerance.fit, 2 * toolkit.plates[0].peg_radius
        dowel = settings["dowel"] or (None if fit is None else describe_fit(fit, diameter))
        return write_pin_list(fixture, toolkit, unit, dowel, settings["peg_length"]).encode("utf-8")
    if ending == ".dxf":
        from workhold.files.dxf.writer import CLEARANCE, make_setup_dxf

        keep_off = CLEARANCE if clearance is None else clearance
        return make_setup_dxf(fixture, result.workpiece, toolkit, zero, keep_off)
    lengths = {name: settings[name] for name in SIZES}
    shape = settings.get("shape")
    if chosen is not None:
        lengths["support_height"] = settings.get("support_height")
    return Assembly.from_fixture(fixture, result, lengths, chosen, shape).make_file_content(ending, zero)
