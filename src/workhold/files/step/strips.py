"""Strips: the segments of an outline by height, each with the band of heights that all of its points have in
common.

The border is cut at corners, where a run of heights begins, ends, splits, merges or jumps, and where the
longest run becomes long enough to be touched. Each segment is halved until its band is at least half as long
as the longest run above it. The result does not depend on the part's position in its file.

Glossary
--------
run : a maximal range of heights that walls cover above a place; see ``files.step.bands``.
band : a range of heights within one run at every place of a segment.
stretch : neighbouring pieces of one carrier over which no run jumps.
touched : said of a place where the longest run is at least as long as the shortest band that may be touched.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import pairwise
from math import pi, tan

from attrs import frozen

from workhold.conventions import SAME_HEIGHT
from workhold.files.step.bands import CoveredPiece, WallRun, WallsByCarrier, measure_band
from workhold.files.step.edge_curves import ONE_HEIGHT, bisect_condition
from workhold.geometry.loop import cut_into_runs
from workhold.geometry.segment import Arc, Point
from workhold.geometry.subdivision import BorderPiece
from workhold.model.solid import Band, RunRows, interpolate_run

__all__ = ["Strip", "make_run_rows", "make_touchable_strips"]

# Ends of runs that differ by less, in mm, go on from piece to piece.
SAME_BAND = 1e-5
# Steps beside a joint over which an end of a run may move without a jump, in units of what makes points one.
STEP = 2.0
# How near a steep place is to be to a joint, in these units, and how far from it it is looked at.
AT_JOINT, BESIDE = 10.0, 1e3
# mm. Pieces shorter than this are not made by halving.
SHORTEST_STRIP = 0.01
# mm. Heights that a piece's cubic tells are off by no more, and pieces of a run that are not parted any more.
CUBIC, SHORTEST_PIECE = 1e-6, 1e-5
# Halvings in which a place is searched.
HALVINGS = 50
Stretch = Sequence[CoveredPiece]


@frozen
class Strip:
    """A segment of the outline with its band.

    Parameters
    ----------
    start, end : (x, y) in mm, run with the material on the left.
    bulge : bulge of the segment.
    band : (z0, z1) in mm that all its points have in common; None where nothing may touch.
    faces : sorted indices of the solid's upright faces over it; empty where nothing may touch.
    covered : the pieces that it consists of, in running order.
    """

    start: Point
    end: Point
    bulge: float
    band: Band | None
    faces: tuple[int, ...]
    covered: tuple[CoveredPiece, ...]


def make_touchable_strips(loop: Sequence[BorderPiece], walls: WallsByCarrier, least: float) -> list[Strip]:
    """Return the segments of an outline's loop, each with the heights that may be touched all along it.

    Parameters
    ----------
    loop : pieces of the border in running order, see ``geometry.subdivision``.
    walls : the solid's upright faces.
    least : shortest range of heights in mm that may be touched.

    Returns
    -------
    Strips in running order.
    """
    pieces = [walls.find_covered(piece) for piece in loop]
    stretches: Sequence[Stretch] = cut_into_runs(pieces, lambda a, b: continues_piece(a, b, least))
    if len(stretches) == 1 and continues_piece(pieces[-1], pieces[0], least):
        stretches = list(cut_whole_circle(pieces, least))
    return [strip for stretch in stretches for strip in cut_stretch_into_strips(stretch, least)]


def continues_piece(before: CoveredPiece, after: CoveredPiece, least: float) -> bool:
    """Return whether a piece of border continues the piece before it.

    It does if both have the same line or circle and direction, and no range of height ends between them. A
    range that upright faces cover ends there if its heights jump, or if no range on the other side has the
    same ends. Ranges shorter than ``least`` mm do not count.
    """
    if before.piece.carrier is not after.piece.carrier or before.piece.forward != after.piece.forward:
        return False
    sides = [list_runs_at_end(before, 1), list_runs_at_end(after, 0)]
    for own, others in (sides, sides[::-1]):
        for band, off, jumps in own:
            if measure_band(band) < least - SAME_HEIGHT:
                continue
            if jumps or not any(
                all(abs(a - b) <= off + more for a, b in zip(band, other, strict=True))
                for other, more, _ in others
            ):
                return False
    return True


def list_runs_at_end(covered: CoveredPiece, end: int) -> list[tuple[Band, float, bool]]:
    """Return (band, tolerance, jumps) for each range of
    height that upright faces cover at one end of a piece.

    The band is (z0, z1) in mm, and ``jumps`` says whether one of its ends jumps there. ``end`` is 0 for the
    start in the direction of the border, 1 for the end. The tolerance in mm allows for heights that change
    over the distance within which two points count as one.
    """
    position, carrier = covered.ends[end], covered.piece.carrier
    inward = 1.0 if position == covered.low else -1.0

    def step_inward(steps: float) -> float:
        """Return the position ``steps`` point tolerances inward from the end,
        but not farther than a quarter of the piece.
        """
        return position + inward * min(steps * carrier.slack, covered.size / 4)

    found: list[tuple[Band, float, bool]] = []
    for run in covered.runs:
        here, there = run.compute_heights_at(position), run.compute_heights_at(step_inward(STEP))
        jumps = any(
            one.is_steep_at(position, step_inward(BESIDE), AT_JOINT * carrier.slack)
            for one in (run.lower, run.upper)
        )
        moved = max(abs(a - b) for a, b in zip(here, there, strict=True))
        found.append((here, SAME_BAND + moved, jumps))
    return found


def cut_whole_circle(pieces: Stretch, least: float) -> Iterator[Stretch]:
    """Yield the pieces of a whole circle in groups, cut
    where the longest range of covered heights is shortest.

    So halving gives the same strips however the circle is turned and whichever way it runs. The circle stays
    whole if the heights common to all its points suffice, or if no part of it may be touched.
    """
    if (
        is_band_long_enough(pieces, find_common_band(pieces), least)
        or max(map(bound_run_length, pieces)) < least - SAME_HEIGHT
    ):
        yield pieces
        return
    places = [
        (k, place, one.measure_longest_run_at(place))
        for k, one in enumerate(pieces)
        for place in (one.low, *one.list_inner_positions(), one.high)
    ]
    shortest = min(value for _, _, value in places)
    parts: list[CoveredPiece] = []
    fresh: set[int] = set()
    for k, one in enumerate(pieces):
        lowest = [place for number, place, value in places if number == k and value <= shortest + SAME_HEIGHT]
        cuts = [place for place in lowest if min(place - one.low, one.high - place) > one.piece.carrier.slack]
        at_start = any(abs(place - one.ends[0]) <= one.piece.carrier.slack for place in lowest)
        for number, part in enumerate(one.cut_at(cuts)):
            if number or at_start:
                fresh.add(len(parts))
            parts.append(part)
    numbers = cut_into_runs(range(len(parts)), lambda _, after: after not in fresh)
    yield from ([parts[k] for k in run] for run in numbers)


def cut_stretch_into_strips(stretch: Stretch, least: float) -> list[Strip]:
    """Return the strips over neighbouring pieces of one line or circle, in running order.

    The stretch is cut where it becomes touchable (covered over ``least`` mm of height), and its parts are
    halved while the range of heights common to a part is too short.
    """
    found: list[Strip] = []
    for part, is_touched in split_touched_parts(stretch, least):
        if is_touched:
            found += halve_stretch(part, least)
        else:
            found += make_strips_over_stretch(part, None)
    return join_strips(found)


def split_touched_parts(stretch: Stretch, least: float) -> Iterator[tuple[Stretch, bool]]:
    """Yield (pieces, is touchable) for the parts of some
    pieces in running order, alternately touchable and not.

    A place is touchable where upright faces cover a range of at least ``least`` mm of height.
    """
    found: list[tuple[list[CoveredPiece], bool]] = []
    for one in stretch:
        for part, is_touched in split_touched_pieces(one, least):
            if part.size <= part.piece.carrier.slack:
                continue
            if found and found[-1][1] == is_touched:
                found[-1][0].append(part)
            else:
                found.append(([part], is_touched))
    yield from found


def split_touched_pieces(one: CoveredPiece, least: float) -> list[tuple[CoveredPiece, bool]]:
    """Return (part, is touchable) for the parts of a piece in the direction of the border.

    A place is touchable where upright faces cover a range of at least ``least`` mm of height.
    """
    if bound_run_length(one) < least - SAME_HEIGHT:
        return [(one, False)]
    if any(
        measure_band(run.compute_common_band(one.low, one.high)) >= least - SAME_HEIGHT for run in one.runs
    ):
        return [(one, True)]

    def measure_spare_height(position: float) -> float:
        """Return by how many mm the longest range of covered heights at a position exceeds ``least``."""
        return one.measure_longest_run_at(position) - (least - ONE_HEIGHT)

    nodes = [one.low, *one.list_inner_positions(), one.high]
    peaks = list(find_threshold_positions(one, nodes, measure_spare_height, least))
    nodes = sorted({*nodes, *peaks})
    # What lacks no more than rounding is long enough, if it is so for a while.
    signs = [measure_spare_height(node) >= ONE_HEIGHT - SAME_HEIGHT for node in nodes]
    cuts = []
    for (a, b), (first, last) in zip(pairwise(nodes), pairwise(signs), strict=True):
        if first != last:
            sign = 1.0 if last else -1.0
            ends = bisect_condition(a, b, partial(has_sign_at, measure_spare_height, sign), (a, b), HALVINGS)
            cuts.append(ends[1] if last else ends[0])
    parts = one.cut_at(cuts)
    return [
        (part, measure_spare_height((part.low + part.high) / 2) >= ONE_HEIGHT - SAME_HEIGHT) for part in parts
    ]


def find_threshold_positions(
    one: CoveredPiece, nodes: Sequence[float], spare: Callable[[float], float], least: float
) -> Iterator[float]:
    """Yield positions strictly between nodes at which the longest
    covered height range may just reach or miss ``least``.

    Between neighbouring nodes both ends of every range are monotonic, so their heights at the nodes bound its
    length. Positions are sought only where these bounds do not decide the question.

    Parameters
    ----------
    nodes : sorted positions.
    spare : returns by how many mm the longest range at a position is long enough.
    """
    for a, b in pairwise(nodes):
        first, last = spare(a) >= 0.0, spare(b) >= 0.0
        if first != last:
            continue
        if first and max(measure_band(run.compute_common_band(a, b)) for run in one.runs) < least:
            yield find_extreme_place(spare, a, b, -1.0)
        elif not first and max(run.bound_length(a, b) for run in one.runs) >= least:
            yield find_extreme_place(spare, a, b, 1.0)


def has_sign_at(value: Callable[[float], float], sign: float, position: float) -> bool:
    """Return whether a function times ``sign`` is 0 or more at a position."""
    return sign * value(position) >= 0.0


def find_extreme_place(value: Callable[[float], float], low: float, high: float, sign: float) -> float:
    """Return the place from ``low`` to ``high`` at which a function is
    greatest (``sign`` 1) or least (``sign`` -1).

    Ternary search: the function must have one extreme there.
    """
    for _ in range(HALVINGS):
        a, b = low + (high - low) / 3, high - (high - low) / 3
        if sign * value(a) < sign * value(b):
            low = a
        else:
            high = b
        if high - low <= 1e-9:
            break
    return (low + high) / 2


def bound_run_length(one: CoveredPiece) -> float:
    """Return an upper bound in mm of the height ranges that upright faces cover
    along a piece; exact where all edges are level.
    """
    return max((run.bound_length(one.low, one.high) for run in one.runs), default=0.0)


def measure_longest_run(one: CoveredPiece, bound: float) -> float:
    """Return the largest length in mm of a height range that upright faces cover along a piece.

    Where the length is found to be above ``bound`` the search ends, and the true length may be larger.
    """
    nodes = [one.low, *one.list_inner_positions(), one.high]
    best = max(map(one.measure_longest_run_at, nodes))
    for a, b in pairwise(nodes):
        most = max((run.bound_length(a, b) for run in one.runs), default=0.0)
        if best <= bound < most:
            best = max(
                best, one.measure_longest_run_at(find_extreme_place(one.measure_longest_run_at, a, b, 1.0))
            )
    return best


def find_common_band(stretch: Stretch) -> Band:
    """Return the longest range of heights (z0, z1) in mm that
    is covered without a gap at every point of some pieces.

    Of equally long ones the lowest; (0, 0) where there is none.
    """
    bands: list[Band] | None = None
    for one in stretch:
        own = [run.compute_common_band(one.low, one.high) for run in one.runs]
        both = own if bands is None else [intersect_bands(a, b) for a in bands for b in own]
        bands = [band for band in both if measure_band(band) > 0.0]
    if not bands:
        return 0.0, 0.0
    most = max(map(measure_band, bands))
    return min(band for band in bands if measure_band(band) >= most - ONE_HEIGHT)


def intersect_bands(a: Band, b: Band) -> Band:
    """Return the intersection of two bands; z1 < z0 where they have nothing in common."""
    return max(a[0], b[0]), min(a[1], b[1])


def is_band_long_enough(stretch: Stretch, band: Band, least: float) -> bool:
    """Return whether a band is at least ``least`` mm long and at least half as
    long as the longest covered range over the pieces.
    """
    if measure_band(band) < least - SAME_HEIGHT:
        return False
    bound = 2 * (measure_band(band) + SAME_HEIGHT)
    return all(bound_run_length(one) <= bound or measure_longest_run(one, bound) <= bound for one in stretch)


def halve_stretch(stretch: Stretch, least: float) -> list[Strip]:
    """Return the strips over touchable pieces, halved until
    the band of each is long enough, see :func:`is_band_long_enough`.

    Strips shorter than ``SHORTEST_STRIP`` are not made; there the band may be None.
    """
    band = find_common_band(stretch)
    if is_band_long_enough(stretch, band, least):
        return make_strips_over_stretch(stretch, band)
    carrier = stretch[0].piece.carrier
    size = sum(one.size for one in stretch)
    unit = carrier.segment.radius if isinstance(carrier.segment, Arc) else 1.0
    if size * unit < 2 * SHORTEST_STRIP:
        return make_strips_over_stretch(stretch, band if measure_band(band) >= least - SAME_HEIGHT else None)
    first, second = split_stretch(stretch, size / 2)
    return [*halve_stretch(first, least), *halve_stretch(second, least)]


def split_stretch(stretch: Stretch, size: float) -> tuple[Stretch, Stretch]:
    """Return (1) the parts of consecutive pieces up to a place and (2) the parts from that place on.

    ``size`` is the place's distance from the start, in mm on a line and in radians on a circle.
    """
    left = size
    slack = stretch[0].piece.carrier.slack
    for k, one in enumerate(stretch):
        if k and left <= slack:
            return list(stretch[:k]), list(stretch[k:])
        if left < one.size - slack:
            place = one.low + left if one.piece.forward else one.high - left
            first, second = one.cut_at([place])
            return [*stretch[:k], first], [second, *stretch[k + 1 :]]
        left -= one.size
    return stretch[:-1], stretch[-1:]


def join_strips(strips: Sequence[Strip]) -> list[Strip]:
    """Return the strips with neighbours of the same band merged.

    ``strips`` must lie on one line or circle, in running order.
    """
    groups: list[list[Strip]] = []
    for strip in strips:
        before = groups[-1][-1].band if groups else ()
        same = before == strip.band or (
            before is not None
            and strip.band is not None
            and len(before) == 2
            and all(abs(a - b) <= SAME_BAND for a, b in zip(before, strip.band, strict=True))
        )
        if groups and same:
            groups[-1].append(strip)
        else:
            groups.append([strip])
    found: list[Strip] = []
    for group in groups:
        covered = [one for strip in group for one in strip.covered]
        bands = [strip.band for strip in group if strip.band is not None]
        band = (max(low for low, _ in bands), min(high for _, high in bands)) if bands else None
        found += make_strips_over_stretch(covered, band) if len({id(strip) for strip in group}) > 1 else group
    return found


def make_strips_over_stretch(stretch: Stretch, band: Band | None) -> list[Strip]:
    """Return the strips over consecutive pieces: usually one, two for an arc above half a circle, none where
    the length is within rounding of 0.
    """
    carrier, forward = stretch[0].piece.carrier, stretch[0].piece.forward
    begin, size = stretch[0].ends[0], sum(one.size for one in stretch)
    if size <= carrier.slack:
        return []
    faces = tuple(sorted({index for one in stretch for index in one.faces})) if band is not None else ()
    halves = [stretch]
    if isinstance(carrier.segment, Arc) and size > pi:
        halves = list(split_stretch(stretch, size / 2))
    step = (size if forward else -size) / len(halves)
    bulge = tan(step / 4) if isinstance(carrier.segment, Arc) else 0.0
    ends = [carrier.compute_point(begin + step * k) for k in range(len(halves) + 1)]
    return [
        Strip(a, b, bulge, band, faces, tuple(half))
        for (a, b), half in zip(pairwise(ends), halves, strict=True)
    ]


def make_run_rows(strip: Strip) -> RunRows:
    """Return the covered range of heights that contains a strip's
    band, as rows (share, z0, z1) along the strip; z in mm.

    The share of the strip's length grows from 0 to 1. Rows 3 k to 3 k + 3 define a cubic for each end, see
    ``model.solid.interpolate_run``. Empty where the range is the band all along, or there is no band.
    """
    band = strip.band
    if band is None:
        return ()
    runs = [find_run_holding(one, band) for one in strip.covered]
    ends = [
        (end.compute_height_range(one.low, one.high), own)
        for one, run in zip(strip.covered, runs, strict=True)
        for end, own in zip((run.lower, run.upper), band, strict=True)
    ]
    if all(abs(z - own) <= SAME_BAND for extent, own in ends for z in extent):
        return ()
    rows: list[tuple[float, float, float]] = []
    size, before = sum(one.size for one in strip.covered), 0.0
    for one, run in zip(strip.covered, runs, strict=True):
        first, last = one.ends
        for position, heights in split_into_cubics(run, one, first, last):
            rows.append(((before + abs(position - first)) / size, *heights))
        before += one.size
    # Where a piece ends the next begins.
    kept = [row for k, row in enumerate(rows) if k % 4 or k == 0]
    return ((0.0, *kept[0][1:]), *kept[1:-1], (1.0, *kept[-1][1:]))


def find_run_holding(one: CoveredPiece, band: Band) -> WallRun:
    """Return, of the height ranges that walls cover over a piece, the one whose intersection with a band is
    longest.
    """
    shared = [
        measure_band(intersect_bands(run.compute_common_band(one.low, one.high), band)) for run in one.runs
    ]
    return one.runs[shared.index(max(shared))]


def split_into_cubics(
    run: WallRun, one: CoveredPiece, first: float, last: float
) -> Iterator[tuple[float, Band]]:
    """Yield (position, (z0, z1)) at four equally spaced positions of each part in which cubics fit a height
    range, part by part.

    Between ``first`` and ``last`` the part is halved until the cubics through its four places, one for each
    end of the range, are within ``CUBIC`` mm. Neighbouring parts both yield their common position.
    """
    places = [first + (last - first) * k / 3 for k in range(4)]
    rows = tuple((k / 3, *run.compute_heights_at(place)) for k, place in enumerate(places))
    unit = one.piece.carrier.segment.radius if isinstance(one.piece.carrier.segment, Arc) else 1.0
    is_off = any(
        abs(a - b) > CUBIC
        for share in (1 / 2, 1 / 6, 5 / 6)
        for a, b in zip(
            interpolate_run(rows, share), run.compute_heights_at(first + (last - first) * share), strict=True
        )
    )
    if is_off and abs(last - first) * unit > SHORTEST_PIECE:
        middle = (first + last) / 2
        yield from split_into_cubics(run, one, first, middle)
        yield from split_into_cubics(run, one, middle, last)
        return
    yield from ((place, row[1:]) for place, row in zip(places, rows, strict=True))
