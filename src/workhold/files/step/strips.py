"""Strips: the segments of an outline by height, each with the band that all of its points have in common.

Glossary
--------
run : neighbouring pieces of one carrier over which the band's ends are continuous.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from math import pi, tan

from attrs import frozen

from workhold.conventions import SAME_HEIGHT
from workhold.files.step.bands import Walls, length
from workhold.files.step.edge_curves import ONE_HEIGHT, bisected, narrowed
from workhold.geometry.loop import runs_around
from workhold.geometry.segment import Arc, Point
from workhold.geometry.subdivision import BorderPiece
from workhold.model.solid import Band

__all__ = ["Strip", "strips_of_loop"]

# How far inside a piece its ends are looked at: a share of it, and in units of what makes two points one.
INSIDE, STEP = 1e-7, 3.0
# Bands whose ends differ by less, in mm, go on from piece to piece.
SAME_BAND = 1e-5
# Shares of a piece below this are not worth a strip of their own.
LEAST_SHARE = 1e-4
NOTHING = (0.0, 0.0)
# Steps in which a piece is searched, and halvings of the one that holds what is searched.
STEPS, HALVINGS = 32, 50


@frozen
class Strip:
    """A segment of the outline with its band.

    Parameters
    ----------
    start, end : (x, y) in mm, run with the material on the left.
    bulge : of the segment.
    band : (z0, z1) in mm that all its points have in common; None where nothing may touch.
    faces : indices of the solid's upright faces over it, in their order.
    """

    start: Point
    end: Point
    bulge: float
    band: Band | None
    faces: tuple[int, ...]


@frozen
class Ends:
    """A piece of the border with its band at both of its ends, in the direction of its run.

    Parameters
    ----------
    piece : of the border.
    first, last : bands at its first and its last point; None where nothing may touch.
    faces : indices of the walls over it.
    """

    piece: BorderPiece
    first: Band | None
    last: Band | None
    faces: tuple[int, ...]

    def at(self, share: float) -> float:
        """The position at a share of the run."""
        low, high = self.piece.low, self.piece.high
        return low + share * (high - low) if self.piece.forward else high - share * (high - low)


def ends_of(piece: BorderPiece, walls: Walls) -> Ends:
    """A piece with its band at both ends."""
    first, used = walls.band(piece, *end_of(piece, at_end=False))
    last, more = walls.band(piece, *end_of(piece, at_end=True))
    return Ends(piece, first, last, tuple(sorted({*used, *more})))


def end_of(piece: BorderPiece, *, at_end: bool) -> tuple[float, float]:
    """The position of an end of a piece's run, and the step from there into the piece."""
    step = min(STEP * piece.carrier.slack, (piece.high - piece.low) / 4)
    return (piece.high, -step) if at_end == piece.forward else (piece.low, step)


def strips_of_loop(loop: Sequence[BorderPiece], walls: Walls, least: float) -> list[Strip]:
    """The segments of a loop with their bands, in running order.

    Parameters
    ----------
    loop : pieces in running order, see ``geometry.subdivision``.
    least : shortest band in mm that may be touched.
    """
    ends = [ends_of(piece, walls) for piece in loop]
    return [strip for run in runs_around(ends, continues) for strip in strips_of_run(run, walls, least)]


def continues(before: Ends, after: Ends) -> bool:
    """Whether a piece continues another: the same carrier and direction, and no jump of the band."""
    if before.piece.carrier is not after.piece.carrier or before.piece.forward != after.piece.forward:
        return False
    if before.last is None or after.first is None:
        return before.last is after.first
    return all(abs(a - b) <= SAME_BAND for a, b in zip(before.last, after.first, strict=True))


def strips_of_run(run: Sequence[Ends], walls: Walls, least: float) -> list[Strip]:
    """A run cut where the common band would fall below the least.

    Strips are made as long as they can be, one after the other. Over one piece each end of the band rises or
    falls only, so a part of a piece has in common what its own two ends have.
    """
    if all(one.first is None and one.last is None for one in run):
        return strips_between(run[0], 0.0, run[-1], 1.0, None, run)
    strips: list[Strip] = []
    opened: tuple[int, float] | None = None
    common: Band | None = None

    def close(k: int, share: float) -> None:
        nonlocal opened, common
        if opened is not None:
            parts = run[opened[0] : k + 1]
            strips.extend(strips_between(parts[0], opened[1], parts[-1], share, common, parts))
        opened, common = None, None

    for k, one in enumerate(run):
        share = 0.0
        while share < 1.0:
            here = band_at(one, walls, share)
            if length(here) < least - SAME_HEIGHT:
                begin = first_long(one, walls, share, least)
                close(k, share)
                strips += strips_between(one, share, one, begin, None, [one])
                share = begin
                continue
            opened = opened or (k, share)
            sofar = overlap(common, here)
            whole = overlap(sofar, band_at(one, walls, 1.0))
            if length(whole) >= least - SAME_HEIGHT:
                common = whole
                break
            end = first_short(one, walls, share, sofar, least)
            if end - share > LEAST_SHARE:
                common = overlap(sofar, band_at(one, walls, end))
                close(k, end)
                share = end
            elif opened != (k, share):
                close(k, share)
            else:
                opened = None
                strips += strips_between(one, share, one, 1.0, None, [one])
                break
    close(len(run) - 1, 1.0)
    return strips


def band_at(one: Ends, walls: Walls, share: float) -> Band:
    """The band at a share of a piece's run; one of no length where nothing may touch."""
    if share <= INSIDE:
        return one.first or NOTHING
    if share >= 1 - INSIDE:
        return one.last or NOTHING
    return walls.band(one.piece, one.at(share))[0] or NOTHING


def overlap(a: Band | None, b: Band) -> Band:
    """What two bands have in common; the second alone without a first."""
    return b if a is None else (max(a[0], b[0]), min(a[1], b[1]))


def first_long(one: Ends, walls: Walls, share: float, least: float) -> float:
    """The least share after one from which on a piece's band is at least as long as asked; 1 for none."""

    def may_be(a: Band, b: Band) -> bool:
        # Both ends of the band are monotone and so lie between those at both ends, whatever walls make it.
        return max(a[1], b[1]) - min(a[0], b[0]) >= least - SAME_HEIGHT

    def spare(band: Band) -> float:
        return length(band) - (least - ONE_HEIGHT)

    return first_share(share, partial(band_at, one, walls), spare, may_be)


def first_short(one: Ends, walls: Walls, share: float, sofar: Band, least: float) -> float:
    """The least share after one at which too little of a piece's band is common with a band; 1 for none."""
    is_single = walls.is_single(one.piece)

    def spare(band: Band) -> float:
        return length(overlap(sofar, band)) - (least - ONE_HEIGHT)

    def may_be(a: Band, b: Band) -> bool:
        # The band of one wall holds what it has in common at both ends.
        return not is_single or spare(overlap(a, b)) < 0.0

    return first_share(share, partial(band_at, one, walls), lambda band: -spare(band), may_be)


def first_share(
    start: float,
    band: Callable[[float], Band],
    value: Callable[[Band], float],
    may_be: Callable[[Band, Band], bool],
) -> float:
    """The least share after a start from which on a band's value, below 0 there, is not; 1 for never.

    Parameters
    ----------
    may_be : whether the value may be 0 or more somewhere between two shares with some bands.
    """
    bands = {0: band(start)}

    def share_of(step: int) -> float:
        return start + (1.0 - start) * step / STEPS

    def band_of(step: int) -> Band:
        if step not in bands:
            bands[step] = band(share_of(step))
        return bands[step]

    def first_step(low: int, high: int) -> int | None:
        if not may_be(band_of(low), band_of(high)):
            return None
        if high - low == 1:
            return high if value(band_of(high)) >= 0.0 else None
        middle = (low + high) // 2
        found = first_step(low, middle)
        return first_step(middle, high) if found is None else found

    step = first_step(0, STEPS)
    if step is None:
        return 1.0
    low, high = share_of(step - 1), share_of(step)

    def at(share: float) -> float:
        return value(band(share))

    known = narrowed(at, (low, value(band_of(step - 1))), (high, value(band_of(step))))
    return bisected(low, high, lambda share: at(share) >= 0.0, known, HALVINGS)[1]


def strips_between(
    first: Ends, start: float, last: Ends, stop: float, band: Band | None, parts: Sequence[Ends]
) -> list[Strip]:
    """The strip from a share of one piece to a share of another on the same carrier; two for a wide arc."""
    carrier, forward = first.piece.carrier, first.piece.forward
    begin = first.at(start)
    covered = sum(one.piece.high - one.piece.low for one in parts)
    covered -= start * (first.piece.high - first.piece.low) + (1 - stop) * (last.piece.high - last.piece.low)
    if covered <= carrier.slack:
        return []
    faces = tuple(sorted({index for one in parts for index in one.faces})) if band is not None else ()
    pieces = 2 if isinstance(carrier.segment, Arc) and covered > pi else 1
    step = covered / pieces if forward else -covered / pieces
    bulge = tan(step / 4) if isinstance(carrier.segment, Arc) else 0.0
    ends = [carrier.at(begin + step * k) for k in range(pieces + 1)]
    return [Strip(a, b, bulge, band, faces) for a, b in pairwise(ends)]
