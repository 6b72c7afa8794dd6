"""Run the cells of the notebooks beside this file, or of those named, and keep what they show.

Needs nothing of Jupyter: a cell is run as Python, what it prints is kept, and what its last line is worth, as text and as
the HTML that it shows of itself. An error ends the run and leaves the notebook as it was.
"""

from __future__ import annotations

import ast
import io
import json
import os
import sys
from contextlib import chdir, redirect_stdout
from pathlib import Path
from typing import Any

__all__ = ["executed"]

HTML, TEXT = "text/html", "text/plain"


def executed(path: Path) -> dict[str, Any]:
    """A notebook after every cell was run once, in order, in its own folder."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    names: dict[str, Any] = {"__name__": "__main__"}
    codes = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    with chdir(path.parent):
        for number, cell in enumerate(codes, 1):
            cell["execution_count"], cell["outputs"] = number, outputs("".join(cell["source"]), names, number)
    return dict(notebook)


def outputs(source: str, names: dict[str, Any], number: int) -> list[dict[str, Any]]:
    """What a cell shows: what it prints, and what its last line is worth, if anything."""
    tree, printed, value = ast.parse(source), io.StringIO(), None
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    with redirect_stdout(printed):
        exec(compile(tree, f"cell {number}", "exec"), names)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), f"cell {number}", "eval"), names)
    shown = []
    if printed.getvalue():
        shown.append(
            {"name": "stdout", "output_type": "stream", "text": printed.getvalue().splitlines(keepends=True)}
        )
    if value is not None:
        data = {TEXT: repr(value).splitlines(keepends=True)}
        html = value._repr_html_() if hasattr(value, "_repr_html_") else None
        if html is not None:
            data = {HTML: html.splitlines(keepends=True), **data}
        shown.append(
            {"data": data, "execution_count": number, "metadata": {}, "output_type": "execute_result"}
        )
    return shown


def main() -> None:
    """Run and keep."""
    here = Path(__file__).resolve().parent
    for path in [Path(name) for name in sys.argv[1:]] or sorted(here.glob("*.ipynb")):
        text = json.dumps(executed(path), indent=1, ensure_ascii=False)
        path.write_text(text + os.linesep, encoding="utf-8")


if __name__ == "__main__":
    main()
