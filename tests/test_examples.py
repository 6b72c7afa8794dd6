"""The notebook of the examples runs as it stands, and what it shows is what is stored in it."""

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
            texts += ["a picture"] if "<svg" in "".join(data.get("image/svg+xml", ())) else []
            # Of a table all words, and that there is a picture.
            html = re.sub(r'src="data:image/[^"]*"', "a picture", "".join(data.get("text/html", ())))
            texts += [html] if html else []
    return texts


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.ipynb")), ids=lambda path: path.name)
def test_the_notebook_shows_what_is_stored_in_it(path: Path) -> None:
    """Run again, every cell prints and is worth the same; ``python examples/run_notebook.py`` stores it anew."""
    stored = json.loads(path.read_text())
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
