"""Every word and number that a machinist sets a fixture by is that of the fixture, in every kind of toolkit and direction.

What is read is what a reader sees: the words of the picture, of the printed sheet and of the terminal, the names and lengths
in a drawing for a CAM system and in the list of pins, and what the page is sent.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from datetime import date
from functools import cache
from io import StringIO
from math import atan, cos, hypot, pi, radians, sin, tan

import ezdxf
import pypdfium2
import pytest
from held_any_way import AHEAD, HELD, PITCH, WALL_OFFSET, WORDS, Held, load_cases_of, tips_of
from sheet_reading import collisions
from svg_reading import NAMESPACE, by_class, matrix, texts

from workhold import Peg
from workhold.cli.show_command import tabulate_load_cases
from workhold.cli.table import print_tables
from workhold.cli.tables import tabulate_fixture_setup, tabulate_quality
from workhold.drawing import SheetDetails, draw_fixture, draw_sheet, draw_thumbnails
from workhold.drawing.pdf import convert_svg_to_pdf
from workhold.drawing.scene import Box
from workhold.files.dxf.writer import make_setup_dxf
from workhold.files.result.fixture_text import write_pin_list
from workhold.units import MILLIMETRE
from workhold.web.answers import describe_fixture

DAY = date(2026, 1, 2)
FORCE = 1750.0
EVERY = pytest.mark.parametrize("held", HELD, ids=[held.made for held in HELD])
# Sentences of the sheet that tell of a way for another reason.
OTHER_WAYS = "x runs to the right, y upward."


def mm(length: float) -> str:
    """A length as pictures and sheets write it."""
    return f"{length:.3f}".replace("-", "−")


def turn_of(held: Held) -> float:
    """How far the part is turned in degrees, as it is told: less than an eighth of a turn clockwise is negative."""
    return (held.fixture.pose.theta_deg + 45.0) % 360.0 - 45.0


def place_of(tip: Peg, held: Held) -> str:
    """The hole of a clamp, or its line."""
    letter = chr(ord("A") + tip.column)
    if "line" not in held.made:
        return f"{letter}{tip.row + 1}"
    return f"row {tip.row + 1}" if tip.carrier.endswith("x") else f"column {letter}"


def setting_of(tip: Peg, held: Held) -> tuple[str, float]:
    """The sign and the size of what is set on a clamp."""
    dx, dy = AHEAD[tip.carrier.removeprefix("clamp ")]
    if "line" in held.made:
        return ("x", tip.x) if dx else ("y", tip.y)
    first = WALL_OFFSET if held.fixture.type.startswith("edge") else 0.0
    return "stroke", dx * (tip.x - tip.column * PITCH[0]) + dy * (tip.y - tip.row * PITCH[1] - first)


def settings(held: Held) -> list[tuple[str, float]]:
    """Signs and lengths to set, in order."""
    tips = tips_of(held.fixture)
    return [setting_of(tip, held) for tip in tips] or [("S", held.fixture.travel)]


def count_ways(words: str) -> set[str]:
    """All ways that are told of in some words."""
    return set(re.findall("|".join(WORDS.values()), words.replace(OTHER_WAYS, "")))


def expected_ways(held: Held) -> set[str]:
    """The ways in which its clamps push."""
    return {WORDS[direction] for direction in held.directions}


def has_run(words: Sequence[str], run: Iterable[str]) -> bool:
    """Whether some words stand one after the other among others."""
    wanted = list(run)
    return any(list(words[k : k + len(wanted)]) == wanted for k in range(len(words)))


@cache
def picture(held_number: int) -> str:
    """The picture of one of the fixtures."""
    held = HELD[held_number]
    return draw_fixture(held.fixture, held.workpiece, held.toolkit, title="Fixture 3 of 70")


@cache
def sheet(held_number: int) -> str:
    """Everything printed on the sheet of one of the fixtures, read back from the PDF."""
    held = HELD[held_number]
    loads = load_cases_of(held)
    details = SheetDetails(3, 70, DAY, "0" * 64, "1.2.3", jaw_force=FORCE, friction=0.2, loads=loads)
    document = pypdfium2.PdfDocument(
        convert_svg_to_pdf(draw_sheet(held.fixture, held.workpiece, held.toolkit, details), DAY)
    )
    return " ".join(" ".join(page.get_textpage().get_text_bounded() for page in document).split())


def peg_names(held: Held) -> list[str]:
    """What the pegs are called in tables: a clamp that is alone by its noun."""
    alone = len(tips_of(held.fixture)) == 1
    return ["clamp" if alone and peg.carrier.startswith("clamp") else peg.hole for peg in held.fixture.pegs]


def touched(peg: Peg) -> str:
    """The face touched, or both of a corner."""
    return f"{peg.face}" if peg.beside is None else f"{peg.face}/{peg.beside}"


@pytest.mark.thorough
@pytest.mark.sampled(2)
@EVERY
def test_a_picture_tells_the_fixture(held: Held) -> None:
    """Title, settings, pose, margin and every row of the table; no way is named but those in which its clamps push."""
    fixture, words = held.fixture, texts(picture(HELD.index(held)))
    assert collisions(picture(HELD.index(held))) == []
    assert count_ways(" ".join(words)) == expected_ways(held)
    rows = [
        [
            name.removeprefix("clamp ") if "line" in held.made else name,
            touched(peg),
            mm(peg.x),
            mm(peg.y),
            f"{peg.force:.3f}",
        ]
        for name, peg in zip(peg_names(held), fixture.pegs, strict=True)
    ]
    assert has_run(words, ["force", *(cell for row in rows for cell in row)])
    pose = fixture.pose
    assert has_run(words, ["Part turned by θ", f"{turn_of(held):.3f}°".replace("-", "−")])
    assert has_run(words, ["Part origin x, y", f"{mm(pose.x)}, {mm(pose.y)} mm"])
    assert has_run(words, ["Closure margin", f"{fixture.quality['closure_margin']:.4f}"])
    tips = tips_of(fixture)
    label = "Clamp along" if "line" in held.made else "Clamp bolted in"
    for tip, (sign, length) in zip(tips or [None], settings(held), strict=True):
        assert f"{sign} = {mm(length)} mm" in words
        if tip is None:
            assert has_run(words, ["Opening S of the jaws", f"{mm(length)} mm"])
            continue
        way = f", pushes {WORDS[tip.carrier.removeprefix('clamp ')]}" if len(tips) > 1 else ""
        assert has_run(words, [f"{mm(length)} mm", label, f"{place_of(tip, held)}{way}"])
    if len(tips) == 1:
        assert has_run(words, ["Clamp pushes", WORDS[str(fixture.direction)]])
    if len(tips) == 2:
        assert has_run(words, ["Clamp freedom", f"{fixture.quality['clamp_freedom']:.1f}°"])


@pytest.mark.thorough
@EVERY
def test_arrows_and_names_stand_at_what_they_tell_of(held: Held) -> None:
    """Each clamp's block arrow points its way, and the name of each hole stands at, or leads to, its peg or bolt."""
    svg = picture(HELD.index(held))
    arrows = []
    for group in by_class(svg, "clamp-push"):
        # The arrow is the polygon of seven corners, its tip first and the ends of its shaft amid the others.
        shapes = [shape for shape in group if shape.tag in (f"{NAMESPACE}polygon", f"{NAMESPACE}path")]
        corners = [numbers(shape.attrib.get("points") or shape.attrib.get("d", "")) for shape in shapes]
        (arrow,) = [points for points in corners if len(points) == 7]
        (tip_x, tip_y), (x, y) = arrow[0], ((arrow[3][k] + arrow[4][k]) / 2 for k in (0, 1))
        length = hypot(tip_x - x, tip_y - y)
        arrows.append((round((tip_x - x) / length), round((y - tip_y) / length)))
    assert arrows == [AHEAD[direction] for direction in held.directions]
    (pegs,), (labels,) = by_class(svg, "pegs"), by_class(svg, "labels")
    lines = [numbers(line.attrib["d"]) for line in labels if line.tag == f"{NAMESPACE}path"]
    frames = [frame_of(frame) for frame in labels if frame.tag == f"{NAMESPACE}rect"]
    scale = matrix(pegs)[0]
    for peg in held.fixture.pegs:
        if peg.carrier == "wall":
            continue
        at, reach = to_page(pegs, peg.x, peg.y), 4.0 * scale + 4.0
        if peg.carrier.startswith("clamp") and "line" not in held.made:
            first = WALL_OFFSET if held.fixture.type.startswith("edge") else 0.0
            at = to_page(pegs, peg.column * PITCH[0], peg.row * PITCH[1] + first)
        (text,) = (text for text in labels if text.text == peg.hole)
        place = Box(*(float(text.attrib[key]) for key in "xyxy"))
        (frame,) = (frame for frame in frames if frame.contains(place))
        leaders = [line[0] for line in lines if frame.grow(0.5).contains(Box(*line[-1], *line[-1]))]
        start = (
            leaders[0]
            if leaders
            else (min(max(at[0], frame.x0), frame.x1), min(max(at[1], frame.y0), frame.y1))
        )
        assert hypot(start[0] - at[0], start[1] - at[1]) <= reach


def frame_of(element: ET.Element) -> Box:
    """The box of a rectangle."""
    x, y, width, height = (float(element.attrib[key]) for key in ("x", "y", "width", "height"))
    return Box(x, y, x + width, y + height)


def to_page(group: ET.Element, x: float, y: float) -> tuple[float, float]:
    """A point in mm on the page."""
    a, _, _, d, e, f = matrix(group)
    return a * x + e, d * y + f


def numbers(path: str) -> list[tuple[float, float]]:
    """The points of a path of straight lines."""
    found = [float(word) for word in re.findall(r"-?\d+(?:\.\d+)?", path)]
    return list(zip(found[::2], found[1::2], strict=True))


@pytest.mark.thorough
@pytest.mark.sampled(2)
@EVERY
def test_a_sheet_tells_what_stands_where(held: Held) -> None:
    """Every peg with its hole, face, place and forces; what is set, how it is measured, and which way clamps push."""
    fixture, words = held.fixture, sheet(HELD.index(held))
    assert count_ways(words) == expected_ways(held)
    tips = tips_of(fixture)
    rows = []
    for name, peg in zip(peg_names(held), fixture.pegs, strict=True):
        jaw = [] if tips else [peg.carrier]
        forces = [f"{1000 * peg.force:.0f}", f"{FORCE * peg.force:.0f} N"]
        rows.append(" ".join([name, *jaw, touched(peg), mm(peg.x), mm(peg.y), *forces]))
    assert f"N per kN at 1750 N {' '.join(rows)} x, y:" in words
    for tip, (sign, length), share in zip(tips or [None], settings(held), shares(held), strict=True):
        assert f"{sign} = {mm(length)} mm" in words
        if tip is None:
            assert f"Opening S of the jaws {mm(length)} mm" in words
            continue
        place, direction = place_of(tip, held), tip.carrier.removeprefix("clamp ")
        label, step = (
            ("along", "Set {} so that its tip is on") if "line" in held.made else ("bolted in", "Bolt {} in")
        )
        told = re.search(
            rf"Clamp {label} {place} {re.escape(mm(length))} mm (.*?) round tip Ø 8 mm (.*?) torque", words
        )
        assert told and told[1].endswith(f"pushes {WORDS[direction]}, {direction.replace('-', '−')}")
        assert (
            f"clamp force {share * FORCE:.0f} N the loads need at least {above(share * 930.5)} N" in told[2]
        )
        one = "a clamp" if len(tips) > 1 else "the clamp"
        assert f"{step.format(one)} {place}, pushing {WORDS[direction]}, and draw it back." in words
        up = re.search(
            rf"until its tip touches face {tip.face}\. (.*?) is then {re.escape(mm(length))} mm", words
        )
        assert up and (up[1] == "Its stroke" or f", {sign} from " in up[1])
    touching = [
        f"face {peg.face}" if peg.beside is None else f"the corner of faces {peg.face} and {peg.beside}"
        for peg in fixture.pegs
    ]
    each = [f"{what} at {peg.hole}" for what, peg in zip(touching, fixture.pegs, strict=True)]
    assert f"touch: {', '.join(each[:-1])} and {each[-1]}." in words


def shares(held: Held) -> list[float]:
    """The part of the clamp force that each clamp has, in the middle of the ratios that hold, as an angle."""
    pair = held.fixture.pair
    if pair is None:
        return [1.0]
    low, high = (atan(end) for end in pair.ratio)
    ratio = tan((low + min(high, pi / 2)) / 2)
    return [1 / (1 + ratio), ratio / (1 + ratio)]


def above(force: float) -> str:
    """The least whole number of newtons that is no less than a force."""
    return f"{-(-force // 1):.0f}"


@pytest.mark.thorough
@pytest.mark.thinned(8)
@EVERY
def test_a_sheet_tells_pose_calipers_and_figures(held: Held) -> None:
    """Part zero where the pose carries it, what calipers read over two pegs at their places, and the figures of quality."""
    fixture, words, pose = held.fixture, sheet(HELD.index(held)), held.fixture.pose
    drawn = re.search(r"In the part's drawing the zero is at x (\S+) mm, y (\S+) mm", words)
    assert drawn is not None
    u, v = (float(number.replace("−", "-")) for number in drawn.groups())
    turn = radians(pose.theta_deg)
    x, y = pose.x + u * cos(turn) - v * sin(turn), pose.y + u * sin(turn) + v * cos(turn)
    assert re.search(rf"x from \D+A1? {re.escape(mm(x))} mm y from .{{4,12}} {re.escape(mm(y))} mm", words)
    told, way = turn_of(held), "clockwise" if turn_of(held) < 0 else "counter-clockwise"
    assert f"counter-clockwise {told:.4f}°".replace("e -", "e −") in words
    assert f"G68 X0 Y0 R{told:.3f}" in words
    assert f"as drawn, turned {abs(told):.1f}° {way} from its drawing" in words
    quality = fixture.quality
    for name in ("closure margin", "clamp amplification", "wrench radius"):
        assert f"{name} {quality[name.replace(' ', '_')]:.4f}" in words
    for name in ("location error", "edge distance"):
        assert f"{name} {mm(quality[name.replace(' ', '_')])} mm" in words
    assert f"load reaction (largest peg force) {quality['load_reaction']:.3g} N" in words
    calipers = re.search(
        r"Calipers on pegs in L-(\w)(\d+) and R-(\w)(\d+)(.*?): inside, between the pegs (\S+) mm outside, over both pegs "
        r"(\S+) mm",
        words,
    )
    assert (calipers is None) == bool(tips_of(fixture))
    if calipers is not None:
        left, right = ((ord(calipers[k]) - ord("A"), int(calipers[k + 1]) - 1) for k in (1, 3))
        columns = 1 if held.made.startswith("gripper") else 3
        start = PITCH[0] * left[0], PITCH[1] * left[1]
        end = PITCH[0] * (columns - 1 + right[0]) + fixture.travel, PITCH[1] * right[1] + 4.0
        apart = hypot(end[0] - start[0], end[1] - start[1])
        assert (calipers[6], calipers[7]) == (mm(apart - 6.0), mm(apart + 6.0))


@pytest.mark.thorough
@EVERY
def test_a_sheet_tells_loads_in_their_order(held: Held) -> None:
    """The hardest load first; of each what it needs, and the force of every peg below the name of that peg."""
    words, cases = sheet(HELD.index(held)), load_cases_of(held)
    tips = tips_of(held.fixture)
    names = [name.removeprefix("clamp ") if len(tips) > 1 else name for name in peg_names(held)]
    rows, sentences = [], []
    for number in (2, 3, 1):
        case = cases[number - 1]
        forces = [above(force) for force in case.largest]
        rows.append(" ".join([f"cut {number}", above(case.needed.value), above(77.25 * number), *forces]))
        at = f"x {mm(4.5 * number)}, y {mm(1.5 * number)} mm, towards {10 * number}°"
        sentences.append(f"cut {number}: {40 + number} N at {at}.")
    head = f"Load {'needs' if tips else 'jaws'} µ 0.2 {' '.join(names)}"
    assert " ".join([head, *rows, *sentences]) in words
    assert f"{'clamp' if tips else 'jaw'} force of 1750 N" in words


@pytest.mark.thinned(2)
@EVERY
def test_the_terminal_tells_the_fixture(
    held: Held, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What ``show`` prints: settings, ways, pose, and the tables of pegs, figures and loads."""
    monkeypatch.delenv("COLUMNS", raising=False)
    fixture, toolkit, noun = held.fixture, held.toolkit, "clamp" if tips_of(held.fixture) else "jaw"
    cases = load_cases_of(held)
    tables = (*tabulate_fixture_setup(fixture, toolkit, 3, 70), "", tabulate_quality(fixture, noun))
    print_tables(*tables, *tabulate_load_cases(cases, fixture, toolkit))
    said = capsys.readouterr().out
    lines = [re.split(r"\s{2,}", line.strip()) for line in said.splitlines()]
    assert count_ways(said) == expected_ways(held)
    title = fixture.type if fixture.direction is None else f"{fixture.type} {fixture.direction}"
    assert [f"Fixture 3 of 70, type {title}"] in lines
    pose = fixture.pose
    assert (
        f"turned by {turn_of(held):.3f} degrees, its origin lies at ({pose.x:.3f}, {pose.y:.3f}) mm" in said
    )
    for tip, (sign, length) in zip(tips_of(fixture) or [None], settings(held), strict=True):
        if tip is None:
            assert f"Opening S {length:.3f} mm" in said
            continue
        on = "on" if "line" in held.made else "bolted in"
        start = f"The clamp, {on} {place_of(tip, held)}, pushes {WORDS[tip.carrier.removeprefix('clamp ')]}; "
        assert any(line[0].startswith(start) and line[0].endswith(f"{length:.3f} mm") for line in lines)
        assert sign == "stroke" or f", {sign} from " in said
    stands_on = {"plate": "locator", "wall": "end"}
    for peg in fixture.pegs:
        kind = stands_on.get(peg.carrier, "clamp" if noun == "clamp" else peg.carrier)
        row = [
            peg.hole.removeprefix("clamp "),
            kind,
            f"{peg.x:.3f}",
            f"{peg.y:.3f}",
            touched(peg),
            f"{peg.force:.3f}",
        ]
        assert row in lines
    for key, value in fixture.quality.items():
        row = next(line for line in lines if line[0] == key.replace("_", " ").replace("jaw", noun))
        assert float(row[1]) == pytest.approx(value, abs=0.5000001 * 10.0 ** -len(row[1].partition(".")[2]))
    for number, case in enumerate(cases, 1):
        worst = case.needed
        row = [f"cut {number}", f"{worst.value:.1f}", fixture.pegs[worst.peg].hole]
        at = f"({3.5 * number:.3f}, {2.25 * number:.3f})"
        assert [*row, at, f"{11.5 * number:.1f}", f"{77.25 * number:.1f}"] in lines
        ranges = [f"{low:.1f} to {high:.1f}" for low, high in zip(case.smallest, case.largest, strict=True)]
        assert [f"cut {number}", *ranges, "yes"] in lines


@pytest.mark.thorough
@EVERY
def test_files_and_thumbnails_tell_the_fixture(held: Held) -> None:
    """The words in a drawing for a CAM system and below a thumbnail, and the list of pins."""
    fixture, told = held.fixture, settings(held)
    drawing = ezdxf.read(StringIO(make_setup_dxf(fixture, held.workpiece, held.toolkit).decode()))  # type: ignore[attr-defined]
    written = [entity for entity in drawing.modelspace() if entity.dxftype() == "TEXT"]
    assert [text.dxf.text for text in written if " = " in text.dxf.text] == [
        f"{s} = {n:.6g} mm" for s, n in told
    ]
    for peg in fixture.pegs:
        if peg.carrier != "wall":
            assert any(text.dxf.text == peg.hole for text in written)
    caption = texts(draw_thumbnails([fixture], held.workpiece, held.toolkit, ["3"]))
    title = f"Type {fixture.type}" if fixture.direction is None else f"{fixture.type} {fixture.direction}"
    assert title.replace("-", "−") in caption
    signs = " and ".join(dict.fromkeys(sign for sign, _ in told))
    assert f"{signs} = {', '.join(f'{mm(length)} mm' for _, length in told)}" in caption
    pins = write_pin_list(fixture, held.toolkit, MILLIMETRE, None, None).splitlines()[1:]
    standing = [peg for peg in fixture.pegs if not peg.carrier.startswith(("clamp", "wall"))]
    assert [line.split(",")[0] for line in pins] == [peg.hole for peg in standing]
    for line, peg in zip(pins, standing, strict=True):
        assert f"{peg.x:.3f}" in line and f"{peg.y:.3f}" in line


@EVERY
def test_the_page_is_sent_the_fixture(held: Held) -> None:
    """Holes, faces, places and forces in one order, the settings, and of each carrier which way it clamps."""
    fixture = held.fixture
    sent = describe_fixture(fixture, held.workpiece, held.toolkit)
    title = (
        f"Clamp{'s' * (len(held.directions) == 2)} {fixture.direction}"
        if held.directions
        else f"Type {fixture.type}"
    )
    assert sent["title"] == title.replace("-", "−")
    assert [(one["sign"], pytest.approx(one["length"])) for one in sent["settings"]] == settings(held)
    assert sent["holes"] == [peg.hole for peg in fixture.pegs] and sent["faces"] == [
        peg.face for peg in fixture.pegs
    ]
    assert sent["touched"] == [touched(peg) for peg in fixture.pegs]
    assert sent["pegs"] == [[peg.x, peg.y] for peg in fixture.pegs]
    assert sent["forces"] == [peg.force for peg in fixture.pegs]
    assert (sent["theta_deg"], sent["x"], sent["y"]) == (
        fixture.pose.theta_deg,
        fixture.pose.x,
        fixture.pose.y,
    )
    assert sent["mover"] == ("clamp" if held.directions else "jaw") and sent["quality"] == fixture.quality
    ways = (
        {"right": (-1, 0)}
        if held.made != "opening vise" and not held.made.startswith("opening")
        else {"right": (1, 0)}
    )
    ways |= {f"clamp {direction}": ahead for direction, ahead in AHEAD.items()}
    numbered = [(number, each) for each in sent["carriers"] for number in each["pegs"]]
    assert sorted(number for number, _ in numbered) == list(range(len(fixture.pegs)))
    for number, each in numbered:
        assert each["clamping"] == ways.get(fixture.pegs[number].carrier)
