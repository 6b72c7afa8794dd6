"""What the author of a drawing sees is what is read: each way of SVG and CSS to say it, beside its plain writing."""

from __future__ import annotations

import pytest

from workhold.errors import InputError
from workhold.files.svg.reader import read_svg

MM = 'width="100mm" height="100mm" viewBox="0 0 100 100"'
SEEN = '<rect x="60" y="60" width="20" height="20"/>'
R = '<rect id="r" x="10" y="20" width="40" height="30"'
CLIP = '<clipPath id="c"><rect x="0" y="0" width="55" height="55"/></clipPath>'


def svg(body: str, root: str = MM) -> bytes:
    """A drawing."""
    start = f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" {root}>'
    return f"{start}{body}</svg>".encode()


def outlines(body: str, root: str = MM) -> list[object]:
    """Corners and sizes of bulges of each chain read, in whatever order and sense it is drawn."""
    return sorted(
        (
            sorted({(round(x, 6) + 0.0, round(y, 6) + 0.0) for x, y in chain.points}),
            sorted(round(abs(bulge), 9) for bulge in chain.bulges),
        )
        for chain in read_svg(svg(body, root), unit=None).chains
    )


@pytest.mark.parametrize(
    ("body", "plain"),
    [
        (f'{R} style="transform:translate(5px, 1mm)"/>', f'{R} transform="translate(5 3.7795275590551)"/>'),
        (f'{R} transform="scale(9)" style="transform:rotate(0.25turn)"/>', f'{R} transform="rotate(90)"/>'),
        (
            f'{R} style="translate:5px 2px;rotate:90deg;scale:50% 2"/>',
            f'{R} transform="translate(5 2) rotate(90) scale(.5 2)"/>',
        ),
        (
            f"<style>rect{{transform:skew(10deg) scaleX(-1)}}</style>{R}/>",
            f'{R} transform="skewX(10) scale(-1 1)"/>',
        ),
        (f'{R} transform="skewX(45)"/>', f'{R} transform="matrix(1 0 1 1 0 0)"/>'),
        (f'{R} transform="skewY(45)"/>', f'{R} transform="matrix(1 1 0 1 0 0)"/>'),
        (f'{R} style="transform:skew(45deg,-45deg)"/>', f'{R} transform="matrix(1 -1 1 1 0 0)"/>'),
        (
            f'{R} transform="scale(2)" style="transform-origin:10px 20px"/>',
            f'{R} transform="matrix(2 0 0 2 -10 -20)"/>',
        ),
        (
            f'{R} transform="scale(2)" transform-origin="right 20%"/>',
            f'{R} transform="matrix(2 0 0 2 -100 -20)"/>',
        ),
        (
            f'{R} style="x:3px;y:4px;width:5mm;height:25%;rx:1px"/>',
            '<rect x="3" y="4" width="18.897637795275593" height="25" rx="1"/>',
        ),
        ('<circle cx="9" r="5" style="cx:10px;cy:12px;r:4px"/>', '<circle cx="10" cy="12" r="4"/>'),
        ('<path d="M0 0h9v9z" style="d:path(\'M1 2h9v9z\')"/>', '<path d="M1 2h9v9z"/>'),
        (
            '<rect width="50%" height="10%"/><circle r="10%"/>',
            '<rect width="50" height="10"/><circle r="10"/>',
        ),
        ('<rect width="40Q" height="1IN"/>', '<rect width="1cm" height="96"/>'),
        ('<ellipse cx="5" cy="6" ry="4"/>', '<circle cx="5" cy="6" r="4"/>'),
        ('<path d="M10 10H50A0 5 0 0 1 50 50H10Z"/>', '<path d="M10 10H50V50H10Z"/>'),
        ('<path d="M10 10H50a5,0,7,1120-5V50H10Z"/>', '<path d="M10 10H50l20 -5V50H10Z"/>'),
        ('<path d="M10 10H50A5 5 0 0 1 50 10V50H10Z"/>', '<path d="M10 10H50V50H10Z"/>'),
        ('<path d="M10 10H50V50"/>', '<path d="M10 10H50V50Z"/>'),
        ('<svg x="5" y="6"><rect width="9" height="8"/></svg>', '<rect x="5" y="6" width="9" height="8"/>'),
        (
            '<svg x="5" width="40" height="20" viewBox="1 2 10 10"><rect x="1" y="2" width="10" height="10"/></svg>',
            '<rect x="15" width="20" height="20"/>',
        ),
        (
            '<svg width="40" height="20" viewBox="0 0 10 10" preserveAspectRatio="none"><rect width="10" height="5"/></svg>',
            '<rect width="40" height="10"/>',
        ),
        (
            '<svg width="40" height="20" viewBox="0 0 10 10" preserveAspectRatio="xMaxYMax slice" overflow="visible">'
            '<rect width="10" height="10"/></svg>',
            '<rect y="-20" width="40" height="40"/>',
        ),
        (
            '<symbol id="s" viewBox="0 0 2 2"><rect width="2" height="1"/></symbol>'
            '<use href="#s" x="3" y="4" width="20" height="20"/>',
            '<rect x="3" y="4" width="20" height="10"/>',
        ),
        (
            f'{R}/><use xlink:href="#r" x="1"/><rect id="r" width="9" height="9"/>',
            f'{R}/>{R} transform="translate(1)"/><rect width="9" height="9"/>',
        ),
        (f'{CLIP}<g clip-path="url(#c)">{R}/>{SEEN}</g>', f"{R}/>"),
        (
            f'<clipPath id="c"><path d="M9 9L90 9L90 90L9 90Z"/></clipPath>{R} style="clip-path:url(#c)"/>',
            f"{R}/>",
        ),
        (f'<switch><rect requiredExtensions="x" width="5" height="5"/>{R}/>{SEEN}</switch>', f"{R}/>"),
        (f'{SEEN}<g requiredExtensions="">{R}/></g>', SEEN),
        (f'<g visibility="hidden">{R}/><g style="visibility:visible">{SEEN}</g></g>', SEEN),
        (f'<g display="none" style="display:inline">{SEEN}</g>', SEEN),
        (f'{SEEN}{R} style="fill:none;fill:nonsense"/>', SEEN),
        (
            f'<style>rect{{display:none}} #a{{display:inline}}</style>{R}/><g>{SEEN[:5]} id="a"{SEEN[5:]}</g>',
            SEEN,
        ),
        (f'<style>rect{{fill:red !important}}</style>{SEEN[:5]} style="fill:none"{SEEN[5:]}', SEEN),
        (f"<style>@media screen{{#r{{opacity:0}}}} @font-face{{src:url(x)}}</style>{R}/>{SEEN}", SEEN),
        (f'{SEEN}<line x1="1" y1="1" x2="9" y2="9"/>', SEEN),
        (f'<inkscape:x xmlns:inkscape="u">{R}/></inkscape:x>{SEEN}', SEEN),
        (
            f'<linearGradient id="g"/><linearGradient id="h"><stop/></linearGradient>{R} fill="url(#g)"/>'
            f'<g fill="url(#h)">{SEEN}</g>',
            SEEN,
        ),
    ],
)
def test_one_drawing_in_two_writings(body: str, plain: str) -> None:
    """The standard gives both the same picture."""
    assert outlines(body) == outlines(plain)


@pytest.mark.parametrize(
    "hidden",
    [
        "fill:none",
        "fill:none;stroke:none",
        "fill:transparent",
        "fill:#11223300",
        "fill:rgb(0 0 0 / 0%)",
        "fill:none;stroke:red;stroke-width:0",
        "fill:none;stroke:red;stroke-opacity:0",
        "fill:none;stroke:red;stroke-dasharray:0 9",
        "fill-opacity:0",
        "fill:currentColor;color:transparent",
        "fill:url(#gone)",
        "opacity:0",
        "visibility:hidden",
        "visibility:collapse",
        "display:none",
    ],
)
def test_invisible_shapes_do_not_count(hidden: str) -> None:
    """However it is said: by attributes, style, the group, the root, a class, an id, or among descendants."""
    attributes = " ".join(
        f'{name}="{value}"' for name, _, value in (d.partition(":") for d in hidden.split(";"))
    )
    for body in (
        f"{R} {attributes}/>",
        f'{R} style="{hidden}"/>',
        f"<style>#r {{ {hidden} }}</style>{R}/>",
        f'<style>.a > [class~="b"], q {{ {hidden} }}</style><g class="a">{R} class="b c"/></g>',
        f"<g {attributes}>{R}/></g>",
        f'<defs>{R}/></defs><use href="#r" style="{hidden}"/>',
    ):
        drawing = read_svg(svg(body + SEEN), unit=None)
        assert [chain.entity for chain in drawing.chains] == [
            "rect number " + str(2 - ("id=" not in body)) + " (without id)"
        ]
        assert drawing.remarks[0].startswith("Left out 1 hidden element (switched off, transparent, empty")
    with pytest.raises(InputError, match="no shape of the drawing is seen"):
        read_svg(svg(f"{R}/>", f'{MM} style="{hidden}"'), unit=None)


def test_strokes_count_however_thin() -> None:
    """Hairlines without fill, as for a laser; an open path stays open, one without stroke is closed as its fill."""
    body = '<path d="M0 0h9v9" fill="none" stroke="red" stroke-width="0.001"/>'
    assert [len(chain.bulges) for chain in read_svg(svg(body), unit=None).chains] == [2]
    assert [len(chain.bulges) for chain in read_svg(svg('<path d="M0 0h9v9"/>'), unit=None).chains] == [3]


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (f'<g id="g" mask="url(#m)">{R}/></g>', r"g 'g' has the mask 'url\(#m\)', which is not read"),
        (f'{R} style="filter:blur(3px)"/>', r"rect 'r' has the filter 'blur\(3px\)'"),
        (f'{R} style="offset-path:none;animation: spin 1s"/>', "rect 'r' has the animation 'spin 1s'"),
        (f"{R}><animate id='a' attributeName='x' to='9'/></rect>", "animate 'a' moves the drawing"),
        (
            f"{CLIP}<g id='g' clip-path='url(#c)'>{R} transform='translate(30)'/></g>",
            "rect 'r' is cut by the clip-path of g 'g'",
        ),
        (
            f'<clipPath id="c"><circle r="9"/></clipPath>{R} clip-path="url(#c)"/>',
            r"rect 'r' has the clip-path 'url\(#c\)'",
        ),
        (f'<g visibility="hidden">{CLIP}</g>{R} clip-path="url(#c)"/>', "rect 'r' has the clip-path"),
        (f'{R} style="clip-path:inset(5px)"/>', r"rect 'r' has the clip-path 'inset\(5px\)'"),
        (f'<svg id="s" width="30" height="30">{R}/></svg>', "rect 'r' is cut by the edge of svg 's'"),
        (
            f'{CLIP}<svg id="s" clip-path="url(#c)">{R}/></svg>',
            "svg 's' has a clip-path, which programs place differently",
        ),
        (
            f'<svg id="s" transform="scale(2)">{R}/></svg>',
            "svg 's' has a transform, which programs draw differently",
        ),
        (
            '<symbol id="s" viewBox="0 0 9 9" width="9"/><use id="u" href="#s"/>',
            "symbol 's' of use 'u' has a place or size",
        ),
        (
            f'{R} style="transform:translate(5, 5)"/>',
            r"rect 'r' has the transform 'translate\(5, 5\)', .* px",
        ),
        (f'{R} style="transform:rotateX(5deg)"/>', "rect 'r' has the transform 'rotateX"),
        (
            f'{R} transform="scale(2)" style="transform-box:fill-box"/>',
            "rect 'r' has the transform-box 'fill-box'",
        ),
        (
            f'{R} transform="scale(2)" style="transform-origin:1em 2em"/>',
            "rect 'r' has the transform-origin '1em 2em'",
        ),
        (
            f'{R} transform="scale(2)" style="transform-origin:5px% 2px"/>',
            "rect 'r' has the transform-origin '5px% 2px'",
        ),
        (
            f'{R} style="width:5"/>',
            "rect 'r' has width=\"5\", which is not a plain length: write a number with px",
        ),
        (f'{R} style="width:calc(5px + 1%)"/>', r"rect 'r' has width=\"calc\(5px \+ 1%\)\""),
        (f'{R} style="fill:var(--a)"/>', r"rect 'r' has fill: var\(--a\), which is not read"),
        (f'{R} style="display:contents"/>', "rect 'r' has display: contents"),
        (f'\n<style>\n@import "x.css";</style>{R}/>', "the style sheet on line 2 has @import"),
        (
            f"<style>@media print{{rect{{fill:none}}}}</style>{R}/>",
            "@media of the style sheet on line 1 is for 'print' only",
        ),
        (f"<style>@supports (x:y){{rect{{fill:none}}}}</style>{R}/>", "line 1 has @supports"),
        (f"<style>rect:nonsense{{fill:none}}</style>{R}/>", "line 1 has the selector 'rect:nonsense'"),
        (
            f"<style>g{{fill:red; rect{{fill:none}}}}</style>{R}/>",
            "g in the style sheet on line 1 has a rule within a rule",
        ),
        (f'{R} systemLanguage="de"/>', "rect 'r' is shown in some languages only"),
        (f'<switch><foreignObject id="f"/>{R}/></switch>', "foreignObject 'f' is the choice of a switch"),
        (f'<a><a id="a">{R}/></a></a>', "a 'a' is a link within a link"),
        ('<path id="p" d="M0 0 L5 5 6"/>', "path 'p' has path data that cannot be read"),
        ('<path id="p" d="M0 0 A5 5 0 2 1 5 6"/>', "path 'p' has path data that cannot be read"),
        ('<path id="p" d="M0 0 L5 5,L6 6"/>', "path 'p' has path data that cannot be read"),
        ('<polygon id="p" points="1,,2 3,4 5,6"/>', "polygon 'p': points '1,,2 3,4 5,6' is not a list"),
    ],
)
def test_what_is_not_read_is_refused_by_name(body: str, words: str) -> None:
    """One sentence with the element or the line, and what to do."""
    with pytest.raises(InputError, match=words) as caught:
        read_svg(svg(body), unit=None)
    assert "\n" not in str(caught.value)
    assert ": " in str(caught.value)


def test_the_root_is_an_element_too() -> None:
    """Its style counts, its CSS size is the file's, and its transform is refused."""
    assert outlines(SEEN, 'viewBox="0 0 10 10" width="1" style="width:10mm;height:10mm"') == outlines(
        SEEN, 'viewBox="0 0 10 10" width="10mm" height="10mm"'
    )
    assert outlines(f'{R}/>{SEEN[:5]} fill="red"{SEEN[5:]}', f'{MM} fill="none"') == outlines(SEEN)
    for root in ('transform="scale(2)"', 'style="rotate:5deg"'):
        with pytest.raises(InputError, match="the root <svg> has a transform"):
            read_svg(svg(SEEN, f"{MM} {root}"), unit=None)


def test_markers_and_texts_are_reported() -> None:
    """They draw no outline."""
    body = '<g marker-end="url(#m)"><path d="M0 0h9v9z"/></g><text display="none">a</text><text>b</text><script/>'
    remarks = read_svg(svg(body), unit=None).remarks
    assert "Ignored elements that are not an outline: 1 marker, 1 script, 1 text." in remarks


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"\x1f\x8b\x08", "compressed"),
        (
            b'<?xml-stylesheet href="a.css"?><svg xmlns="http://www.w3.org/2000/svg"/>',
            "styles from another file",
        ),
        (b'<svg xmlns="http://www.w3.org/2001/svg"/>', "not an SVG drawing"),
        (
            b'<!DOCTYPE svg SYSTEM "svg.dtd"><svg xmlns="http://www.w3.org/2000/svg"><rect width="&w;"/></svg>',
            "entity &w;",
        ),
    ],
)
def test_files_that_need_other_files(content: bytes, words: str) -> None:
    """What is outside the file is never guessed."""
    with pytest.raises(InputError, match=words):
        read_svg(content, unit="mm")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_encodings(encoding: str) -> None:
    """A byte order mark or a declared encoding is honoured, also in names."""
    name = "utf-8" if encoding == "utf-8-sig" else encoding
    text = f'<?xml version="1.0" encoding="{name}"?>'
    text += '<svg xmlns="http://www.w3.org/2000/svg"><rect id="Größe" width="-x"/></svg>'
    with pytest.raises(InputError, match="rect 'Größe' has width"):
        read_svg(text.encode(encoding), unit="mm")
