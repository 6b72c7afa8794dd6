"""The data of a solid that an outline by height keeps: which side is up, and where its segments can be
touched."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from itertools import pairwise
from math import isfinite
from typing import Any

from attrs import evolve, field, frozen
from attrs.converters import optional

from workhold.asking.reading import AXES
from workhold.errors import InputError
from workhold.limits import convert_real

__all__ = [
    "BESIDE_TOP",
    "NO_LEVELS",
    "STANDING",
    "Band",
    "FileSolid",
    "HeightRow",
    "RunRows",
    "SolidOutline",
    "flip_up_axis",
    "interpolate_run",
    "slides_at_every_height",
]

# What says how a solid stands, as a file of a result has it.
STANDING = ("axis", "height", "peg_height", "head_room", "least_band")
# What says where a head or a tip on the upper faces is in the way or hangs, as a file has it.
BESIDE_TOP = ("rising", "rising_heights", "hanging", "hanging_heights")
# What carriers with outlines of their own say nothing of.
NO_LEVELS: dict[str, Any] = {
    "bottom": None,
    "top": None,
    **dict.fromkeys(("top_heights", *BESIDE_TOP, "unclear_heights"), ()),
}
Band = tuple[float, float]
# Heights of the run that holds a segment's band, along the segment: shares of it, rising from 0 to 1, with
# the lower and the upper end in mm there. Of every four, the last of which begins the next, each end is a
# cubic.
RunRows = tuple[tuple[float, float, float], ...]
# Loops of vertices x, y (mm) and bulge.
Loops = tuple[tuple[tuple[float, ...], ...], ...]


def flip_up_axis(axis: str) -> str:
    """Return the opposite axis, which points up once the part is turned onto its other side.

    >>> flip_up_axis("z"), flip_up_axis("-x")
    ('-z', 'x')
    """
    return axis[1:] if axis.startswith("-") else f"-{axis}"


def to_bands(values: Iterable[Any]) -> tuple[Band | None, ...]:
    """Return bands as pairs (low, high) of floats, with None for segments that must not be touched."""
    return tuple(
        None if value is None else (convert_real(value[0]), convert_real(value[1])) for value in values
    )


def to_loops(values: Iterable[Iterable[Iterable[Any]]]) -> Loops:
    """Return loops of (x, y, bulge) as nested tuples of floats; raise InputError for anything else."""
    loops = tuple(tuple(tuple(convert_real(one) for one in vertex) for vertex in loop) for loop in values)
    if any(len(vertex) != 3 or not all(map(isfinite, vertex)) for loop in loops for vertex in loop):
        raise InputError("a loop of the solid cannot be used: give x, y and bulge of every vertex.")
    return loops


def convert_finite_heights(values: Iterable[Any]) -> tuple[float, ...]:
    """Return heights as a tuple of floats; raise InputError if one is not finite."""
    numbers = tuple(convert_real(value) for value in values)
    if not all(map(isfinite, numbers)):
        raise InputError("a height of an upper face of the solid is not a length: give it in mm.")
    return numbers


def to_numbers(values: Iterable[Iterable[int]]) -> tuple[tuple[int, ...], ...]:
    """Return nested tuples of ints."""
    return tuple(tuple(int(number) for number in value) for value in values)


def to_runs(values: Iterable[Iterable[Any]]) -> tuple[RunRows, ...]:
    """Return runs as tuples of rows (share, low, high) of floats; raise InputError where rows are not a run, see
    RunRows.
    """
    found = []
    for value in values:
        rows = tuple(tuple(convert_real(one) for one in row) for row in value)
        flat = [number for row in rows for number in row]
        is_whole = all(len(row) == 3 for row in rows) and all(map(isfinite, flat))
        if not is_whole or (rows and not is_run(rows)):
            raise InputError(
                "a run of heights of the solid cannot be used: give shares of the segment from 0 to 1 "
                "that rise, one and three more for every piece, each with the lower end first."
            )
        found.append(tuple((share, low, high) for share, low, high in rows))
    return tuple(found)


def is_run(rows: Sequence[Sequence[float]]) -> bool:
    """Return whether rows (share, low, high) make a run:
    3 n + 1 of them, shares rising from 0 to 1, 0 <= low <= high.
    """
    shares = [row[0] for row in rows]
    rise = all(a < b for a, b in pairwise(shares))
    stand = all(0.0 <= row[1] <= row[2] < 1e9 for row in rows)
    return len(rows) % 3 == 1 and len(rows) > 1 and (shares[0], shares[-1]) == (0.0, 1.0) and rise and stand


def interpolate_run(rows: RunRows, share: float) -> Band:
    """Return the lower and upper height in mm of a run at a share of its segment; the run must not be empty.

    >>> interpolate_run(((0.0, 0.0, 6.0), (1 / 3, 0.0, 7.0), (2 / 3, 0.0, 8.0), (1.0, 0.0, 9.0)), 0.5)
    (0.0, 7.5)
    """
    last = next((k for k in range(3, len(rows) - 1, 3) if rows[k][0] >= share), len(rows) - 1)
    piece = rows[last - 3 : last + 1]
    share = min(max(share, piece[0][0]), piece[-1][0])
    ends = [0.0, 0.0]
    for k, (place, *heights) in enumerate(piece):
        # Lagrange's form of the cubic through four points.
        weight = 1.0
        for j, (other, _, _) in enumerate(piece):
            if j != k:
                weight *= (share - other) / (place - other)
        ends = [end + weight * height for end, height in zip(ends, heights, strict=True)]
    return ends[0], ends[1]


@frozen
class SolidOutline:
    """The solid of an outline at the height of the pegs.

    Parameters
    ----------
    axis : direction of the file that points up, one of x, y, z, -x, -y, -z.
    height : height of the part in mm.
    peg_height : height of the pegs in mm above the plane on which the part lies.
    head_room : height in mm kept free above the pegs.
    least_band : height in mm of the lowest band that may be touched.
    bands : for each segment of the workpiece the heights (z0, z1) in mm at which upright faces cover all of
        the segment; None where nothing may touch it.
    faces : for each segment the numbers of these upright faces, as the file lists them; empty where the
        result file does not say.
    bottom, top : loops (outer ones counter-clockwise, openings clockwise) of the level faces on which the
        part lies, and of those upper level faces that are free above. Empty where there is no such face; None
        where the result file does not say.
    top_heights : for every loop of ``top`` the height of its face in mm; none where a file does not say.
    low : height in mm from which pegs reach upward; 0 is the plane on which the part lies.
    runs : for each segment, the run of heights along it that holds its band; an empty run where that is the
        band all along. None where every run is its band.
    rising, rising_heights : loops around what rises above faces of ``top``, and for each loop the height of
        the face.
    hanging, hanging_heights : loops of the parts of ``top`` under which there is air, so that the material
        does not reach down to where the part lies; and for each loop the height of its face.
    unclear_heights : heights of the upper level faces that are left out of ``top`` because it is not known
        what rises beside them.

    Raises
    ------
    InputError
        For an unknown axis, impossible heights, and bands that end below their start.
    """

    axis: str
    height: float = field(converter=convert_real)
    peg_height: float = field(converter=convert_real)
    head_room: float = field(converter=convert_real)
    least_band: float = field(converter=convert_real)
    bands: tuple[Band | None, ...] = field(converter=to_bands)
    faces: tuple[tuple[int, ...], ...] = field(default=(), converter=to_numbers)
    bottom: Loops | None = field(default=None, converter=optional(to_loops))
    top: Loops | None = field(default=None, converter=optional(to_loops))
    top_heights: tuple[float, ...] = field(default=(), converter=convert_finite_heights)
    low: float = field(default=0.0, converter=convert_real)
    runs: tuple[RunRows, ...] = field(default=(), converter=to_runs)
    rising: Loops = field(default=(), converter=to_loops)
    rising_heights: tuple[float, ...] = field(default=(), converter=convert_finite_heights)
    hanging: Loops = field(default=(), converter=to_loops)
    hanging_heights: tuple[float, ...] = field(default=(), converter=convert_finite_heights)
    unclear_heights: tuple[float, ...] = field(default=(), converter=convert_finite_heights)

    def __attrs_post_init__(self) -> None:
        if self.axis not in AXES:
            raise InputError(f"the axis '{self.axis[:40]}' is not known: give one of {', '.join(AXES)}.")
        for name, value, least in (
            ("height of the part", self.height, 0.0),
            ("peg height", self.peg_height, max(self.low, 0.0)),
            ("head room", self.head_room, -1.0),
            ("least band", self.least_band, -1.0),
        ):
            if not (isfinite(value) and value > least):
                raise InputError(f"the {name} {value:g} is not a length: give one in mm.")
        of_loops = (
            self.top_heights or (0.0,) * len(self.top or ()),
            self.rising_heights,
            self.hanging_heights,
        )
        for loops, heights in zip((self.top or (), self.rising, self.hanging), of_loops, strict=True):
            if len(heights) != len(loops):
                raise InputError(
                    f"there are {len(loops)} loops of upper faces and {len(heights)} heights: give one for "
                    "each."
                )
        for band in self.bands:
            if band is not None and not (isfinite(band[0]) and 0.0 <= band[0] <= band[1] < 1e9):
                raise InputError(
                    f"the band {band[0]:g} to {band[1]:g} mm cannot be used: give its lower end first."
                )

    @classmethod
    def from_entries(cls, solid: Mapping[str, Any], workpiece: Mapping[str, Any]) -> SolidOutline:
        """Return the solid of a result file's entries ``solid`` and ``workpiece``;
        the second has bands, faces and loops.

        Raises
        ------
        InputError, LookupError, TypeError, ValueError
            For entries that lack something, or hold impossible values.
        """
        return cls(
            **{key: solid[key] for key in STANDING},
            bands=workpiece["bands"],
            faces=workpiece.get("solid_faces") or (),
            bottom=workpiece.get("bottom"),
            top=workpiece.get("top"),
            top_heights=workpiece.get("top_heights") or (),
            runs=workpiece.get("runs") or (),
            rising=workpiece.get("rising") or (),
            rising_heights=workpiece.get("rising_heights") or (),
            hanging=workpiece.get("hanging") or (),
            hanging_heights=workpiece.get("hanging_heights") or (),
            unclear_heights=workpiece.get("unclear_heights") or (),
        )

    @property
    def lies_on_no_face(self) -> bool:
        """Whether the level faces are known, and none of them is in the plane on which the part lies."""
        return self.bottom is not None and not self.bottom

    @property
    def has_no_top(self) -> bool:
        """Whether the level faces are known, and no upper one is known to be free above."""
        return self.top is not None and not self.top

    def check_segment_count(self, count: int) -> SolidOutline:
        """Return the solid itself; raise InputError unless it has a band
        (and faces and runs, if any) for each of ``count`` segments.
        """
        if len(self.bands) != count or any(len(one) not in (0, count) for one in (self.faces, self.runs)):
            raise InputError(
                f"the outline has {count} segments and {len(self.bands)} bands: give one band for each."
            )
        return self

    def reorder(self, order: Sequence[int], turned: Set[int] = frozenset()) -> SolidOutline:
        """Return a copy whose k-th band, faces and run are those of segment ``order[k]``.

        Segments whose (old) numbers are in ``turned`` now run in the other direction, and so do their runs.
        """
        return evolve(
            self,
            bands=[self.bands[k] for k in order],
            faces=[self.faces[k] for k in order] if self.faces else (),
            runs=[reverse_run(self.runs[k]) if k in turned else self.runs[k] for k in order]
            if self.runs
            else (),
        )


def reverse_run(rows: RunRows) -> RunRows:
    """Return the rows of a run for the reversed segment: shares 1 - share, in reverse order."""
    return tuple((1.0 - share, low, high) for share, low, high in reversed(rows))


@frozen
class FileSolid:
    """One of the solids of a file.

    Parameters
    ----------
    number : from 1, by decreasing volume.
    name : as the file calls it; empty where it does not.
    size : of its bounding box along x, y and z of the file, in mm.
    low : lowest corner (x, y, z) of that box, in mm.
    """

    number: int
    name: str
    size: tuple[float, ...] = field(converter=convert_finite_heights)
    low: tuple[float, ...] = field(converter=convert_finite_heights)

    def __str__(self) -> str:
        size = " x ".join(f"{length:.6g}" for length in self.size)
        place = ", ".join(f"{round(value, 6) + 0.0:.6g}" for value in self.low)
        name = f", {self.name}," if self.name else ""
        return f"solid {self.number}{name} is {size} mm at ({place})"


@frozen
class HeightRow:
    """A range of peg heights with the same outline.

    Parameters
    ----------
    low, high : ends of the range in mm; the outline is that of pegs with the height ``high``.
    area : of the outline, in mm².
    border, touchable : length of its border, and of its touchable border, in mm.
    band : shortest band of a touchable segment, in mm; 0 if there is none.
    slides : whether all touchable faces are flat and parallel, so that the part slides along them.
    """

    low: float
    high: float
    area: float
    border: float
    touchable: float
    band: float
    slides: bool = False


def slides_at_every_height(rows: Iterable[HeightRow]) -> bool:
    """Return whether the part slides along all touched faces, at every peg height at which pegs can touch it.

    Returns False if pegs can touch no face at any height.
    """
    touching = [row for row in rows if row.touchable > 0]
    return bool(touching) and all(row.slides for row in touching)
