"""Shapes, transforms, units and refusals of SVG drawings."""

from __future__ import annotations

from math import cos, pi, radians, sin
from pathlib import Path

import pytest
from attrs import evolve
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from reading_helpers import area, perimeter, read_svg

from workhold import load
from workhold.errors import InputError
from workhold.files.budget import LIMITS

MM = 'width="100mm" height="50mm" viewBox="0 0 100 50"'
D = '<path id="d" d="M 0 0 h 40 a 10 10 0 0 1 0 20 h -40 z"/>'


@pytest.mark.parametrize(
    "root",
    [
        'width="100mm" height="50mm"',
        'width="10cm" height="5cm"',
        'width="100mm" height="50mm" viewBox="0 0 100 50"',
        'width="100mm" height="50mm" viewBox="-7 -9 1000 500"',
        'width="4in" height="2in"',
        'width="283.46456692913387pt" height="141.73228346456693pt"',
    ],
)
def test_a_rect_in_mm_measures_what_it_says(tmp_path: Path, root: str) -> None:
    """A rect of width 60mm is 60 mm wide only if user units are CSS pixels; with a viewBox they are the viewBox's."""
    if "viewBox" in root:
        scale = 10 if "1000" in root else 1
        body = f'<rect x="0" y="0" width="{60 * scale}" height="{40 * scale}"/>'
    else:
        body = '<rect width="60mm" height="40mm"/>'
    part = read_svg(tmp_path, body, root).workpiece
    x0, y0, x1, y1 = part.bounds
    assert (x1 - x0, y1 - y0) == pytest.approx((60, 40), rel=1e-12)


def test_y_points_up_and_the_page_corner_is_the_origin(tmp_path: Path) -> None:
    """A triangle with its tip at the top of the screen has its tip at the largest y."""
    part = read_svg(tmp_path, '<polygon points="10,40 30,40 20,10"/>', MM).workpiece
    tip = max(part.loops[0].tolist(), key=lambda row: row[1])
    assert tip[:2] == pytest.approx([20, 40])
    assert part.bounds == pytest.approx((10, 10, 30, 40))


@pytest.mark.parametrize(("unit", "mm"), [("mm", 1), ("inch", 25.4), ("cm", 10)])
def test_files_without_physical_size_need_a_unit(tmp_path: Path, unit: str, mm: float) -> None:
    """Pixels are not a length: without width and height in mm the user says what a user unit is."""
    for root in (
        "",
        'width="100" height="50"',
        'width="100%"',
    ):
        with pytest.raises(
            InputError,
            match=r"drawn\.svg: the drawing has no physical size.*: it is 50 mm wide, or 50 in = 1,270 mm; say which",
        ):
            read_svg(tmp_path, D, root)
        assert area(read_svg(tmp_path, D, root, unit=unit).workpiece) == pytest.approx(
            (800 + 50 * pi) * mm**2
        )


def test_a_given_unit_overrides_the_size(tmp_path: Path) -> None:
    """One user unit is then one of that unit, and this is said."""
    loaded = read_svg(tmp_path, D, MM, unit="inch")
    assert area(loaded.workpiece) == pytest.approx((800 + 50 * pi) * 25.4**2)
    assert "makes a user unit 1 mm; it was read as 1 inch" in loaded.remarks[0]
    assert read_svg(tmp_path, D, MM, unit="mm").remarks == ()


def test_circles_and_round_corners_are_arcs(tmp_path: Path) -> None:
    """A rect with corner radius r loses (4 - pi) r²; circles are two halves; an ellipse of equal radii is a circle."""
    body = '<rect width="60" height="40" rx="8"/><circle cx="20" cy="20" r="5"/><ellipse cx="40" cy="20" rx="4" ry="4"/>'
    part = read_svg(tmp_path, body, MM).workpiece
    assert area(part) == pytest.approx(2400 - (4 - pi) * 64 - 41 * pi, rel=1e-12)
    assert [len(loop) for loop in part.loops] == [8, 2, 2]


@pytest.mark.thorough
def test_a_rect_rounded_to_the_full_is_a_stadium(tmp_path: Path) -> None:
    """Radii are limited to half the side; sides that vanish leave no zero-length segment."""
    part = read_svg(tmp_path, '<rect width="60" height="40" ry="20"/>', MM).workpiece
    assert area(part) == pytest.approx(800 + 400 * pi, rel=1e-12)
    assert len(part.segments) == 4
    round_one = read_svg(tmp_path, '<rect width="40" height="40" rx="99"/>', MM).workpiece
    assert area(round_one) == pytest.approx(400 * pi, rel=1e-12)
    ellipse = read_svg(tmp_path, '<rect width="60" height="40" rx="30" ry="20"/>', MM, fit=0.001).workpiece
    assert area(ellipse) == pytest.approx(600 * pi, abs=0.001 * 160)


@pytest.mark.parametrize(
    "data",
    [
        "M0 0H40A10 10 0 0 1 40 20H0Z",
        "m0,0 40,0 a10 10 0 0110 10 10 10 0 01-10 10 l-40,0z",
        "M0 0 L40 0 A10 10 0 0 1 40 20 L0 20 L0 0",
        "M0 0 L40 0 A10 10 77 0 1 40 20 L0 20 L0 0 Z",
        "M0 20 L40 20 A10 10 0 0 0 40 0 L0 0 Z",
    ],
)
def test_the_same_path_in_other_words(tmp_path: Path, data: str) -> None:
    """Absolute, relative, compact flags, implicit and explicit closing."""
    part = read_svg(tmp_path, f'<path d="{data}"/>', MM).workpiece
    assert area(part) == pytest.approx(800 + 50 * pi, rel=1e-12)
    assert perimeter(part) == pytest.approx(100 + 10 * pi, rel=1e-12)


def test_large_arcs_and_arcs_too_small_for_their_ends(tmp_path: Path) -> None:
    """The large-arc flag gives the other piece; a radius that is too small grows to half the chord (SVG 1.1, F.6.6)."""
    large = read_svg(tmp_path, '<path d="M0 0 A 10 10 0 1 1 10 10 z"/>', MM).workpiece
    assert area(large) == pytest.approx(100 * (3 * pi / 4 + 0.5), rel=1e-9)
    grown = read_svg(tmp_path, '<path d="M0 0 A 1 1 0 0 1 20 0 z"/>', MM).workpiece
    assert area(grown) == pytest.approx(50 * pi, rel=1e-9)
    nearly_full = read_svg(tmp_path, '<path d="M10 0 A 10 10 0 1 1 9.999 -0.1414 L 10 0"/>', MM).workpiece
    assert area(nearly_full) == pytest.approx(100 * pi, rel=1e-3)


def test_holes_loose_lines_and_subpaths(tmp_path: Path) -> None:
    """Subpaths are loops of their own, and loose lines are joined as in DXF."""
    body = '<path d="M0 0 H60 V40 H0 Z M10 10 V20 H20 V10 Z"/><line x1="30" y1="10" x2="40" y2="10"/>'
    body += '<polyline points="40,10 40,20 30,20 30,10"/>'
    part = read_svg(tmp_path, body, MM).workpiece
    assert area(part) == pytest.approx(2400 - 200)
    assert len(part.loops) == 3


def test_a_loop_that_is_painted_over_is_reported(tmp_path: Path) -> None:
    """Two squares of one path, run the same way: by the nonzero rule the inner one is not seen; else it is a hole."""
    data = 'd="M0 0 H60 V40 H0 Z M10 10 H20 V20 H10 Z"'
    over = read_svg(tmp_path, f"<path {data}/>", MM)
    assert area(over.workpiece) == pytest.approx(2400)
    assert any("Left out 1 loop that is painted over" in remark for remark in over.remarks)
    for attribute in ('fill-rule="evenodd"', 'fill="none" stroke="#000"', 'stroke="#000"'):
        assert area(read_svg(tmp_path, f"<path {attribute} {data}/>", MM).workpiece) == pytest.approx(2300)


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(angle=st.floats(-360, 360), scale=st.floats(0.2, 5), mirror=st.booleans(), x=st.floats(-50, 50))
def test_transforms_that_keep_circles(
    tmp_path: Path, angle: float, scale: float, mirror: bool, x: float
) -> None:
    """Groups, use and nested transforms compose: area times scale², and a known point lands where it must."""
    sy = -scale if mirror else scale
    body = (
        f'<defs>{D}</defs><g transform="translate({x!r}, 3) rotate({angle!r})">'
        f'<g transform="scale({scale!r}, {sy!r})"><use href="#d" x="2" y="1"/></g></g>'
    )
    part = read_svg(tmp_path, body, unit="mm").workpiece
    assert area(part) == pytest.approx((800 + 50 * pi) * scale**2, rel=1e-9)
    c, s = cos(radians(angle)), sin(radians(angle))
    u, v = scale * 52, sy * 11  # the arc's middle, (50, 10), moved by (2, 1)
    middle = (c * u - s * v + x, -(s * u + c * v + 3))
    arc = next(segment for segment in part.segments if hasattr(segment, "radius"))
    assert arc.compute_point(0.0) == pytest.approx(middle, abs=1e-7)
    assert arc.radius == pytest.approx(10 * scale, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "factor"),
    [
        ("matrix(0 2 -2 0 5 6)", 4),
        ("rotate(30 5 5), translate(4)", 1),
        ("scale(3)", 9),
        ("rotate(90)scale(-1,1)", 1),
    ],
)
def test_transform_functions(tmp_path: Path, text: str, factor: float) -> None:
    """Every form of SVG's transform list that keeps circles."""
    body = f'<g transform="{text}">{D}</g>'
    assert area(read_svg(tmp_path, body, unit="mm").workpiece) == pytest.approx(factor * (800 + 50 * pi))


@pytest.mark.thorough
def test_unequal_scales_turn_arcs_into_ellipses(tmp_path: Path) -> None:
    """Skewed lines are lines; skewed arcs, also those whose axes keep their lengths, need a fit."""
    body = '<g transform="skewX(20) scale(2 3)"><rect width="10" height="5"/></g>'
    assert area(read_svg(tmp_path, body, MM).workpiece) == pytest.approx(300)
    for text in ("scale(2 3)", "skewX(20)", "skewY(-3)", "matrix(1 0 0.1 1 0 0)", "matrix(1 0 0.6 0.8 0 0)"):
        with pytest.raises(InputError, match=r"path 'd' segment 2 at \(.*\) is a true curve"):
            read_svg(tmp_path, f'<g transform="{text}">{D}</g>', MM)
    skewed = read_svg(tmp_path, f'<g transform="matrix(1 0 0.6 0.8 0 0)">{D}</g>', MM, fit=0.001).workpiece
    assert area(skewed) == pytest.approx(0.8 * (800 + 50 * pi), abs=0.001 * 150)


@pytest.mark.parametrize(
    "hidden",
    [
        f'<g display="none">{D}</g>',
        f'<g style="fill:red; display:none">{D}</g>',
        f'<style>.x, .off {{ display: none }}</style><g class="b off">{D}</g>',
        f"<style>#d {{ display: none; }}</style>{D}",
        f'<g visibility="hidden">{D}</g>',
        f'<g style="visibility:hidden"><g>{D}</g></g>',
        f"<defs>{D}</defs>",
        f"<clipPath>{D}</clipPath>",
        f"<symbol>{D}</symbol>",
        f"<mask>{D}</mask>",
    ],
)
def test_what_is_not_shown_does_not_count(tmp_path: Path, hidden: str) -> None:
    """Hidden elements and definitions are left out."""
    part = read_svg(tmp_path, f'<rect width="5" height="5"/>{hidden}', MM).workpiece
    assert area(part) == pytest.approx(25)


def test_text_and_images_are_ignored_and_counted(tmp_path: Path) -> None:
    """Foreign elements pass in silence, text and images are counted."""
    body = f'{D}<text>hello</text><image/><text/><x:y xmlns:x="u"><rect width="900" height="900"/></x:y><title>t</title>'
    loaded = read_svg(tmp_path, body, MM)
    assert area(loaded.workpiece) == pytest.approx(800 + 50 * pi)
    assert loaded.remarks == ("Ignored elements that are not an outline: 1 image, 2 text.",)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ('<path id="c" d="M0 0 C 1 1 2 2 3 0 z"/>', r"path 'c' segment 1 at \(0, .*\) is a true curve"),
        ('<path d="M0 0 h 5 S 2 2 3 0"/>', r"number 1 \(without id\) segment 2 at \(5, .* true curve"),
        ('<path id="q" d="M0 0 q 2 2 3 0"/>', "path 'q' segment 1 at .* true curve"),
        ('<path id="t" d="M0 0 q 1 1 2 0 t 2 5"/>', "path 't' segment 1 at .* true curve"),
        ('<path id="e" d="M0 0 A 9 5 0 0 1 6 0 z"/>', "path 'e' segment 1 at .* true curve"),
        ('<ellipse id="e" rx="5" ry="3"/>', "ellipse 'e' at .* true curve"),
        ('<path id="p" d="M0 0 h 5 L 3"/>', "path 'p' has path data that cannot be read"),
        ('<path id="p" d="M0 0 h 5 v nonsense"/>', "path 'p' has path data that cannot be read"),
        ('<path id="p" d="L 3 3 z"/>', "path 'p'.*path data"),
        ('<path id="p" d="M0 0 L 1e400 0 z"/>', "path 'p'.*not finite"),
        ('<rect id="r" width="5em" height="5"/>', "rect 'r' has width=\"5em\", which is not a plain length"),
        ('<polygon id="g" points="1 2 3"/>', "polygon 'g' has an odd number"),
        ('<polygon id="g" points="1 2 x 3"/>', "polygon 'g': points '1 2 x 3' is not a list of numbers"),
        ('<g id="g" transform="spin(3)"><rect width="5" height="5"/></g>', "g 'g' has the transform 'spin"),
        ('<g id="g" transform="rotate(3"><rect width="5" height="5"/></g>', "g 'g' has the transform"),
        ('<g id="g" transform="rotate(1e999)"><rect width="5" height="5"/></g>', "number that is too large"),
        (
            '<g transform="scale(0)"><rect id="r" width="5" height="5"/></g>',
            "rect 'r' has a transform that crushes it",
        ),
        ('<use id="u" href="#gone"/>', "use 'u' shows '#gone', which is not in the file"),
        ('<use id="u" href="other.svg#x"/>', "not in the file"),
        ('<g id="a"><use id="u" href="#a"/></g>', "use 'u' of use 'u' shows itself"),
        ("", "no lines or arcs that could be an outline"),
        ('<line x2="5" stroke="red"/>', "no outline is closed: line number 1"),
    ],
)
def test_refusals_name_element_and_place(tmp_path: Path, body: str, words: str) -> None:
    """One sentence for everything that is not a line, arc or number."""
    with pytest.raises(InputError, match=words) as caught:
        read_svg(tmp_path, body, MM)
    assert str(caught.value).startswith("drawn.svg: ")
    assert "\n" not in str(caught.value)


def test_layers_are_for_dxf(tmp_path: Path) -> None:
    """SVG has no layers to choose."""
    with pytest.raises(InputError, match="DXF files only"):
        read_svg(tmp_path, D, MM, layers=["a"])


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ('<svg xmlns="http://www.w3.org/2000/svg"><rect', r"not valid XML \(.* at line 1, column"),
        ("<html/>", "not an SVG drawing"),
        ('<!DOCTYPE svg [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><svg>&b;</svg>', "declares XML entities"),
        ('<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]><svg>&x;</svg>', "declares XML entities"),
        ("<svg>" + "<g>" * 100_000, "nested more than 200 levels"),
        (
            '<svg xmlns="http://www.w3.org/2000/svg" width="9mm" viewBox="0 0 0 0"/>',
            "viewBox '0 0 0 0' of the root <svg> is not usable",
        ),
        (
            '<svg xmlns="http://www.w3.org/2000/svg" width="9mm" viewBox="a"/>',
            "the viewBox of the root <svg> 'a' is not a list",
        ),
        ('<svg xmlns="http://www.w3.org/2000/svg" width="0mm"/>', "not positive"),
    ],
)
def test_broken_and_hostile_files(tmp_path: Path, content: str, words: str) -> None:
    """Broken XML, entity bombs, endless nesting and impossible page sizes."""
    (tmp_path / "bad.svg").write_text(content)
    with pytest.raises(InputError, match=words):
        load(tmp_path / "bad.svg")


def test_use_bombs_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten levels of ten <use> elements stop at the limit."""
    monkeypatch.setitem(LIMITS, "svg", evolve(LIMITS["svg"], most_elements=1000))
    levels = '<g id="g0"><rect width="1" height="1"/></g>'
    for k in range(1, 11):
        levels += f'<g id="g{k}">' + f'<use href="#g{k - 1}"/>' * 10 + "</g>"
    with pytest.raises(InputError, match="more than the 1,000 elements"):
        read_svg(tmp_path, f'<defs>{levels}</defs><use href="#g10"/>', MM)
