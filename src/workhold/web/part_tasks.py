"""Tasks of the workers about parts: read and describe a part that was sent, and find the shape of a part.

A request for a search has an outline and the heights of its faces, not a shape. So that bodies can show the
shape, the STEP file is sent once more, and the shape found in it is kept with the job.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from attrs import asdict, evolve, frozen

from workhold.errors import InputError
from workhold.model.workpiece import Workpiece
from workhold.web.worker import TaskContext

if TYPE_CHECKING:
    from workhold.files.outline.chain import Chain
    from workhold.files.part.loaded import LoadedPart
    from workhold.files.part.survey import DrawingSurvey
    from workhold.files.step.part_shape import PartShape
    from workhold.web.request_forms import WorkpieceForm

__all__ = [
    "ShapeOrder",
    "UploadedPart",
    "describe_builtin_part",
    "check_part",
    "find_shape",
    "read_part",
    "estimate_shape_size",
    "survey_part",
]

# Bytes of a shape that a job keeps at most.
MOST_BYTES = 64_000_000
# Segments of a drawing or a layer, parts, gaps and layers of a file that are sent to be shown.
MOST_STROKES, MOST_PARTS, MOST_GAPS, MOST_LAYERS = 20_000, 200, 500, 60
# Solids of a file that are sent to be shown.
MOST_SOLIDS = 200
# What the questions of a part's readers are called on the page, or by those who ask the server for more.
CALLED = {
    "unit": '"File drawn in"',
    "drawing_unit": '"File drawn in"',
    "layers": '"Layers"',
    "part_number": "the part number",
    "join_tolerance": '"Join gaps up to"',
    "fit": '"Fit curves within"',
    "axis": "axis",
    "section": "the height of a section",
    "peg_height": '"Peg height"',
    "head_room": '"Head room"',
    "least_band": "the least band",
    "heights": "the toolkit's own heights",
}
ENDINGS = (".dxf", ".svg", ".json", ".step", ".stp")


@frozen
class UploadedPart:
    """A file with a part as it was sent.

    Parameters
    ----------
    content : bytes of the file.
    name : the user's name of the file; never used as a path.
    most_segments : most segments that the part may have.
    options : keyword arguments of :func:`workhold.files.part.load.read_workpiece`.
    """

    content: bytes
    name: str
    most_segments: int
    options: Mapping[str, Any]


def check_part(payload: tuple[WorkpieceForm, int], order: TaskContext) -> dict[str, Any]:
    """Return a part drawn by hand as plain data; raise InputError where it cannot be used.

    The payload is the part's form and the most segments allowed.
    """
    from workhold.web.answers import describe_part

    form, most_segments = payload
    return describe_part(form.to_workpiece(most_segments))


def describe_builtin_part(name: str, order: TaskContext) -> dict[str, Any]:
    """Return the built-in part with this name, which must exist, as plain data."""
    from workhold.files.part.finding import find_builtin_path
    from workhold.files.part.load import read_workpiece
    from workhold.web.answers import describe_part

    path = find_builtin_path(name)
    assert path is not None
    return describe_part(read_workpiece(path).workpiece)


def read_part(upload: UploadedPart, order: TaskContext) -> dict[str, Any]:
    """Return the part in a file that was sent, as plain data."""
    from workhold.files.part.load import read_workpiece

    with write_sent_file(upload) as path:
        loaded = read_workpiece(path, **upload.options, called=CALLED)
        return describe_uploaded_part(upload, path, loaded)


def survey_part(upload: UploadedPart, order: TaskContext) -> dict[str, Any]:
    """Return the content of a sent file, the questions to ask, and the part if it can be read, as plain data."""
    from workhold.files.part.survey import survey_part_file

    with write_sent_file(upload) as path:
        seen = survey_part_file(path, **upload.options, called=CALLED)
        part = None if seen.loaded is None else describe_uploaded_part(upload, path, seen.loaded)
        return describe_survey(seen, part, remove_path(seen.refusal, path))


@contextmanager
def write_sent_file(upload: UploadedPart) -> Iterator[Path]:
    """Yield the path of a temporary file with the content that was sent.

    An InputError in the block is raised again without that path in its sentence; arithmetic and value errors
    become an InputError that says the file is damaged.
    """
    ending = f".{upload.name.rpartition('.')[2].lower()}"
    with TemporaryDirectory(prefix="workhold-") as folder:
        path = Path(folder) / f"part{ending if ending in ENDINGS else ''}"
        path.write_bytes(upload.content)
        try:
            yield path
        except InputError as error:
            raise InputError(remove_path(str(error), path)) from error
        except (ArithmeticError, LookupError, ValueError, RecursionError) as error:
            raise InputError(
                "The file is damaged, or holds what this program cannot read: save it anew."
            ) from error


def remove_path(sentence: str, path: Path) -> str:
    """Return a sentence without the temporary file's name at its beginning."""
    return sentence.replace(f"{path.name}: ", "", 1)


def describe_uploaded_part(upload: UploadedPart, path: Path, loaded: LoadedPart) -> dict[str, Any]:
    """Return a part that was read from a sent file as plain data.

    A part without a name is named after the file. Raises InputError for more segments than this server takes.
    """
    from workhold.web.answers import describe_part
    from workhold.web.request_forms import make_checked_part

    part, sent_as = loaded.workpiece, upload.name.rpartition(".")[0] or upload.name
    checked_size = make_checked_part(
        part.name,
        part.loops,  # type: ignore[arg-type]
        upload.most_segments,
        part.departure,
        part.solid,
    )
    name = sent_as if part.name == path.stem else part.name
    if loaded.solids and name.endswith(f" of {path.stem}"):
        name = name.removesuffix(path.stem) + sent_as
    whole = evolve(checked_size, name=name or "part", outlines=part.outlines)
    return describe_part(whole, loaded.remarks)


@frozen(eq=False)
class ShapeOrder:
    """An order to find, in a file, the solid that has the outline of a part.

    Parameters
    ----------
    content : content of the STEP file.
    name : the user's name of the file.
    workpiece : part whose outline one of the solids must have.
    """

    content: bytes
    name: str
    workpiece: Workpiece


def find_shape(payload: ShapeOrder, order: TaskContext) -> PartShape:
    """Return the mesh of the solid in a STEP file that has the outline of a part.

    Raises InputError for a file of another part, and for a shape that is too large to keep.
    """
    from workhold.files.step.part_shape import make_part_shape

    try:
        shape = make_part_shape(payload.content, payload.workpiece)
        if estimate_shape_size(shape) > MOST_BYTES:
            raise InputError(
                f"the shape of the part takes more than {MOST_BYTES // 1_000_000} MB to show: leave out "
                "threads, letters and other small things when you save it."
            )
    except InputError as error:
        raise InputError(f"{payload.name or 'the file'}: {error}") from error
    return shape


def estimate_shape_size(shape: PartShape | None) -> int:
    """Return about how many bytes a shape takes; 0 for None."""
    if shape is None:
        return 0
    return shape.positions.nbytes + shape.normals.nbytes + shape.triangles.nbytes + len(shape.kept)


def describe_strokes(chains: Iterable[Chain]) -> list[list[list[float]]]:
    """Return chains as lists of [x, y, bulge] in mm, up to :data:`MOST_STROKES` segments in all."""
    strokes, room = [], MOST_STROKES
    for chain in chains:
        room -= len(chain.bulges)
        if room < 0:
            break
        strokes.append(
            [[*point, bulge] for point, bulge in zip(chain.points, (*chain.bulges, 0.0), strict=True)]
        )
    return strokes


def describe_survey(seen: DrawingSurvey, part: dict[str, Any] | None, refusal: str) -> dict[str, Any]:
    """Return the content of a file, and the questions to ask before its part can be read, as plain data.

    Strokes and loops have rows of x, y in mm and bulge. ``heights`` are the outlines that pegs at other
    heights meet on a solid, and ``solids`` the solids in the file with their names.
    """
    from workhold.web.answers import find_first_place

    return {
        "part": part,
        "error": refusal or None,
        "place": find_first_place(refusal) if refusal else None,
        "asked": list(seen.asked),
        "size": None if seen.size is None else list(seen.size),
        "pixels": None if seen.pixels is None else list(seen.pixels),
        "strokes": describe_strokes(seen.chains),
        "layers": [
            {"name": one.name, "hidden": one.hidden, "strokes": describe_strokes(one.chains)}
            for one in seen.layers[:MOST_LAYERS]
        ],
        "parts": [
            {
                "number": one.number,
                "loops": [loop.vertices.tolist() for loop in one.loops],
                "bounds": list(one.bounds),
                "holes": len(one.loops) - 1,
            }
            for one in seen.parts[:MOST_PARTS]
        ],
        "gaps": list(seen.gaps[:MOST_GAPS]),
        "heights": [] if seen.loaded is None else [asdict(row) for row in seen.loaded.heights],
        "solids": [asdict(solid) for solid in seen.solids[:MOST_SOLIDS]],
    }
