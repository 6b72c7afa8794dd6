"""What Open CASCADE says of the heights at which walls stand over an outline; nothing here is the program's word.

Upright lines a little inside a segment run through the solid where a wall stands over it, and those a little
outside meet nothing.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice, pairwise
from math import ceil, pi
from typing import Any

import numpy as np
import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.BRepClass3d import BRepClass3d_SolidClassifier
from OCP.gp import gp_Ax1, gp_Ax2, gp_Dir, gp_Lin, gp_Pnt, gp_Trsf, gp_Vec
from OCP.IntCurvesFace import IntCurvesFace_ShapeIntersector
from OCP.TopAbs import TopAbs_State

from workhold.files.step.heights import HeightOutline
from workhold.geometry.loop import list_loop_faces, make_loop_segments
from workhold.geometry.segment import Arc, Segment
from workhold.model.solid import Band

__all__ = ["band_faults", "listed", "mirrored", "placed", "runs_beside", "unlike"]

# How far beside the border lines run, and how near its ends they come, in mm.
BESIDE, ASIDE = 1e-5, 2e-3
# mm. A fillet that begins at a wall's edge lies within the lines' distance over this much of its height.
ROUNDED = 0.02
# Segments shorter than this in mm may lie anywhere.
MARGINAL = 0.02


def placed(shape: Any, degrees: float, x: float = 0.0, y: float = 0.0) -> Any:
    """A shape turned about the upright axis and moved."""
    turn, move = gp_Trsf(), gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(3, -2, 0), gp_Dir(0, 0, 1)), np.radians(degrees))
    move.SetTranslation(gp_Vec(x, y, 0.0))
    return BRepBuilderAPI_Transform(shape, move.Multiplied(turn), True).Shape()


def mirrored(shape: Any) -> Any:
    """A shape seen in an upright mirror."""
    mirror = gp_Trsf()
    mirror.SetMirror(gp_Ax2(gp_Pnt(1, 2, 0), gp_Dir(1, 0, 0)))
    return BRepBuilderAPI_Transform(shape, mirror, True).Shape()


def segments_of(outline: HeightOutline) -> list[tuple[Segment, Band | None]]:
    """All segments of an outline with their bands."""
    every = [segment for loop in outline.vertices for segment in make_loop_segments(loop)]
    return list(zip(every, outline.bands, strict=True))


def listed(outline: HeightOutline) -> list[tuple[float, ...]]:
    """Length and band of every face, sorted: the same however the part lies."""
    found, bands = list[tuple[float, ...]](), iter(outline.bands)
    for loop in outline.vertices:
        own = list(islice(bands, len(loop)))
        for face in list_loop_faces(make_loop_segments(loop), 0, own):
            band = own[face.segments[0]] or (-1.0, -1.0)
            # Half a circle is one face or two, by rounding.
            sweep = face.segment.half_extent if isinstance(face.segment, Arc) else 0.0
            parts = max(ceil(sweep / (pi / 4) - 0.01), 1)
            found += [(face.segment.length / parts, *band)] * parts
    return sorted(found, key=lambda one: [round(value, 3) for value in one])


def unlike(a: HeightOutline, b: HeightOutline, off: float = 1e-4) -> str:
    """How two outlines differ as lists of lengths and bands; empty where they are alike."""
    left = listed(b)
    for one in listed(a):
        near = min(
            left, key=lambda other: max(abs(p - q) for p, q in zip(one, other, strict=True)), default=()
        )
        if not near or max(abs(p - q) for p, q in zip(one, near, strict=True)) > off:
            return f"{one} is not in the other, where {near} is nearest"
        left.remove(near)
    return f"{left[0]} is only in the other" if left else ""


def runs_beside(shape: Any, point: tuple[float, float], low: float, high: float) -> list[Band]:
    """Ranges of z in mm between two heights in which the upright line through a point runs in a solid."""
    meets = IntCurvesFace_ShapeIntersector()
    meets.Load(shape, 1e-7)
    meets.Perform(gp_Lin(gp_Pnt(*point, -1.0), gp_Dir(0, 0, 1)), -10.0, 1e4)
    met = sorted(meets.WParameter(k) - 1.0 for k in range(1, meets.NbPnt() + 1))
    classifier, found = BRepClass3d_SolidClassifier(shape), list[Band]()
    for a, b in pairwise(met):
        if b - a < 1e-6:
            continue
        classifier.Perform(gp_Pnt(*point, (a + b) / 2), 1e-7)
        if classifier.State() == TopAbs_State.TopAbs_IN and min(b, high) - max(a, low) > 0.0:
            if found and a - found[-1][1] < 1e-6:
                found[-1] = found[-1][0], min(b, high)
            else:
                found.append((max(a, low), min(b, high)))
    return found


def band_faults(
    shape: Any, outline: HeightOutline, low: float = 0.0, high: float | None = None, count: int = 5
) -> Iterator[str]:
    """What is wrong with the bands of an outline, measured by upright lines beside each segment.

    Parameters
    ----------
    shape : lowest at 0, axis up.
    low, high : heights of pegs in mm; up to the peg height if not given.
    """
    high = outline.peg_height if high is None else high
    for segment, band in segments_of(outline):
        unit = segment.length / (2 * segment.half_extent)
        reach = segment.half_extent - ASIDE / unit
        if segment.length < MARGINAL:
            continue
        for share in np.linspace(-1.0, 1.0, count):
            place = float(share * reach)
            (x, y), (nx, ny) = segment.compute_point(place), segment.compute_normal(place)
            where = f"({x:.4f}, {y:.4f}), of a segment {segment.length:.4f} long with the band {band}"
            inner = runs_beside(shape, (x - BESIDE * nx, y - BESIDE * ny), low, high)
            outer = runs_beside(shape, (x + BESIDE * nx, y + BESIDE * ny), low, high)
            if sum(b - a for a, b in outer) > ROUNDED:
                yield f"material {outer} before {where}"
            longest = max((b - a for a, b in inner), default=0.0)
            if band is None:
                if longest > outline.least_band + 2 * ROUNDED:
                    yield f"a run of {longest:.4f} at {where}"
                continue
            if not any(a - 1e-3 <= band[0] and band[1] <= b + 1e-3 for a, b in inner):
                yield f"only {inner} at {where}"
            if band[1] - band[0] < longest / 2 - ROUNDED:
                yield f"runs {inner} at {where}"
            if band[1] - band[0] < outline.least_band - 2e-5:
                yield f"a band shorter than the least at {where}"
