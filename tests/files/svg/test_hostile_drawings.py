"""Drawings that ask for more time, memory or accuracy than there is: a list or a sentence, and nothing else."""

from __future__ import annotations

import importlib.util
import random
from pathlib import Path
from xml.etree.ElementTree import Element

import pytest
from attrs import evolve

from workhold.errors import InputError
from workhold.files.budget import LIMITS, Budget, OverBudgetError
from workhold.files.outline.chain import Drawing
from workhold.files.part.load import read_workpiece
from workhold.files.svg import document, shapes
from workhold.files.svg.document import tokenize_css
from workhold.files.svg.reader import read_svg
from workhold.files.svg.walk import ElementNesting, SvgWalk

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">'
RECT = '<rect width="5" height="5"/>'


def drawing(body: str, head: str = HEAD, budget: Budget | None = None) -> Drawing:
    """What is read of a drawing."""
    return read_svg(f"{head}{body}</svg>".encode(), unit=None, budget=budget)


def nested(count: int, inner: str) -> str:
    """Something in so many groups."""
    return "<g>" * count + inner + "</g>" * count


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("body", "words"),
    [
        (
            "<style>" + "rect{x:" + "1" * 5000 + "}</style>",
            "the style sheet on line 1 has a number that cannot",
        ),
        (
            "<style>rect{x:" + "(" * 10 + "a" + ")" * 10 + "}</style>",
            "a bracket of the style sheet on line 1 is nested more than 10 levels deep",
        ),
        ("<style>" + "@media all{" * 300 + "</style>", "is nested more than 10 levels deep"),
        ("<style>" + "rect{}" * 100_000 + "</style>", "more than the 500,000 letters"),
        (
            ("<style>" + "rect{}" * 45_000 + "</style>\n") * 2,
            "style sheet on line 2 has more than the 500,000 letters that the style sheets",
        ),
        ("<style>" + "rect," * 20_000 + "g{fill:red}</style>", "more than the 20,000 selectors"),
        ("<style>:not(g rect){fill:red}</style>", r"the selector ':not\(g rect\)', which is not read"),
        ("<style>[*|a]{fill:red}</style>", r"the selector '\[\*\|a\]', which is not read"),
        (
            f'<g style="{"fill:red;" * 60_000}"/>',
            "the style of g number 1 .* has more than the 500,000 letters",
        ),
        (f'<rect fill="{"a" * 10_001}"/>', "<rect> on line 1 has 10,001 letters in its fill"),
        (f'<rect style="fill:{"a" * 10_001}"/>', "has 10,001 letters in its fill"),
        (f'<g xmlns="{"u" * 501}"/>', "XML namespace 'u.* on line 1 is longer than 500"),
        (
            "<g " + " ".join(f"a{k}=''" for k in range(10_001)) + "/>",
            "the element on line 1 has more than 10,000",
        ),
        ("<rect fill='color()' width='1' height='1'/>", "rect number 1 .* fill: color"),
        ('<rect width="1e400%" height="1"/>', "rect number 1 .* width"),
        (
            nested(30, RECT).replace("<g>", '<g transform="scale(1e9)">'),
            "transform or size that is too large",
        ),
        (nested(30, RECT).replace("<g>", '<g transform="scale(1e-9)">'), "crushes"),
        (f'<g transform="scale(1e300)">{RECT}</g>', "g number 1 .*too large"),
        ('<path d="M0 0a1e40 1e40 0 0 1 1 1z"/>', "path number 1 .* radius that is too large"),
        ('<path d="M0 0h1e40v1z"/>', "path number 1 .* too large"),
        ('<path d="M0 0a1e-200 1e-300 0 0 1 1 1z"/>', "path number 1"),
        ('<polygon points="0 0 1e40 0 1 1"/>', "polygon number 1 .*too large"),
    ],
)
def test_absurd_values_are_refused_with_their_place(body: str, words: str) -> None:
    """One sentence, however the absurd is written."""
    with pytest.raises(InputError, match=words) as caught:
        drawing(body)
    assert "\n" not in str(caught.value)


def test_brackets_of_styles_are_as_deep_as_the_table_of_limits_lets_them_be(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """In style sheets and in attributes; one more is refused, and no reader goes on after it."""
    for deepest in (10, 3):
        monkeypatch.setitem(LIMITS, "style", evolve(LIMITS["style"], deepest=deepest))
        for head, outer in (("<style>rect{font:", 1), ('<rect width="1" height="1" style="font:', 0)):
            end = "}</style>" if outer else '"/>'
            most = deepest - outer
            drawing(RECT + head + "(" * most + "a" + ")" * most + end)
            with pytest.raises(OverBudgetError, match=f"a bracket of the .* more than {deepest} levels deep"):
                drawing(RECT + head + "(" * (most + 1) + "a" + ")" * (most + 1) + end)


@pytest.mark.parametrize(
    "declared",
    [
        '<!ATTLIST g z CDATA "x">',
        "".join(f'<!ATTLIST g xmlns:a{k} CDATA "x">' for k in range(21)),
        f'<!ATTLIST g xmlns:a CDATA "{"x" * 501}">',
        "".join(f"<!ATTLIST g a{k} CDATA #IMPLIED>" for k in range(1001)),
    ],
)
def test_attributes_for_all_elements_are_refused(declared: str) -> None:
    """Each element would get them: a file of n bytes would take the square of n."""
    with pytest.raises(InputError, match="declares attributes for all its elements"):
        drawing(RECT, f"<!DOCTYPE svg [{declared}]>{HEAD}")


def test_namespaces_and_attributes_without_a_value_may_be_declared() -> None:
    """As old programs do."""
    declared = '<!ATTLIST svg xmlns:a CDATA #FIXED "b" c CDATA #IMPLIED>'
    assert len(drawing(RECT, f"<!DOCTYPE svg [{declared}]>{HEAD}").chains) == 1


@pytest.mark.parametrize(
    "page",
    [
        'width="1e308mm" height="1e308mm" viewBox="0 0 1 1"',
        'width="1e20mm" height="1e20mm" viewBox="0 0 1e-300 1e-300"',
        'width="1mm" height="1mm" viewBox="0 0 1e-320 1e-320"',
    ],
)
def test_absurd_pages_are_refused(page: str) -> None:
    """Nothing overflows."""
    with pytest.raises(InputError):
        drawing(RECT, f'<svg xmlns="http://www.w3.org/2000/svg" {page}>')


@pytest.mark.parametrize(
    "body",
    [
        "<g/>" * 101,
        "<g " + " ".join(f'a{k}=""' for k in range(1001)) + "/>",
        '<path d="M0 0' + "h1v1" * 500 + '"/>',
        '<path id="p" d="M0 0' + "h1v1" * 30 + '"/>' + '<use href="#p"/>' * 9,
        '<polygon points="' + "1 2 " * 1000 + '"/>',
        '<clipPath id="c"><path d="M0 0h9v9h-9z"/></clipPath>'
        + RECT.replace("/", ' clip-path="url(#c)"/') * 40,
        "<style>" + "rect{fill:red}" * 101 + "</style>" + RECT,
    ],
    ids=["elements", "attributes", "path", "use", "points", "clip", "rules"],
)
def test_all_that_is_gone_through_counts(body: str) -> None:
    """Elements, their attributes, commands and points, repeated ones each time, and rules that are kept."""
    budget = Budget(evolve(LIMITS["svg"], most_elements=100))
    with pytest.raises(InputError, match="more than the 100 elements"):
        drawing(body, budget=budget)


@pytest.mark.parametrize(
    "body",
    [
        "<style>" + "rect[x]{fill:red}" * 300 + "</style>" + RECT * 300,
        f'<rect width="5" height="5" transform="{"rotate(1) " * 20_000}"/>',
        '<path d="' + "".join(f"M{k} 0h1v1z" for k in range(90)) + '"/>' * 30,
        f'<g style="{"fill:red;" * 2000}">{RECT * 30}</g>',
        '<style>g{fill:red}</style><g id="g">' + "<g/>" * 50 + "</g>" + '<use href="#g"/>' * 200,
    ],
    ids=["selectors", "transforms", "loops", "style", "use"],
)
def test_work_is_counted_so_that_time_can_be_up(body: str) -> None:
    """Without time, each of these is given up, not read to its end."""
    budget = Budget(evolve(LIMITS["svg"], seconds=0.0, seconds_per_million=0.0))
    with pytest.raises(InputError, match="reading it was given up"):
        drawing(body, budget=budget)


def test_uses_and_groups_together_are_as_deep_as_a_drawing_may_be() -> None:
    """Sixty uses, each in sixty groups, would be as deep as 3,600; eighty symbols in each other are not."""
    chain = f'<g id="g0">{RECT}</g>'
    for k in range(1, 60):
        chain += f'<g id="g{k}">' + nested(60, f'<use href="#g{k - 1}"/>') + "</g>"
    with pytest.raises(InputError, match="nested more than 200 levels"):
        drawing(f'<defs>{chain}</defs><use href="#g59"/>')
    chain = f'<symbol id="g0">{RECT}</symbol>'
    for k in range(1, 60):
        chain += f'<symbol id="g{k}"><use width="99" height="99" href="#g{k - 1}"/></symbol>'
    assert len(drawing(f'<defs>{chain}</defs><use width="99" height="99" href="#g59"/>').chains) == 1
    chain += "".join(f'<symbol id="g{k}"><use href="#g{k - 1}"/></symbol>' for k in range(60, 300))
    with pytest.raises(InputError, match="nested more than 200 levels"):
        drawing(f'<defs>{chain}</defs><use href="#g299"/>')


@pytest.mark.parametrize("way", ["g", "symbol", "a"])
def test_uses_that_double_are_foreseen(way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A million million rectangles in forty lines are refused before they are written out."""
    visited: list[str] = []
    visit = SvgWalk.visit

    def counted(self: SvgWalk, element: Element, nest: ElementNesting) -> None:
        visited.append(element.tag)
        visit(self, element, nest)

    monkeypatch.setattr(SvgWalk, "visit", counted)
    chain = f'<{way} id="g0"><rect width="9" height="9"/></{way}>'
    for k in range(1, 40):
        chain += f'<{way} id="g{k}"><use href="#g{k - 1}"/><use href="#g{k - 1}"/></{way}>'
    with pytest.raises(InputError, match=r"more than the 250,000 elements .* written out"):
        drawing(f'<defs>{chain}</defs><use href="#g39"/>')
    assert len(visited) < 10


@pytest.mark.parametrize(
    "off", ['display="none"', 'style="display:none"', 'systemLanguage="de"', 'opacity="0"']
)
def test_uses_that_are_switched_off_are_not_foreseen(off: str) -> None:
    """What is not shown counts once, however much there is of it."""
    chain = '<g id="g0"><rect width="9" height="9"/></g><rect id="r" width="60" height="40"/>'
    for k in range(1, 40):
        chain += f'<g id="g{k}"><use href="#g{k - 1}"/><use href="#g{k - 1}"/></g>'
    body = f'<g {off}><use href="#g39"/></g>'
    try:
        found = drawing(f'<defs>{chain}<g id="all">{body}<use href="#r"/></g></defs><use href="#all"/>')
    except InputError as error:
        assert "systemLanguage" in off and "in some languages only" in str(error)
    else:
        assert len(found.chains) == 1


def test_names_of_uses_stay_short() -> None:
    """A label tells where an element is used, not all of a long way there."""
    chain = f'<g id="g0">{RECT}</g>'
    for k in range(1, 60):
        chain += (
            f'<g id="{"x" * 60}{k}"><use id="{"u" * 60}{k}" href="#{"x" * 60 if k > 1 else "g"}{k - 1}"/></g>'
        )
    found = drawing(f'<defs>{chain}</defs><use href="#{"x" * 60}59"/>').chains
    assert max(len(label) for label in found[0].labels) < 500


def test_a_style_that_is_repeated_is_read_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A hundred elements with the same style, as programs write them."""
    read: list[str] = []

    def counted(text: str, place: str, budget: Budget) -> list[object]:
        read.append(place)
        return tokenize_css(text, place, budget)

    monkeypatch.setattr(document, "tokenize_css", counted)
    body = '<rect style="fill:none;stroke:#000000" width="5" height="5"/>' * 100
    assert len(drawing(body).chains) == 100
    assert read == ["the style of rect number 1 (without id)"]


@pytest.mark.thorough
def test_path_data_is_resolved_over_the_joints_of_its_batches(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shorthand curves, relative moves and closing are what they are in one batch, wherever a batch ends."""
    data = "M5 5" + "h1v1h-1z m2 0 q1 1 2 0 t2 0 c0 1 1 1 1 0 s1 1 1 0zh2v2zv-1" * 2
    body = f'<path stroke="red" fill="none" d="{data}"/>'
    whole = drawing(body).chains
    assert len(whole) == 7
    for batch in (1, 2, 3, 5):
        monkeypatch.setattr(shapes, "BATCH", batch)
        assert drawing(body).chains == whole


@pytest.mark.thorough
def test_random_faults_are_refused_in_a_sentence(tmp_path: Path) -> None:
    """Drawings with one thing replaced are read, or refused by name; no other exception comes out."""
    place = Path(__file__).parents[1] / "fuzzing" / "svg_files.py"
    spec = importlib.util.spec_from_file_location("svg_files", place)
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    path, read = tmp_path / "made.svg", 0
    for seed in range(120):
        path.write_bytes(made.make_svg(random.Random(seed)))
        try:
            read_workpiece(path)
        except InputError as error:
            assert "\n" not in str(error)
        else:
            read += 1
    assert read > 20
