"""Drawings in the manner of CAD programs, Inkscape and converters, ten of each kind that people bring.

Each is made here: outlines in mm, written with a unit missing, circles as splines or Béziers, layers that overlap, several
parts, gaps, true splines, ellipses, or chords. Nothing is taken from anybody.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from io import StringIO
from math import atan, atan2, cos, hypot, pi, sin, tan
from typing import Any

import ezdxf
from attrs import frozen
from ezdxf.math import ConstructionEllipse, closed_uniform_bspline, rational_bspline_from_ellipse

__all__ = ["DRAWINGS", "KINDS", "Drawing"]

Loop = list[tuple[float, float, float]]
Path = list[tuple[float, float]]

ROUND = tan(pi / 8)
# Outlines with bulges, in mm; what is drawn into them are round holes (x, y, radius).
GUSSET: Loop = [(0, 0, 0), (70, 0, 0), (70, 25, 0), (45, 50, 0), (0, 50, 0)]
LEVER: Loop = [(0, -12, 0), (60, -8, 1), (60, 8, 0), (0, 12, 1)]
TRAY: Loop = [
    (6, 0, 0),
    (64, 0, ROUND),
    (70, 6, 0),
    (70, 34, ROUND),
    (64, 40, 0),
    (6, 40, ROUND),
    (0, 34, 0),
    (0, 6, ROUND),
]
ANGLE: Loop = [(0, 0, 0), (60, 0, 0), (60, 18, 0), (26, 18, -ROUND), (18, 26, 0), (18, 55, 0), (0, 55, 0)]
WEDGE: Loop = [(0, 0, 0), (64, 6, 0), (50, 44, 0), (8, 38, 0)]
SHAPES: list[tuple[Loop, list[tuple[float, float, float]]]] = [
    (GUSSET, [(15, 25, 8)]),
    (LEVER, [(0, 0, 5)]),
    (TRAY, [(18, 20, 5), (52, 20, 7)]),
    (ANGLE, [(9, 9, 4)]),
    (WEDGE, [(28, 20, 9)]),
]


@frozen
class Drawing:
    """A drawing as it comes.

    Parameters
    ----------
    name : of the file.
    content : its bytes.
    width, height : of the part in mm, to a tenth.
    layer : the one with the part, where whoever drew it would have to choose.
    unit : what whoever drew it would answer when asked.
    """

    name: str
    content: bytes
    width: float
    height: float
    layer: str | None = None
    unit: str = "mm"


def size(loop: Loop) -> tuple[float, float]:
    """Width and height of an outline."""
    points = chords(loop, 256)
    xs, ys = zip(*points, strict=True)
    return max(xs) - min(xs), max(ys) - min(ys)


def arc_of(
    p: tuple[float, ...], q: tuple[float, ...], bulge: float
) -> tuple[tuple[float, float], float, float, float]:
    """Centre, radius, first angle and sweep of a segment with a bulge."""
    (x0, y0), (x1, y1) = p[:2], q[:2]
    chord, lift = hypot(x1 - x0, y1 - y0), (1 - bulge * bulge) / (4 * bulge)
    cx, cy = (x0 + x1) / 2 - lift * (y1 - y0), (y0 + y1) / 2 + lift * (x1 - x0)
    return (cx, cy), chord * (1 + bulge * bulge) / (4 * abs(bulge)), atan2(y0 - cy, x0 - cx), 4 * atan(bulge)


def segments(loop: Loop) -> Iterator[tuple[tuple[float, float, float], tuple[float, float, float]]]:
    """Consecutive vertices, the last one with the first."""
    yield from zip(loop, loop[1:] + loop[:1], strict=True)


def chords(loop: Loop, turn: int, digits: int = 12) -> Path:
    """An outline as corners, with so many chords to a whole turn."""
    out: Path = []
    for p, q in segments(loop):
        out.append((round(p[0], digits), round(p[1], digits)))
        if p[2]:
            (cx, cy), radius, first, sweep = arc_of(p, q, p[2])
            count = max(2, round(turn * abs(sweep) / (2 * pi)))
            angles = [first + sweep * k / count for k in range(1, count)]
            out += [
                (round(cx + radius * cos(a), digits), round(cy + radius * sin(a), digits)) for a in angles
            ]
    return out


def circle(x: float, y: float, radius: float) -> Loop:
    """A circle as a loop."""
    return [(x - radius, y, 1), (x + radius, y, 1)]


def beziers(p: tuple[float, ...], q: tuple[float, ...], bulge: float, most: float = pi / 2) -> Iterator[Path]:
    """An arc as cubics, each of at most so much of a turn: three further points each."""
    (cx, cy), radius, first, sweep = arc_of(p, q, bulge)
    count = max(1, round(abs(sweep) / most + 0.499))
    step = sweep / count
    handle = 4 / 3 * tan(step / 4) * radius
    for k in range(count):
        a, b = first + k * step, first + (k + 1) * step
        end = (cx + radius * cos(b), cy + radius * sin(b))
        yield [
            (cx + radius * cos(a) - handle * sin(a), cy + radius * sin(a) + handle * cos(a)),
            (end[0] + handle * sin(b), end[1] - handle * cos(b)),
            end,
        ]


def dxf(draw: Callable[[Any], None], version: str = "R2010", units: int = 4) -> bytes:
    """A DXF file; one of R12 has no unit in its header, of which ezdxf would tell."""
    logging.getLogger("ezdxf").addHandler(logging.NullHandler())
    document = ezdxf.new(version)  # type: ignore[attr-defined]
    if version != "R12":
        document.header["$INSUNITS"] = units
    draw(document.modelspace())
    stream = StringIO()
    document.write(stream)
    return stream.getvalue().encode()


def polyline(
    space: Any, loop: Loop, at: tuple[float, float] = (0, 0), scale: float = 1.0, **attributes: Any
) -> None:
    """A closed polyline with bulges."""
    points = [(at[0] + scale * x, at[1] + scale * y, bulge) for x, y, bulge in loop]
    space.add_lwpolyline(points, format="xyb", close=True, dxfattribs=attributes)


def lines_and_arcs(space: Any, loop: Loop, gap: float = 0.0, **attributes: Any) -> None:
    """Separate LINEs and ARCs, as exploded drawings have them, each line shorter by a gap at its end."""
    for p, q in segments(loop):
        if p[2] == 0.0:
            share = 1 - gap / hypot(q[0] - p[0], q[1] - p[1])
            end = (p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1]))
            space.add_line(p[:2], end, dxfattribs=attributes)
        else:
            center, radius, first, sweep = arc_of(p, q, p[2])
            low, high = (first, first + sweep) if sweep > 0 else (first + sweep, first)
            space.add_arc(center, radius, low * 180 / pi, high * 180 / pi, dxfattribs=attributes)


def svg(body: str, head: str = 'width="100mm" height="80mm" viewBox="-10 -20 100 80"') -> bytes:
    """An SVG file; the part lies with its y up, as Inkscape's drawings of DXF files do."""
    start = f'<?xml version="1.0" encoding="UTF-8"?>\n<svg xmlns="http://www.w3.org/2000/svg" version="1.1" {head}>'
    return f"{start}\n{body}\n</svg>\n".encode()


def path(loop: Loop, digits: int = 4, arcs: str = "A", relative: bool = False, scale: float = 1.0) -> str:
    """Path data of an outline: arcs as A or as cubics, absolute or relative as Inkscape writes them."""

    def word(x: float, y: float) -> str:
        return f"{scale * x:.{digits}f},{scale * y:.{digits}f}"

    x, y, _ = loop[0]
    words, here = [f"{'m' if relative else 'M'} {word(x, y)}"], (round(x, digits), round(y, digits))
    for p, q in segments(loop):
        if p[2] and arcs == "A":
            radius, sweep = arc_of(p, q, p[2])[1], 4 * atan(p[2])
            words.append(
                f"A {scale * radius:.{digits}f} {scale * radius:.{digits}f} 0 0 {int(sweep > 0)} {word(*q[:2])}"
            )
            continue
        for points in beziers(p, q, p[2]) if p[2] else [[q[:2]]]:
            base = here if relative else (0.0, 0.0)
            told = " ".join(word(px - base[0], py - base[1]) for px, py in points)
            words.append(
                f"{'C' if p[2] else 'L'}".lower() * relative
                + ("C" if p[2] else "L") * (not relative)
                + " "
                + told
            )
            end = points[-1]
            here = (round(end[0], digits), round(end[1], digits))
    return f'<path style="fill:none;stroke:#000000;stroke-width:0.1" d="{" ".join(words)} {"z" if relative else "Z"}"/>'


def units_missing() -> Iterator[Drawing]:
    """R12 files, $INSUNITS 0, and SVG without a width or with one in pixels."""
    for k, (outline, holes) in enumerate(SHAPES):
        width, height = size(outline)

        def draw(
            space: Any, outline: Loop = outline, holes: Any = holes, exploded: bool = k % 2 == 0
        ) -> None:
            (lines_and_arcs if exploded else polyline)(space, outline)
            for x, y, radius in holes:
                space.add_circle((x, y), radius)

        yield Drawing(f"unit-{k}.dxf", dxf(draw, "R2000" if k % 2 else "R12", 0), width, height)
        rings = [path(circle(*hole)) for hole in holes]
        head = 'viewBox="-10 -20 100 80"' if k % 2 else 'width="100" height="80"'
        yield Drawing(f"unit-{k}.svg", svg(path(outline) + "".join(rings), head), width, height)


def disguised_circles() -> Iterator[Drawing]:
    """Rational splines, splines of Béziers with the knots that programs write, and Inkscape's paths of cubics."""
    for k, (outline, holes) in enumerate(SHAPES):
        width, height = size(outline)

        def draw(
            space: Any, outline: Loop = outline, holes: Any = holes, rational: bool = k % 2 == 0
        ) -> None:
            lines_and_arcs(space, outline)
            for x, y, radius in holes:
                if rational:
                    ellipse = ConstructionEllipse((x, y), (0, radius), (0, 0, 1), 1.0)
                    space.add_spline().apply_construction_tool(rational_bspline_from_ellipse(ellipse))
                    continue
                (p, q), points = circle(x, y, radius), [(x - radius, y)]
                points += [one for a, b in ((p, q), (q, p)) for piece in beziers(a, b, 1) for one in piece]
                knots = [0] * 4 + [n for n in range(1, 4) for _ in range(3)] + [4] * 4
                spline = space.add_open_spline([(*point, 0) for point in points], degree=3)
                spline.knots = knots

        yield Drawing(f"circle-{k}.dxf", dxf(draw), width, height)
        rings = "".join(path(circle(*hole), 3, "C", relative=True) for hole in holes)
        body = f'<g transform="translate(0,40) scale(1,-1)">{path(outline, 3, "C", relative=k % 2 == 0)}{rings}</g>'
        yield Drawing(f"circle-{k}.svg", svg(body), width, height)


def overlapping_layers() -> Iterator[Drawing]:
    """The part on a layer, and centre lines, a stock outline, a bend, a title or a second view across it on others."""
    crossings: list[Callable[[Any], None]] = [
        lambda space: space.add_line((-5, 20), (80, 21), dxfattribs={"layer": "CENTER"}),
        lambda space: polyline(space, [(-4, -14, 0), (75, -14, 0), (75, 30, 0), (-4, 30, 0)], layer="STOCK"),
        lambda space: space.add_circle((60, 25), 20, dxfattribs={"layer": "TOOLPATH"}),
        lambda space: lines_and_arcs(space, [(10, -3, 0), (80, 10, 0), (40, 48, 0)], layer="BEND"),
        lambda space: polyline(space, [(5, 5, 0), (90, 5, 0), (90, 60, 0), (5, 60, 0)], layer="TITLE"),
    ]
    for k, (outline, holes) in enumerate(SHAPES):
        for more in (k, k + 2):

            def draw(
                space: Any, outline: Loop = outline, holes: Any = holes, across: Any = crossings[more % 5]
            ) -> None:
                polyline(space, outline, layer="PART")
                for x, y, radius in holes:
                    space.add_circle((x, y), radius, dxfattribs={"layer": "PART"})
                across(space)

            yield Drawing(f"layers-{k}-{more}.dxf", dxf(draw), *size(outline), layer="PART")


def several_parts() -> Iterator[Drawing]:
    """A sheet of different parts, the largest of which is meant; in SVG in groups that are moved."""
    for k, (outline, holes) in enumerate(SHAPES):
        other, small = SHAPES[(k + 1) % 5][0], SHAPES[(k + 2) % 5][0]
        width, height = size(outline)

        def draw(
            space: Any,
            parts: Any = ((outline, 0, 1.0), (other, 100, 0.5), (small, 180, 0.3)),
            holes: Any = holes,
        ) -> None:
            for loop, x, scale in parts:
                polyline(space, loop, (x, 0), scale)
            for x, y, radius in holes:
                space.add_circle((x, y), radius)

        yield Drawing(f"parts-{k}.dxf", dxf(draw), width, height)
        rings = "".join(path(circle(*hole)) for hole in holes)
        body = (
            f'<g id="a">{path(outline)}{rings}</g><g transform="translate(90,0) scale(0.4)">{path(other)}</g>'
        )
        yield Drawing(
            f"parts-{k}.svg", svg(body, 'width="200mm" height="80mm" viewBox="-10 -20 200 80"'), width, height
        )


def gaps() -> Iterator[Drawing]:
    """Lines that stop short of the next one by a hundredth to four tenths of a millimetre."""
    for k, (outline, holes) in enumerate(SHAPES):
        for gap in (0.01 * (k + 1), 0.08 * (k + 1)):

            def draw(space: Any, outline: Loop = outline, holes: Any = holes, gap: float = gap) -> None:
                lines_and_arcs(space, outline, gap)
                for x, y, radius in holes:
                    space.add_circle((x, y), radius)

            yield Drawing(f"gap-{k}-{gap:.2f}.dxf", dxf(draw), *size(outline))


def true_splines() -> Iterator[Drawing]:
    """Cams and handles: closed splines, splines between lines, splines of fit points alone, and cubics drawn by hand."""
    for k in range(5):
        ring = [
            ((30 + 4 * cos(3 * a + k)) * cos(a), (24 + 3 * sin(2 * a)) * sin(a))
            for a in (2 * pi * n / 12 for n in range(12))
        ]

        def cam(space: Any, ring: Path = ring, fitted: bool = k % 2 == 1) -> None:
            if fitted:
                space.add_spline([(x, y, 0) for x, y in [*ring, ring[0]]])
            else:
                space.add_spline().apply_construction_tool(
                    closed_uniform_bspline([(x, y, 0) for x, y in ring])
                )
            space.add_circle((0, 0), 6)

        yield Drawing(f"cam-{k}.dxf", dxf(cam), 0, 0)
        x, y = 20 + 3 * k, 34 + 2 * k
        d = f"M 0,0 L 70,0 L 70,20 C 66,{y} 40,{y - 14} {x},{y} C {x - 12},{y + 8} 0,40 0,20 Z"
        yield Drawing(f"handle-{k}.svg", svg(f'<path d="{d}"/>'), 70, 0)


def ellipses() -> Iterator[Drawing]:
    """Whole ellipses as outline and as hole, half ones between lines, and SVG's own."""
    for k in range(5):
        ratio = 0.5 + 0.09 * k

        def flange(space: Any, ratio: float = ratio, half: bool = k % 2 == 1) -> None:
            if half:
                space.add_lwpolyline([(-30, 0), (-30, -20), (30, -20), (30, 0)])
                space.add_ellipse((0, 0), (30, 0), ratio, 0, pi)
            else:
                space.add_ellipse((0, 0), (30, 8), ratio)
            space.add_circle((0, 0), 5)

        yield Drawing(f"ellipse-{k}.dxf", dxf(flange), 60 if k % 2 else 0, 0)
        body = f'<ellipse cx="30" cy="20" rx="32" ry="{32 * ratio:.2f}" transform="rotate({7 * k} 30 20)"/>'
        if k % 2:
            body = f'<path d="M 0 0 H 60 V 20 A 30 {30 * ratio:.2f} 0 0 1 0 20 Z"/>'
        yield Drawing(f"ellipse-{k}.svg", svg(body), 60 if k % 2 else 0, 0)


def chains_of_chords() -> Iterator[Drawing]:
    """Polylines of chords, finer or coarser and with more or fewer digits, as exports for laser cutters have them."""
    for k, (outline, holes) in enumerate(SHAPES):
        width, height = size(outline)
        turn, digits = (720, 360, 240, 720, 500)[k], (6, 4, 4, 3, 12)[k]

        def draw(
            space: Any, outline: Loop = outline, holes: Any = holes, turn: int = turn, digits: int = digits
        ) -> None:
            space.add_lwpolyline(chords(outline, turn, digits), close=True)
            for hole in holes:
                corners = chords(circle(*hole), turn, digits)
                space.add_polyline2d([*corners, corners[0]])

        yield Drawing(f"chords-{k}.dxf", dxf(draw), width, height)
        loops = [chords(outline, turn, digits), *(chords(circle(*hole), turn, digits) for hole in holes)]
        body = "".join('<polygon points="' + " ".join(f"{x},{y}" for x, y in loop) + '"/>' for loop in loops)
        yield Drawing(f"chords-{k}.svg", svg(body), width, height)


KINDS: dict[str, Callable[[], Iterator[Drawing]]] = {
    "units missing": units_missing,
    "circles in disguise": disguised_circles,
    "overlapping layers": overlapping_layers,
    "several parts": several_parts,
    "gaps": gaps,
    "true splines": true_splines,
    "ellipses": ellipses,
    "chords": chains_of_chords,
}
DRAWINGS = {name: list(make()) for name, make in KINDS.items()}
