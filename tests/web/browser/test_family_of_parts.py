"""Many parts on the page: files dropped together, the curve, and the plan at a point of it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from walking import SEARCH_PATIENCE, Walk

from family_parts import shop_parts

pytest.importorskip("scipy", reason="the extra [batch] is not installed")


@pytest.fixture
def files(tmp_path: Path) -> list[Path]:
    """Three parts, and a file that is none."""
    out = []
    for part in shop_parts(3):
        out.append(tmp_path / f"{part.name}.json")
        loops = [loop.tolist() for loop in part.loops]
        out[-1].write_text(json.dumps({"name": part.name, "units": "mm", "loops": loops}))
    out.append(tmp_path / "odd.dxf")
    out[-1].write_text("0\nSECTION\n")
    return out


DROPPED = """async (files) => {
  const data = new DataTransfer();
  for (const [name, text] of files) data.items.add(new File([text], name));
  dispatchEvent(new DragEvent("drop", { dataTransfer: data, cancelable: true }));
}"""

# Waits for both pictures; their smaller width.
DECODED = """async () => {
  const pictures = ["family-curve", "family-sheets"].map((id) => document.getElementById(id));
  await Promise.all(pictures.map((picture) => picture.decode()));
  return Math.min(...pictures.map((picture) => picture.naturalWidth));
}"""


def test_files_dropped_together_give_a_curve_and_a_plan(walk: Walk, files: list[Path]) -> None:
    page = walk.page
    page.evaluate(DROPPED, [[file.name, file.read_text()] for file in files])
    page.wait_for_selector("#family-parts li:nth-child(4)")
    assert page.locator("#family-parts li.bad").count() == 1
    page.wait_for_selector("#family-search:not([disabled])")
    assert page.inner_text("#family-search") == "Find the fewest set-ups for 3 parts"
    page.click("#family-search")
    page.wait_for_selector("#family-answer", state="visible", timeout=SEARCH_PATIENCE)
    counts = [int(words) for words in page.locator("#family-table th[scope=row]").all_inner_texts()]
    losses = [
        float(words.split()[0])
        for words in page.locator("#family-table tbody td:nth-child(2)").all_inner_texts()
    ]
    assert counts == sorted(counts) and losses == sorted(losses, reverse=True) and losses[-1] == 1.0
    assert page.evaluate(DECODED) > 0
    page.click(f"#family-table button[aria-label='Plan with {counts[-1]} set-ups']")
    assert f"setups={counts[-1]}&" in (page.get_attribute("#family-sheets", "src") or "")
    assert page.evaluate(DECODED) > 0
    with page.expect_download() as saved:
        page.click("#family-pdf")
    assert Path(saved.value.path()).read_bytes().startswith(b"%PDF")
    page.click("#family form button")
    assert page.locator("#family").is_hidden()
    assert not walk.server.state.jobs.by_name or page.locator("#family-answer").is_hidden()


def test_parts_are_taken_away_one_by_one(walk: Walk, files: list[Path]) -> None:
    page = walk.page
    page.click("#families")
    assert page.locator("#family-search").is_disabled()
    page.set_input_files("#family-files", [str(file) for file in files[:2]])
    page.wait_for_selector("#family-parts li:nth-child(2)")
    page.click(f"#family-parts button[aria-label='Leave out {files[0].name}']")
    assert page.inner_text("#family-search") == "Find the fewest set-ups for one part"
    page.click(f"#family-parts button[aria-label='Leave out {files[1].name}']")
    assert page.locator("#family-search").is_disabled()


def test_one_file_dropped_is_the_part(walk: Walk, files: list[Path]) -> None:
    page = walk.page
    page.evaluate(DROPPED, [[files[0].name, files[0].read_text()]])
    page.wait_for_selector("#search:not([disabled])")
    assert page.locator("#family").is_hidden()


def test_blocks_in_a_plain_vise(walk: Walk, tmp_path: Path) -> None:
    """Each drawing has a field for its thickness, and changes of parallels and stop are counted."""
    page = walk.page
    files = []
    for name, width in (("low", 90), ("high", 60)):
        files.append(tmp_path / f"{name}.json")
        loop = [[0, 0, 0], [width, 0, 0], [width, 40, 0], [0, 40, 0]]
        files[-1].write_text(json.dumps({"name": name, "units": "mm", "loops": [loop]}))
    walk.go("settings")
    page.select_option("#preset", "plain-vise-6-inch")
    page.click("#families")
    assert "parallels" in page.inner_text("#family-about")
    page.set_input_files("#family-files", [str(file) for file in files])
    page.wait_for_selector("#family-parts li:nth-child(2) input")
    page.click("#family-search")
    page.wait_for_selector("#family-trouble", state="visible", timeout=SEARCH_PATIENCE)
    assert "give its thickness" in page.inner_text("#family-trouble")
    for place, thickness in ((1, "14"), (2, "45")):
        page.fill(f"#family-parts li:nth-child({place}) input", thickness)
        page.press(f"#family-parts li:nth-child({place}) input", "Tab")
    page.click("#family-search")
    page.wait_for_selector("#family-answer", state="visible", timeout=SEARCH_PATIENCE)
    assert page.locator("#family-table th[scope=row]").all_inner_texts() == ["1", "2"]
    assert "Changes" in page.inner_text("#family-table thead")
    assert page.evaluate(DECODED) > 0
