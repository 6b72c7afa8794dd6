"""The machine's program on the page: what was understood, its paths, the nearest move, and what the search makes of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from test_accessibility import AXE, CHECK
from walking import EXAMPLES, Walk

PROGRAM, TOOLS = EXAMPLES / "bracket.nc", EXAMPLES / "tools.toml"
PATHS = "paths => paths.map(path => path.getAttribute('d').length)"


def add_program_zones(walk: Walk, *files: Path, thickness: str = "12", pegs: str = "6") -> None:
    """Open the bracket with its program, and say how high part and pegs are."""
    walk.page.set_input_files("#file", str(EXAMPLES / "bracket.dxf"))
    walk.seen("#faces button")
    walk.page.set_input_files("#program-file", [str(file) for file in files or (PROGRAM, TOOLS)])
    for field, value in (("#program-thickness", thickness), ("#program-pegs", pegs)):
        walk.page.fill(field, value)
        walk.page.press(field, "Tab")


def shown(walk: Walk) -> dict[str, Any]:
    """What the server tells of the fixture on show."""
    return dict(walk.server.client.get(f"/api/jobs/{walk.job()}/fixtures/{walk.shown()['rank']}").json())


def test_what_was_understood_is_told_and_drawn(walk: Walk) -> None:
    """Tools with their lines, the box of their tips, notes; over the part bands, dashed rapids, dark and light cuts."""
    page = walk.page
    add_program_zones(walk)
    walk.seen("#program-read")
    rows = page.locator("#program-tools tbody tr").all_inner_texts()
    assert [row.split()[:2] for row in rows] == [["T1", "10.00"], ["T3", "9.00"], ["T2", "8.00"]]
    assert "13–30" in rows[0] and "49–70" in rows[2]
    walk.seen("#program-words:has-text('stays above pegs')")
    words = page.inner_text("#program-words")
    assert "61 moves" in words and "T1 stays above pegs 6.0 mm high" in words
    assert "Lines 8, 31, 43 and 71" in page.inner_text("#program-notes")
    assert page.locator("#drawing-part .program-band").count() == 3
    assert page.locator("#drawing-part .program-rapid").count() == 1
    assert page.locator("#drawing-part .program-cut").count() > 3
    low, high = (
        float(page.locator(f"#drawing-part .program-cut >> nth={k}").get_attribute("stroke-opacity"))
        for k in (-1, 0)
    )
    assert low > high


def test_the_search_lets_every_tool_pass_and_lights_up_the_nearest_move(walk: Walk) -> None:
    """Fewer fixtures than without; line, tool and distance stand in the panel and beside the move, also in inches."""
    page = walk.page
    add_program_zones(walk)
    walk.seen("#program-read")
    walk.search()
    count = walk.count()
    near = shown(walk)["passing"]
    walk.seen(f"#passing:has-text('T{near['tool']} comes nearest in line {near['line']}')")
    assert f"{near['distance']:.3f} mm from the {near['element']}" in page.inner_text("#passing")
    label = walk.seen("#drawing-fixture .program-label").text_content()
    assert label == f"line {near['line']}, T{near['tool']}: {near['distance']:.2f} mm"
    assert page.locator("#drawing-fixture .program-nearest").count() == 1
    assert page.locator("#drawing-fixture .program-band").count() == 3
    band = page.locator("#drawing-fixture .program-nearest-band").bounding_box()
    center = walk.point(*place(walk, 102.0, 18.0), "fixtureDrawing")
    assert band["x"] - 1 < center[0] < band["x"] + band["width"] + 1
    page.select_option("#unit", "inch")
    walk.seen(f"#passing:has-text('{near['distance'] / 25.4:.4f} in')")
    page.select_option("#unit", "mm")
    page.click("#program-none")
    walk.until("state.program === null && state.job && state.job.state === 'done' && state.selected")
    assert walk.count() > count
    assert page.locator("#drawing-fixture .program-band").count() == 0
    assert not page.is_visible("#passing-card")


def place(walk: Walk, x: float, y: float) -> tuple[float, float]:
    """A point of the part in the frame of the fixture on show."""
    found = walk.page.evaluate(
        "async ([x, y]) => (await import('/static/stage-panel.js')).fixtureDrawing.toVise([x, y])", [x, y]
    )
    return float(found[0]), float(found[1])


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("G21 G90\nT1 M6 (T1 D=10)\nG41 D1\nG1 X5\n", "Wrong.nc: line 3: G41 offsets the path"),
        (
            "G21 G90\nT7 M6\nG0 X5 Y5 Z5\n",
            "Wrong.nc: the program calls T7, and the diameter of T7 is not known",
        ),
        ("G21 G90\nT1 M6 (T1 D=10)\nG0 X[#1+2] Y0\n", "line 3: 'G0 X[#1+2] Y0' reckons with variables"),
    ],
)
def test_what_cannot_be_read_is_refused_by_its_line(
    walk: Walk, tmp_path: Path, text: str, sentence: str
) -> None:
    """One sentence with the file's own name, no path and no option of the command; the search says it as well."""
    wrong = tmp_path / "Wrong.nc"
    wrong.write_text(text)
    add_program_zones(walk, wrong)
    walk.page.locator("#program-trouble:not([hidden])", has_text=sentence).wait_for()
    said = walk.page.inner_text("#program-trouble")
    assert sentence in said and "/" not in said.replace("N/A", "") and "--" not in said
    assert not walk.page.is_visible("#program-read")
    walk.page.click("#search")
    walk.until("state.job && state.job.state === 'failed'")
    assert sentence in walk.page.inner_text("#search-trouble")
    walk.troubles.clear()


def test_a_table_of_tools_may_come_first_and_heights_are_asked_for(walk: Walk) -> None:
    """The table waits for its program; without a thickness the page asks for it in its own words."""
    page = walk.page
    walk.page.set_input_files("#file", str(EXAMPLES / "bracket.dxf"))
    walk.seen("#faces button")
    page.set_input_files("#tools-file", str(TOOLS))
    walk.seen("#program-trouble:has-text('tools.toml is a table of tools')")
    page.set_input_files("#program-file", str(PROGRAM))
    walk.seen("#program-trouble:has-text('fill in “Part thickness”')")
    assert page.inner_text("#program-name") == "bracket.nc with tools.toml"
    page.fill("#program-thickness", "12")
    page.press("#program-thickness", "Tab")
    walk.seen("#program-read")
    assert "T3" in page.inner_text("#program-tools")
    walk.troubles.clear()


def test_a_program_may_be_dropped_and_stays_over_a_reload(walk: Walk) -> None:
    """Dropped beside the part it is taken as a program, not as a part; a reload has it again, as it was found."""
    page = walk.page
    add_program_zones(walk)
    walk.seen("#program-read")
    page.click("#program-none")
    assert not page.is_visible("#program-fields")
    script = """async ([program, tools]) => {
      const files = new DataTransfer();
      files.items.add(new File([program], "bracket.nc"));
      files.items.add(new File([tools], "tools.toml"));
      dispatchEvent(new DragEvent("drop", { dataTransfer: files, bubbles: true, cancelable: true }));
    }"""
    page.evaluate(script, [PROGRAM.read_text(), TOOLS.read_text()])
    walk.seen("#program-read")
    page.fill("#program-pegs", "6")
    page.press("#program-pegs", "Tab")
    walk.search()
    count = walk.count()
    walk.reload()
    walk.searched()
    walk.seen("#program-read")
    assert walk.count() == count
    walk.seen("#passing:has-text('comes nearest')")


@pytest.mark.sampled(2)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_panel_can_be_read_by_all(walk: Walk, scheme: str) -> None:
    """Neither contrast nor names fail."""
    walk.page.emulate_media(color_scheme=scheme)
    add_program_zones(walk)
    walk.seen("#program-read")
    walk.search()
    walk.seen("#passing:has-text('comes nearest')")
    walk.page.evaluate(AXE.read_text(encoding="utf-8"))
    checked, violations = walk.page.evaluate(CHECK)
    assert checked > 20 and violations == []
