"""Replacement of a drawing's curves by lines and arcs, and remarks about it.

Glossary
--------
curve : a segment of a drawing that is drawn as a spline, an ellipse or a Bézier curve.
disguise : a curve that is a line or an arc almost exactly, see ``geometry.curve_fit``; others are true
    curves.
fit : largest distance in mm of lines and arcs from a true curve that they stand for; None where true curves
    are refused.
departure : largest distance in mm of lines and arcs from the curve or the chords that they stand for.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import isfinite

from attrs import evolve

from workhold.conventions import READING, SAME_POINT
from workhold.errors import InputError
from workhold.files.budget import UNLIMITED, Budget
from workhold.files.outline.chain import (
    Chain,
    CurveReading,
    Placement,
    format_count,
    format_point,
    list_first_items,
    refuse_numbers,
)
from workhold.files.outline.joining import JoinedLoop
from workhold.files.questions import FIT, LAYERS
from workhold.geometry.curve_fit import FittedCurve, fit_curve
from workhold.geometry.merged_runs import ChordedArcs, describe_chords, find_chorded_arcs, merge_chords
from workhold.geometry.rational import Pieces, join_pieces, split_arc, transform_pieces

__all__ = [
    "CurveReader",
    "check_fit",
    "describe_curve_fit",
    "describe_departure",
    "refuse_true_curves",
    "merge_short_chords",
]

# In mm: what a refusal proposes, finest first, and the finest that is worth anything.
PROPOSED, LEAST_FIT = (0.01, 0.1, 1.0), 1e-4
# Number of arcs and lines of one outline above which a coarser fit is proposed.
MANY_ARCS = 400
# Pieces of curves in one drawing: more are a picture, and would take minutes.
MOST_PIECES = 20_000


def check_fit(fit: float | None) -> float | None:
    """Return the fit (largest distance in mm of arcs from a
    curve); raise InputError below ``LEAST_FIT``. None passes.
    """
    if fit is not None and not (isfinite(fit) and fit >= LEAST_FIT):
        raise InputError(
            f"The fit {fit:g} is not usable: give a length of {LEAST_FIT:g} mm or more, such as 0.01."
        )
    return fit


class CurveReader:
    """A converter of the curves of one drawing into lines
    and arcs, which keeps the reading of each by its label.

    ``budget`` limits the time; None means no limit.
    """

    def __init__(self, fit: float | None, budget: Budget | None = None) -> None:
        self.budget = budget or Budget(UNLIMITED)
        self.fit = PROPOSED[0] if fit is None else fit
        self.found: dict[str, CurveReading] = {}
        self.count = 0

    def make_chain(
        self,
        points: Sequence[Sequence[float]],
        bulges: Sequence[float],
        labels: Sequence[str],
        curved: Mapping[int, Pieces],
        placement: Placement,
    ) -> Chain | None:
        """Return the chain of N placed segments in mm; None if all of them are curves of no length.

        Consecutive curves are fitted as one. Raises InputError for more curves than a drawing has.

        Parameters
        ----------
        points, bulges, labels : N + 1, N and N, in the coordinates they are drawn in.
        curved : pieces of the segments that are curves, by their index; their bulges are ignored.
        placement : the map to mm; arcs that it makes elliptical become curves.
        """
        bent = dict(curved)
        if not placement.keeps_circles:
            ends = [(float(p[0]), float(p[1])) for p in points]
            for label, bulge in zip(labels, bulges, strict=True):
                refuse_numbers(label, bulge=bulge)
            bent |= {
                k: split_arc(ends[k], ends[k + 1], b) for k, b in enumerate(bulges) if b and k not in bent
            }
        turned = placement.map_bulges(bulges)
        matrix = ((placement.a, placement.c, placement.e), (placement.b, placement.d, placement.f))
        out_points, out_bulges, out_labels = [placement(points[0])], [], []
        k = 0
        while k < len(bulges):
            last = k
            while last in bent:
                last += 1
            if last == k:
                out_points.append(placement(points[k + 1]))
                out_bulges.append(turned[k])
                out_labels.append(labels[k])
                k += 1
                continue
            run = transform_pieces(join_pieces([bent[j] for j in range(k, last)]), matrix)
            read = self.read(run, labels[k])
            if read is not None:
                if not out_bulges:
                    out_points = [read.points[0]]
                out_points += read.points[1:]
                out_bulges += read.bulges
                out_labels += [labels[k]] * len(read.bulges)
            k = last
        if not out_bulges:
            return None
        return Chain(tuple(out_points), tuple(out_bulges), tuple(out_labels))

    def read(self, pieces: Pieces, label: str) -> FittedCurve | None:
        """Return the lines and arcs for a curve in mm, and keep its reading; None for a curve of no length.

        Raises
        ------
        InputError
            For more curves than a drawing has, and coordinates that are not finite or too large.
        """
        self.count += len(pieces)
        if self.count > MOST_PIECES:
            raise InputError(
                f"the curves of the drawing have more than {MOST_PIECES} pieces: export the part's outline "
                "only."
            )
        for x, y in (pieces[..., :2] / pieces[..., 2:]).reshape(-1, 2).tolist():
            refuse_numbers(label, x, y)
        fitted = fit_curve(pieces, self.fit, self.budget.check_time)
        if fitted is not None:
            self.found[label] = CurveReading(
                fitted.points[0], fitted.departure, fitted.is_disguise, pieces, len(fitted.bulges)
            )
        return fitted


def select_readings(labels: Iterable[str], found: Mapping[str, CurveReading]) -> dict[str, CurveReading]:
    """Return the readings of the curves among the segments with the given labels, by label."""
    return {label: found[label] for label in labels if label in found}


def refuse_true_curves(
    labels: Iterable[str],
    found: Mapping[str, CurveReading],
    fit: float | None,
    layered: bool,
    budget: Budget | None = None,
) -> None:
    """Raise InputError for an outline with curves that are
    not lines or arcs even nearly, unless a fit is given.

    The message names the first curves, and a fit that would do.

    Parameters
    ----------
    labels : labels of the outline's segments.
    found : readings of the drawing's curves.
    fit : largest distance in mm of lines and arcs from curves; None allows none.
    layered : whether the file has layers to choose.
    budget : limits the time; None means no limit.
    """
    true = {label: one for label, one in select_readings(labels, found).items() if not one.is_disguise}
    if fit is not None or not true:
        return
    for proposed in PROPOSED:
        fitted = [
            (one.arcs, one.departure) if proposed == PROPOSED[0] else refit_curve(one, proposed, budget)
            for one in true.values()
        ]
        arcs, away = sum(count for count, _ in fitted), max(departure for _, departure in fitted)
        if arcs <= MANY_ARCS:
            break
    names = list_first_items([f"{label} at {format_point(one.place)}" for label, one in true.items()][:3])
    more = f" and {len(true) - 3} more" if len(true) > 3 else ""
    one_of = "is a true curve, which is" if len(true) == 1 else "are true curves, which are"
    it = "it" if len(true) == 1 else "them"
    leave = (
        f", or leave {'its layer' if len(true) == 1 else 'their layers'} out with {LAYERS}" if layered else ""
    )
    raise InputError(
        f"{names}{more} {one_of} not made of lines and arcs: give {FIT} {proposed:g} to put "
        f"{format_count(arcs, 'line or arc', 'lines and arcs')} in place of {it}, nowhere farther than {away:.2g} "
        f"mm off{leave}."
    )


def refit_curve(one: CurveReading, fit: float, budget: Budget | None) -> tuple[int, float]:
    """Return (the number of lines and arcs that replace a curve within ``fit`` mm, their largest distance in
    mm from it).

    (0, 0) for a curve of no length. ``budget`` is spent; None means no limit.
    """
    fitted = fit_curve(one.pieces, fit, (budget or Budget(UNLIMITED)).check_time)
    return (0, 0.0) if fitted is None else (len(fitted.bulges), fitted.departure)


def merge_short_chords(
    loops: Sequence[JoinedLoop],
    found: Mapping[str, CurveReading],
    fit: float | None,
    budget: Budget | None = None,
) -> tuple[tuple[JoinedLoop, ...], float, list[str]]:
    """Return (1) the loops with each run of short chords replaced by one line or arc where it fits, (2) the
    largest distance in mm of these from the chords, and (3) remarks.

    Lines and arcs that stand for curves of the drawing are not merged.

    Parameters
    ----------
    found : readings of the drawing's curves.
    fit : largest distance in mm of the new segments from the chords; ``DISGUISE`` if None or less than that.
    budget : limits the time; None means no limit.
    """
    interrupt = (budget or Budget(UNLIMITED)).check_time
    out, away, merged = [], 0.0, 0
    chorded = list[ChordedArcs]()
    for loop in loops:
        kept = [label in found and not found[label].is_disguise for label in loop.labels]
        one = merge_chords(loop.vertices, fit, kept, interrupt)
        out.append(evolve(loop, vertices=one.vertices, labels=tuple(loop.labels[k] for k in one.firsts)))
        left = find_chorded_arcs(one.vertices, [kept[k] for k in one.firsts], interrupt)
        chorded += [left] if left is not None and (fit is None or left.fit > fit) else []
        away = max(away, one.departure)
        merged += (one.merged + len(one.firsts)) * (one.departure > SAME_POINT)
    total = sum(len(loop.labels) for loop in out)
    remark = f"Read {merged} segments as the longer lines and arcs that they are part of"
    off = f", nowhere farther than {away:.2g} mm off" if away >= READING else ""
    return (
        tuple(out),
        away,
        [
            *(
                [f"{remark}{off}: the outline has {format_count(total, 'segment', 'segments')}."]
                if merged
                else []
            ),
            *describe_chords(chorded, FIT),
        ],
    )


def describe_curve_fit(labels: Iterable[str], found: Mapping[str, CurveReading]) -> tuple[float, list[str]]:
    """Return the largest distance in mm of lines and arcs from the curves that they replace, and remarks.

    The distance is 0 for an outline without curves.

    Parameters
    ----------
    labels : labels of the outline's segments.
    found : readings of the drawing's curves.
    """
    read = select_readings(labels, found)
    remarks = []
    for is_disguise in (True, False):
        some = [one for one in read.values() if one.is_disguise == is_disguise]
        if not some:
            continue
        away = max(one.departure for one in some)
        curves, off = format_count(len(some), "curve", "curves"), f"nowhere farther than {away:.2g} mm off"
        if is_disguise:
            remarks.append(
                f"Read {curves} as the lines and arcs that they stand "
                f"for{'' if away < READING else ', ' + off}."
            )
        else:
            arcs = format_count(sum(one.arcs for one in some), "line or arc", "lines and arcs")
            remarks.append(f"Put {arcs} in place of {curves}, {off}.")
    return max((one.departure for one in read.values()), default=0.0), remarks


def describe_departure(departure: float) -> list[str]:
    """Return a list with a remark on an outline that lies ``departure`` mm from what was drawn; [] if that is
    negligible.
    """
    if departure < READING:
        return []
    return [
        f"Fixtures are found for this outline, which is up to {departure:.2g} mm off the drawing; that "
        "counts in the tolerance of its faces."
    ]
