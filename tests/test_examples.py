"""Each notebook of the examples runs as it stands, and what it shows is what is stored in it."""

from __future__ import annotations

import json
import re
import runpy
from pathlib import Path
from typing import Any

import pytest

EXAMPLES = Path(__file__).parent.parent / "examples"


def shown(notebook: dict[str, Any]) -> list[str]:
    """What the cells show as text, one after the other; of a picture that it is one."""
    texts = []
    for cell in notebook["cells"]:
        for output in cell.get("outputs", ()):
            data = output.get("data", {})
            texts.append("".join(output.get("text", data.get("text/plain", ()))))
            # Of tables all words, and where there is a picture.
            html = re.sub(r"<img [^>]*>", "a picture", "".join(data.get("text/html", ())))
            texts += [re.sub(r"(\s*<[^>]*>\s*)+", " | ", html)] if html else []
    return texts


@pytest.mark.thorough
@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.ipynb")), ids=lambda path: path.name)
def test_the_notebook_shows_what_is_stored_in_it(path: Path) -> None:
    """Run again, every cell prints and is worth the same; ``python examples/run_notebook.py`` stores it anew."""
    stored = json.loads(path.read_text())
    for library in stored["metadata"].get("workhold", {}).get("needs", ()):
        pytest.importorskip(library, reason=f"{path.name} needs {library}, which is not installed")
    again = runpy.run_path(str(EXAMPLES / "run_notebook.py"))["executed"](path)
    assert shown(again) == shown(stored)
    assert any("a picture" in text for text in shown(stored))
    counts = [cell["execution_count"] for cell in stored["cells"] if cell["cell_type"] == "code"]
    assert counts == list(range(1, len(counts) + 1))


def test_what_a_cell_shows_is_kept() -> None:
    """What it prints, and what its last line is worth; a statement, and None, are worth nothing."""
    outputs = runpy.run_path(str(EXAMPLES / "run_notebook.py"))["outputs"]
    assert outputs("x = 3", {}, 1) == outputs("None", {}, 1) == []
    assert outputs("0", {}, 1)[0]["data"] == {"text/plain": ["0"]}
    assert outputs("print(2)", {}, 1) == [{"name": "stdout", "output_type": "stream", "text": ["2\n"]}]
    (worth,) = outputs("x = 3\nx + 1", {}, 7)
    assert (worth["data"], worth["execution_count"]) == ({"text/plain": ["4"]}, 7)
    with pytest.raises(ZeroDivisionError):
        outputs("1 / 0", {}, 1)


def test_what_a_notebook_shows_is_told_apart() -> None:
    """Another word or figure in a table is another output; another drawing of the same picture is not."""

    def notebook(html: str) -> dict[str, Any]:
        return {"cells": [{"outputs": [{"data": {"text/html": [html], "text/plain": ["x"]}}]}]}

    drawn, again = (f'<td><img src="data:image/svg+xml;base64,{held}"></td>' for held in ("QQ==", "Qg=="))
    assert shown(notebook(drawn)) == shown(notebook(again)) == ["x", " | a picture | "]
    assert shown(notebook("<td>1.0</td>")) != shown(notebook("<td>1.1</td>"))


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.ipynb")), ids=lambda path: path.name)
def test_the_notebook_reads_well_where_nothing_runs(path: Path) -> None:
    """What is stored is whole and small, has a picture, and names what it needs."""
    stored = json.loads(path.read_text())
    assert path.stat().st_size < 400_000
    assert (stored["nbformat"], stored["nbformat_minor"]) == (4, 5)
    ids = [cell["id"] for cell in stored["cells"]]
    assert len(set(ids)) == len(ids)
    assert any("a picture" in text for text in shown(stored))
    source = "".join("".join(cell["source"]) for cell in stored["cells"] if cell["cell_type"] == "code")
    needs = stored["metadata"].get("workhold", {}).get("needs", [])
    for library, sign in (
        ("build123d", "build123d import"),
        ("cadquery", "import cadquery"),
        ("anywidget", ".widget("),
    ):
        assert (library in needs) == (sign in source)
