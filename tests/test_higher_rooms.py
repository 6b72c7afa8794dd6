"""Methods of the model that end in rooms above it work whatever was imported first, and cost nothing before."""

from __future__ import annotations

import subprocess
import sys
import textwrap
from importlib.util import find_spec
from pathlib import Path

import pytest

import workhold

MAKING = """
import workhold
from workhold.files.result.reader import read_result
from workhold.model.requirements import Tolerance
from workhold.fixels.vise import Vise

result = read_result("wedge.json")
"""
# What each method writes or returns, and a word or a number that shows that it did.
METHODS = {
    "Workpiece.draw": "print('<svg' in result.workpiece.draw())",
    "Fixture.draw": "print('<svg' in result[0].draw('f.svg'))",
    "Fixture.save_sheet": "result[0].save_sheet('sheet.pdf'); print(open('sheet.pdf', 'rb').read(4) == b'%PDF')",
    "Result.draw": "print('<svg' in result.draw())",
    "Result.to_pandas": "print(len(result.to_pandas()) == len(result))",
    "Result.to_arrow": "print(result.to_arrow().num_rows == len(result))",
    "Toolkit.preset": "print(Vise.preset('plate-20mm', rows=4).rows == 4)",
    "Toolkit.presets": "print('plate-20mm' in Vise.presets())",
    "Tolerance.preset": "print(Tolerance.preset('plate-20mm') != Tolerance())",
    "save": "workhold.save(result, 'r.csv'); print(len(open('r.csv').readlines()) > len(result))",
}
# Modules of rooms below and above the model, and of the model; each costs a process that imports everything.
ORDERS = (
    "workhold",
    "workhold.model.result, workhold.model.workpiece",
    "workhold.presenting.papers",
    "workhold.kernels",
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a result."""
    made = tmp_path_factory.mktemp("methods")
    wedge = workhold.Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
    workhold.save(
        workhold.design(wedge, workhold.Vise(pitch=15, columns=1, peg_radius=2), best=2), made / "wedge.json"
    )
    return made


@pytest.mark.thorough
@pytest.mark.parametrize("first", ORDERS)
def test_every_method_works_whatever_was_imported_first(first: str, folder: Path) -> None:
    """Of a process that imports some modules first, each method answers."""
    # What gives tables of a library that is not installed is left out.
    libraries = {"Result.to_pandas": "pandas", "Result.to_arrow": "pyarrow"}
    methods = {name: code for name, code in METHODS.items() if find_spec(libraries.get(name, "sys"))}
    code = "\n".join([f"import {first}", MAKING, *methods.values()])
    outcome = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=folder, check=False
    )
    assert outcome.stderr == ""
    assert dict(zip(methods, outcome.stdout.split(), strict=True)) == dict.fromkeys(methods, "True")


def test_the_package_alone_imports_next_to_nothing() -> None:
    """Of its own modules only the version, and no library."""
    code = "import sys; before = set(sys.modules); import workhold; print(*sorted(set(sys.modules) - before))"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    own = [name for name in loaded if name.partition(".")[0] == "workhold"]
    assert own == ["workhold", "workhold.version"]
    assert {name.partition(".")[0] for name in loaded} <= {"workhold", *sys.stdlib_module_names}


@pytest.mark.thorough
def test_methods_are_typed(tmp_path: Path) -> None:
    """A checker knows what the methods return, and refuses an option that there is none of."""
    code = """
    import workhold
    result = workhold.design(workhold.load("widget"), workhold.Vise(pitch=8, columns=1, peg_radius=3))
    reveal_type(result[0].draw())
    reveal_type(result[0].supports(12))
    reveal_type(result.why_none())
    result[0].save_sheet("a.pdf", papers="a4")
    """
    (tmp_path / "asked.py").write_text(textwrap.dedent(code))
    checked = [sys.executable, "-m", "mypy", "--config-file", "", "--follow-imports=silent", "asked.py"]
    told = subprocess.run(checked, capture_output=True, text=True, cwd=tmp_path, check=False).stdout
    for kind in ("presenting.papers.Picture", "support_triples.Supports", "notebook.NoFixtureNote"):
        assert kind in told
    assert 'Unexpected keyword argument "papers"' in told
