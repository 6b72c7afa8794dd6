"""A solid on the page: how it stands, supports under it and a clamp on top, and its second side."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pytest
from step_shapes import box, cut, cylinder, filleted, fused, upright, write_step
from test_accessibility import AXE, CHECK
from walking import Walk

from glb_reading import read_glb

STATE = "async () => { const { state } = await import('/static/state.js'); return state; }"


@pytest.fixture(scope="module")
def block(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A base of 100 x 70 x 12 mm with a boss of 60 x 40 x 18 mm on it and a bore through both."""
    base = filleted(box(100, 70, 12), 8, upright)
    shape = cut(fused(base, box(60, 40, 18, (20, 15, 12))), cylinder(9, 40, (50, 35, -1)))
    return str(write_step(tmp_path_factory.mktemp("solids") / "block.step", shape))


@pytest.fixture(scope="module")
def several(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Two solids; the smaller one has a flange over a narrower foot, flush with it at two sides."""
    table = fused(box(50, 30, 10, (190, 0, 0)), box(50, 40, 6, (190, -5, 10)))
    path = tmp_path_factory.mktemp("solids") / "several.step"
    return str(write_step(path, box(80, 60, 20), table))


def stands(walk: Walk, file: str, height: str | None = None) -> None:
    """Open a file with solids, and say how far pegs reach."""
    walk.page.set_input_files("#file", file)
    walk.seen("#file-asks .standing")
    if height is not None:
        walk.page.fill("#stands-peg-height", height)
        walk.page.press("#stands-peg-height", "Tab")
        walk.seen(f"#standing-words:has-text('pegs of {height}')")


def held(walk: Walk, file: str, height: str = "8") -> None:
    """The best fixture of a solid on a plate with a clamp, with its supports."""
    stands(walk, file, height)
    walk.page.select_option("#preset", "clamp-plate-20mm")
    walk.search()
    walk.seen("#supports-sets tr")


def state(walk: Walk) -> dict[str, Any]:
    """What the page knows."""
    return dict(walk.page.evaluate(STATE))


def sets(walk: Walk, **more: Any) -> list[dict[str, Any]]:
    """What the server answers to the page's own request."""
    script = "async () => (await import('/static/supports.js')).supportsRequest()"
    asked = {**walk.page.evaluate(script), **more}
    rank = walk.shown()["rank"]
    answer = walk.server.client.post(f"/api/jobs/{walk.job()}/fixtures/{rank}/supports", json=asked)
    assert answer.status_code == 200, answer.text
    return list(answer.json()["sets"])


def drawn(walk: Walk) -> list[list[float]]:
    """Where pads are drawn over the plan."""
    script = "pads => pads.map(pad => [pad.cx.baseVal.value, pad.cy.baseVal.value])"
    return list(walk.page.eval_on_selector_all("#drawing-fixture .support-pad", script))


def test_it_is_said_how_it_stands(walk: Walk, several: str) -> None:
    """Which solid, which side up and how far pegs reach: the outline follows, and what cannot be touched is dashed."""
    page = walk.page
    stands(walk, several)
    assert page.locator("[data-solid]").all_inner_texts() == [
        "1: 80.0 × 60.0 × 20.0 mm",
        "2: 50.0 × 40.0 × 16.0 mm",
    ]
    page.click("[data-solid='2']")
    walk.until("state.part.bounds[2] - state.part.bounds[0] < 51")
    page.fill("#stands-peg-height", "6")
    page.press("#stands-peg-height", "Tab")
    walk.until("Math.abs(state.part.bounds[3] - state.part.bounds[1] - 30) < 1e-9")
    assert page.locator("#drawing-part .never").count() == 0
    page.click("[data-axis='-z']")
    walk.until(
        "state.part.solid.axis === '-z' && Math.abs(state.part.bounds[3] - state.part.bounds[1] - 40) < 1e-9"
    )
    assert page.get_attribute("[data-axis='-z']", "aria-pressed") == "true"
    page.click("[data-axis='z']")
    walk.until("state.part.solid.axis === 'z'")
    # Pegs that end less than the head room under the flange run into it, and touch nothing of it.
    page.fill("#stands-peg-height", "9.8")
    page.press("#stands-peg-height", "Tab")
    walk.until("state.part.solid.peg_height === 9.8")
    assert page.locator("#drawing-part .never").count() == page.locator("#faces .never-touched").count() > 1
    assert "dashed pieces" in page.inner_text("#standing-words")
    page.fill("#stands-head-room", "0.1")
    page.press("#stands-head-room", "Tab")
    walk.until("state.part.solid.head_room === 0.1")
    assert page.locator("#drawing-part .never").count() == 0


def test_solids_are_offered_by_their_names(walk: Walk, several: str, tmp_path: Path) -> None:
    """Beside their numbers; where the one chosen is refused, the others are still there to be chosen."""
    page, path = walk.page, tmp_path / "named.step"
    given = iter(("base plate", "flange"))
    text = Path(several).read_text(encoding="latin-1")
    path.write_text(
        re.sub(r"MANIFOLD_SOLID_BREP\(''", lambda _: f"MANIFOLD_SOLID_BREP('{next(given)}'", text)
    )
    stands(walk, str(path))
    names = ["1 base plate: 80.0 × 60.0 × 20.0 mm", "2 flange: 50.0 × 40.0 × 16.0 mm"]
    assert page.locator("[data-solid]").all_inner_texts() == names
    page.fill("#stands-peg-height", "18")
    page.press("#stands-peg-height", "Tab")
    walk.until("state.part.solid?.peg_height === 18")
    page.fill("#stands-least-band", "19")
    page.press("#stands-least-band", "Tab")
    walk.seen("#part-trouble:has-text('no upright face')")
    assert page.locator("[data-solid]").all_inner_texts() == names


def test_a_height_is_chosen_from_the_table(walk: Walk, several: str) -> None:
    """The table tells what may be touched at each height; a click takes one, and only the best is marked as such."""
    page = walk.page
    stands(walk, several)
    page.click("[data-solid='2']")
    walk.until("state.part.bounds[2] - state.part.bounds[0] < 51")
    page.evaluate("() => (document.querySelector('.heights').open = true)")
    touched = [float(words) for words in page.locator(".heights td:nth-child(3)").all_inner_texts()]
    best = [k for k, length in enumerate(touched) if length == max(touched)]
    assert page.locator(".heights td.better").count() == len(best) >= 1 and len(touched) >= 3
    page.click(".heights [data-height] >> nth=0")
    walk.until("state.part.solid.peg_height < 10")
    told = page.evaluate("async () => (await import('/static/state.js')).state.part.bounds")
    assert told[3] - told[1] == pytest.approx(30)
    assert page.get_attribute(".heights [data-height] >> nth=0", "aria-pressed") == "true"


def test_supports_are_drawn_told_and_chosen(walk: Walk, block: str) -> None:
    """The best sets with their holes; the chosen one is drawn where its pads stand, from the side, and in the link."""
    page = walk.page
    held(walk, block)
    answered = sets(walk)
    assert page.locator("#supports-sets td:nth-child(2)").all_inner_texts() == [
        " ".join(one["holes"]) for one in answered
    ]
    assert sorted(drawn(walk)) == [pytest.approx(pad) for pad in sorted(answered[0]["pads"])]
    page.click("#supports-sets button >> nth=1")
    walk.until("state.supports.chosen === 2")
    assert sorted(drawn(walk)) == [pytest.approx(pad) for pad in sorted(answered[1]["pads"])]
    assert page.inner_text("#supports-words").startswith(f"Supports in {', '.join(answered[1]['holes'])}")
    labels = page.locator("#drawing-fixture .hole-name").all_text_contents()
    assert set(answered[1]["holes"]) <= set(labels) and "clamp" in labels
    assert page.locator("#side-front .side-support").count() == 6
    assert page.locator("#side-front .side-band").count() == 3
    assert "30.0" in page.locator("#side-front .side-word").all_text_contents()
    page.click("#supports > summary")
    walk.until("state.supports.open === false")
    assert drawn(walk) == []
    page.click("#supports > summary")
    walk.reload()
    walk.seen("#supports-sets tr")
    assert sorted(drawn(walk)) == [pytest.approx(pad) for pad in sorted(answered[1]["pads"])]


def test_loads_and_keep_outs_of_supports(walk: Walk, block: str) -> None:
    """A tool that pulls asks for a clamp force; a circle on the part keeps pads off; wrong words are marked."""
    page = walk.page
    held(walk, block)
    before = sets(walk)
    page.fill("#support-axial", "-40..60")
    page.press("#support-axial", "Tab")
    walk.seen("#supports-heads th:has-text('Clamp force')")
    force = sets(walk)[0]["clamp_force"]
    assert force > 0 and f"press with {-int(-force // 1)} N" in page.inner_text("#supports-words")
    page.fill("#support-axial", "much")
    page.press("#support-axial", "Tab")
    assert page.get_attribute("#support-axial", "aria-invalid") == "true"
    page.fill("#support-axial", "")
    page.press("#support-axial", "Tab")
    walk.until("state.supports.axial === null")
    row = walk.shown()
    x, y = before[0]["pads"][0]
    center = page.evaluate(
        "async ([row, at]) => (await import('/static/pose.js')).intoPart(row)(at)", [row, [x, y]]
    )
    page.click("#support-below")
    start = walk.point(*center)
    walk.drag(start, walk.point(center[0] + 6, center[1]))
    walk.until("state.supports.below.length === 1 && state.view === 'fixture'")
    walk.seen("#supports-sets tr")
    walk.until("document.querySelectorAll('#drawing-fixture .support-pad').length === 3")
    for px, py in drawn(walk):
        assert abs(px - x) > 1 or abs(py - y) > 1
    page.click("#support-below-zones button")
    walk.until("state.supports.below.length === 0")


def test_of_a_drawing_the_thickness_is_asked(walk: Walk) -> None:
    """Nothing is shown before it is opened; then the thickness is asked for, and all else follows."""
    page = walk.page
    page.click("#example")
    walk.searched()
    assert drawn(walk) == [] and not page.is_visible("#support-thickness")
    page.click("#supports > summary")
    walk.seen("#supports-words:has-text('How thick')")
    page.fill("#support-thickness", "12")
    page.press("#support-thickness", "Tab")
    walk.seen("#supports-sets tr")
    assert len(drawn(walk)) == 3
    query = parse_qs(urlsplit(page.get_attribute("#take-sheet", "href")).query)
    assert json.loads(query["supports"][0])["thickness"] == 12


def test_the_second_side_keeps_off_what_the_first_cuts(walk: Walk, block: str) -> None:
    """Turned over, searched with the faces ruled out that were cut; both sides are gone to, drawn and written."""
    page = walk.page
    held(walk, block)
    first = state(walk)
    bore = next(
        face for face in first["part"]["faces"] if face["kind"] == "arc" and face["size"] == pytest.approx(9)
    )
    if bore["number"] in first["selected"]["faces"]:
        pytest.fail("the best fixture holds the bore: take another part")
    assert page.is_hidden("#sides") and page.is_hidden("#take-other")
    page.click(f"#turn-faces [data-face='{bore['number']}']")
    page.click("#second-side")
    walk.until("state.sides?.shown === 1")
    walk.searched()
    second = state(walk)
    assert second["part"]["solid"]["axis"] == "-z"
    number = bore["number"]
    cut_faces = set(first["part"]["solid"]["faces"][number])
    expected = [
        face["number"]
        for face in second["part"]["faces"]
        if any(
            cut_faces & set(second["part"]["solid"]["faces"][segment["number"]])
            for segment in second["part"]["segments"]
            if segment["face"] == face["number"]
        )
    ]
    assert second["avoid"] == expected and len(expected) >= 1
    assert not set(second["selected"]["faces"]) & set(expected)
    # Both sheets: that of the second knows the first.
    sheet = page.get_attribute("#take-sheet", "href")
    before = json.loads(parse_qs(urlsplit(sheet).query)["first_side"][0])
    assert before == {"job": first["job"]["job"], "rank": first["selected"]["rank"], "cut": [number]}
    assert page.inner_text("#take-other") == "Sheet of the first side"
    assert walk.saved("#take-other").startswith(b"%PDF") and walk.saved("#take-sheet").startswith(b"%PDF")
    # Both in three dimensions; under the second no three supports hold the part, which its panel says.
    assert "No three supports" in page.inner_text("#supports-notes")
    page.click("#in-space")
    walk.seen("#space-kinds li")
    saved: dict[int, set[float]] = {}
    for side in (0, 1):
        page.click(f"#space-side-{side}")
        walk.seen(f"#space-title:has-text('{('First', 'Second')[side]} side')")
        walk.seen("#space-kinds li")
        walk.seen("#space[aria-busy=false]")
        assert page.locator("#space-kinds .support").count() == 1 - side
        body = read_glb(walk.saved("#space-save"))[1][0]
        saved[side] = {round(float(z) - body.heights[0], 3) for z in body.positions[:, 2]}
        assert page.inner_text("#space-trouble") == ""
    # The base of 12 mm is below, then above.
    assert saved == {0: {0.0, 12.0, 30.0}, 1: {0.0, 18.0, 30.0}}
    page.click("#space .primary")
    # To the first and back: the same fixtures of the same searches.
    for side, was in ((0, first), (1, second), (0, first)):
        page.click(f"#side-{side}")
        walk.until(
            "state.sides.shown === given[0] && state.job?.job === given[1] && state.selected?.rank === given[2]",
            [side, was["job"]["job"], was["selected"]["rank"]],
        )
        now = state(walk)
        assert (now["job"]["job"], now["avoid"]) == (was["job"]["job"], was["avoid"])
        assert now["part"]["loops"] == was["part"]["loops"]
    walk.reload()
    walk.seen("#supports-sets tr")
    page.click("#side-1")
    walk.until("state.part.solid.axis === '-z' && state.selected !== null")
    assert state(walk)["avoid"] == expected


def test_a_side_that_cannot_be_held_is_told(walk: Walk, tmp_path: Path) -> None:
    """Where nothing of the other side is upright the first one stays, with a sentence; another height helps."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    page, upward = walk.page, gp_Ax2(gp_Pnt(45, 30, 10), gp_Dir(0, 0, 1))
    capped = fused(box(90, 60, 10), BRepPrimAPI_MakeCone(upward, 25.0, 10.0, 20.0).Shape())
    held(walk, str(write_step(tmp_path / "capped.step", capped)))
    page.click("#second-side")
    walk.seen("#turn-trouble:has-text('no upright face')")
    assert state(walk)["sides"] is None and state(walk)["part"]["solid"]["axis"] == "z"
    page.fill("#turn-height", "30")
    page.click("#second-side")
    walk.until("state.sides?.shown === 1")
    walk.searched()
    assert state(walk)["part"]["solid"]["peg_height"] == 30


def test_heights_that_help_are_offered_where_nothing_holds(walk: Walk, tmp_path: Path) -> None:
    """On the second side the part lies on a round boss; pegs that reach the base hold it, and faces cut stay ruled out."""
    page = walk.page
    base = filleted(box(100, 70, 12), 8, upright)
    held(walk, str(write_step(tmp_path / "boss.step", fused(base, cylinder(25, 10, (50, 35, 12))))))
    first = state(walk)
    touched = set(first["selected"]["faces"])
    cut_face = next(face["number"] for face in first["part"]["faces"] if face["number"] not in touched)
    page.click(f"#turn-faces [data-face='{cut_face}']")
    page.click("#second-side")
    walk.until("state.sides?.shown === 1 && state.job?.state === 'done' && state.job.found === 0")
    helping = walk.seen("#height-help button")
    assert helping.inner_text() == "Pegs of 22.00 mm hold the part"
    walk.seen("#height-words:has-text('hold the part')")
    helping.click()
    walk.searched()
    second = state(walk)
    assert second["part"]["solid"]["peg_height"] == 22 and second["sides"]["shown"] == 1
    assert len(second["avoid"]) == 1 and not set(second["selected"]["faces"]) & set(second["avoid"])


def test_another_file_has_no_second_side(walk: Walk, block: str) -> None:
    """The sides belong to one part: a new one is alone."""
    page = walk.page
    held(walk, block)
    page.click("#second-side")
    walk.until("state.sides?.shown === 1")
    page.select_option("#builtin", "widget")
    walk.until("state.sides === null && state.part.name === 'widget'")
    assert page.is_hidden("#sides")


def test_solids_are_accessible(walk: Walk, block: str) -> None:
    """By the rules of axe: how it stands, supports, the second side."""
    walk.page.evaluate(AXE.read_text(encoding="utf-8"))
    stands(walk, block)
    assert walk.page.evaluate(CHECK)[1] == []
    held(walk, block)
    assert walk.page.evaluate(CHECK)[1] == []


def test_a_solid_is_held_in_a_plain_vise(walk: Walk, tmp_path: Path) -> None:
    """Jaws on each height of parallels meet an outline of their own, which is read from the file before the search."""
    page = walk.page
    page.set_input_files("#file", str(write_step(tmp_path / "plain.step", box(80, 60, 30))))
    walk.seen("#faces button")
    page.select_option("#preset", "plain-vise-6-inch")
    assert page.locator("#part-thickness-label").is_hidden()
    page.click("#search")
    page.wait_for_selector('body[data-search="done"]')
    page.wait_for_selector("#quality tr")
    row = page.evaluate("async () => (await import('/static/state.js')).state.selected")
    assert row["quality"]["grip"] + row["quality"]["above"] == 30 and row["hold"]["knows_height"]
