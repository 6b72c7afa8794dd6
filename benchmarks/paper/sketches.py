"""Figures of the paper drawn anew from our own results, with our own parts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import workhold
from paper.document import Block, Figures, Heading, Inline, Marked, Paragraph, Picture, Table
from workhold.contact.features import list_contact_features
from workhold.drawing.bench import draw_bench, make_bench, make_outline_path
from workhold.drawing.scene import BLACK, GREY, Box, Scene, View

NAME, TITLE = "sketches", "Our models, and the paper's figures drawn anew"
SECONDS, QUICK_SECONDS = 8.0, 3.0

CARD, EDGE = (400.0, 340.0), 12.0
# What the paper's figure shows, the workpiece, the vise's pitch and columns, and the type and place of the fixture.
FIXTURES = (
    ("15 a", "Type I, thin4Handle", "thin4Handle", 10, 1, "I", 0),
    ("15 b", "Type I, thin4Handle", "thin4Handle", 10, 1, "I", 12),
    ("16 a", "Type II, thin4Handle", "thin4Handle", 10, 1, "II", 0),
    ("16 b", "Type I, 8Handle", "8Handle", 10, 1, "I", 0),
    ("17 a", "Type I, widget", "widget", 10, 1, "I", 0),
    ("17 b", "Type II, widget", "widget", 10, 1, "II", 0),
    ("18 a", "Type I, flange", "flange", 10, 1, "I", 0),
    ("18 b", "Type II, flange", "flange", 10, 2, "II", 0),
)
# Workpieces of Table 1 of which no figure shows a fixture.
MORE = (("", "", "small4Handle"), ("", "", "large4Handle"), ("", "", "oblongPart"))
# Of the figure with several peg configurations on the same faces.
SAME_FACES = ("widget", 8, 2)


def measure(data: dict[str, Any], quick: bool) -> Iterator[tuple[float, str]]:
    """Draw each figure."""
    data["parts"] = [part_of(name) for name in dict.fromkeys(one[2] for one in (*FIXTURES, *MORE))]
    data |= {"examples": [], "grown": [], "same_faces": [], "columns_of_flange": 2}
    chosen = FIXTURES[4:6] if quick else FIXTURES
    for number, (figure, words, part, pitch, columns, kind, place) in enumerate(chosen):
        yield 0.7 * number / len(chosen), words
        result = searched(part, pitch, columns)
        ours = [fixture for fixture in result if fixture.type == kind]
        if len(ours) > place:
            svg = card(result, ours[place], words)
            data["examples"].append({"figure": figure, "words": words, "svg": svg, "found": len(ours)})
    yield 0.7, "grown features"
    data["grown"].append({"svg": grown_features("widget", 3.0)})
    yield 0.8, "several peg configurations"
    result = searched(*SAME_FACES)
    by_faces: dict[tuple[int, ...], list[Any]] = {}
    for fixture in result:
        key = (*sorted(p.face for p in fixture.pegs[:2]), -1, *sorted(p.face for p in fixture.pegs[2:]))
        by_faces.setdefault((len(fixture.type), *key), []).append(fixture)
    many = max((them for key, them in by_faces.items() if key[0] == 1), key=len)
    data["most_on_same_faces"] = len(many)
    for fixture in (many[0], many[len(many) // 2], many[-1]):
        data["same_faces"].append({"svg": card(result, fixture, "the same faces")})


def part_of(name: str) -> dict[str, Any]:
    """Sizes of a model, all of them ours."""
    part = workhold.load(name)
    x0, y0, x1, y1 = part.bounds
    faces = list(part.faces)
    arcs = sum(type(face.segment).__name__ == "Arc" for face in faces)
    return {
        "name": name,
        "width": x1 - x0,
        "height": y1 - y0,
        "lines": len(faces) - arcs,
        "arcs": arcs,
        "perimeter": sum(segment.length for loop in part.loop_segments for segment in loop),
    }


def searched(part: str, pitch: float, columns: int) -> Any:
    """All fixtures of a workpiece."""
    return workhold.design(
        workhold.load(part), workhold.Vise(pitch=pitch, columns=columns, peg_radius=3), threads=1
    )


def card(result: Any, fixture: Any, words: str) -> str:
    """A small picture of a fixture: no lettering, forces as arrows."""
    scene = Scene.make_page(CARD, words)
    bench = make_bench(fixture, result.workpiece, result.toolkit)
    room = Box(EDGE, EDGE, CARD[0] - EDGE, CARD[1] - EDGE)
    draw_bench(scene, bench, View.fit_box(bench.extent, room), weight=0.6, longest=36.0, axes=False)
    return scene.to_svg()


def grown_features(name: str, peg_radius: float) -> str:
    """A workpiece with its features grown by the radius of a peg, and a peg on each."""
    part = workhold.load(name)
    scene = Scene.make_page(CARD, "features grown by the radius of the pegs")
    bounds = Box(*part.bounds).grow(2 * peg_radius)
    view = View.fit_box(bounds, Box(EDGE, EDGE, CARD[0] - EDGE, CARD[1] - EDGE))
    scene.add_path(make_outline_path(part.loop_segments, view), BLACK, 1.6, "#fff7d1", fill_rule="evenodd")
    for feature in list_contact_features(part, peg_radius):
        scene.add_path(make_outline_path([[feature.segment]], view).rstrip("Z"), "#b3122a", 1.6)
        middle = view(feature.segment.compute_point(0.0))
        scene.add_circle(middle, peg_radius * view.scale, "none", GREY, 0.8)
        scene.add_circle(middle, 1.8, "#b3122a")
    return scene.to_svg()


def models(figures: Figures) -> list[tuple[Inline, ...]]:
    """The rows of the table of models."""
    return [
        (
            Marked("label", figures.value(f"parts/{k}/name")),
            figures.fixed(f"parts/{k}/width", 1),
            figures.fixed(f"parts/{k}/height", 1),
            figures.count(f"parts/{k}/lines"),
            figures.count(f"parts/{k}/arcs"),
            figures.fixed(f"parts/{k}/perimeter", 1),
        )
        for k in figures.every("parts")
    ]


def render(figures: Figures) -> list[Block]:
    """The pictures."""
    examples = tuple(
        (
            figures.value(f"examples/{k}/svg"),
            f"{figures.value(f'examples/{k}/figure')}: {figures.value(f'examples/{k}/words')}",
        )
        for k in figures.every("examples")
    )
    grown = tuple((one["svg"], "grown features, 3") for one in figures.value("grown") or [])
    same = tuple(
        (one["svg"], f"5 {letter}")
        for one, letter in zip(figures.value("same_faces") or [], "abc", strict=False)
    )
    blocks: list[Block] = [
        Heading(TITLE),
        Paragraph(
            "None of these pictures is the paper's. Each is drawn from a result of this run on our "
            "models; below it stands the number "
            "of the figure that it answers to. Red are pegs, orange the faces they touch; arrows are "
            "forces per unit of the force "
            "that closes the vise."
        ),
        Table(
            "Table 5",
            "Our models of the paper's workpieces. None of these numbers was ever printed; they are "
            "ours alone.",
            ("workpiece", "width (mm)", "height (mm)", "lines", "arcs", "perimeter (mm)"),
            models(figures),
        ),
    ]
    if grown or same:
        blocks.append(
            Picture(
                "Figure 2",
                (
                    "Pegs become points where features are grown by the radius of the pegs and trimmed to "
                    "where no other face is nearer. ",
                    "Several peg configurations on the same four faces of the widget, of ",
                    figures.count("most_on_same_faces"),
                    " that there are.",
                ),
                (*grown, *same),
                across=4,
            )
        )
    if examples:
        blocks.append(
            Picture(
                "Figure 3",
                (
                    "Fixtures as in the paper's examples. The flange has a Type II fixture with ",
                    figures.count("columns_of_flange"),
                    " columns, our model of it none with one (",
                    Marked("label", "Table 1"),
                    ").",
                ),
                examples,
                across=4,
            )
        )
    return blocks
