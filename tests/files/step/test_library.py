"""What is said when STEP files cannot be read or written on this machine: one sentence with the remedy."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from fakes import fake_result
from workhold.errors import InputError
from workhold.files.part.load import read_workpiece
from workhold.files.step.library import REQUIREMENT, OpenCascade
from workhold.files.step.reader import read_step
from workhold.files.step.writer import write_setup_step

STEP = "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"
NO_EXTRA = f"a library that is not installed: pip install '{REQUIREMENT}'."
PROJECT = Path(__file__).parents[3] / "pyproject.toml"


def test_the_advice_names_what_the_extra_asks_for() -> None:
    """And not this project, whose name on an index may be somebody else's."""
    assert tomllib.loads(PROJECT.read_text())["project"]["optional-dependencies"]["step"] == [REQUIREMENT]


class Blocked:
    """A finder that lets the import of OCP fail with an error of our choice."""

    def __init__(self, error: ImportError) -> None:
        self.error = error

    def find_spec(self, name: str, path: object = None, target: object = None) -> None:
        """Fail for OCP and its modules; know nothing of others."""
        if name.partition(".")[0] == "OCP":
            raise self.error


@pytest.fixture
def block(monkeypatch: pytest.MonkeyPatch):  # type: ignore[no-untyped-def]
    """Make the import of OCP fail."""

    def blocked(error: ImportError) -> None:
        for name in [name for name in sys.modules if name.partition(".")[0] == "OCP"]:
            monkeypatch.delitem(sys.modules, name)
        monkeypatch.setattr(sys, "meta_path", [Blocked(error), *sys.meta_path])

    return blocked


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (ModuleNotFoundError("No module named 'OCP'", name="OCP"), NO_EXTRA),
        (
            ImportError("libGL.so.1: cannot open shared object file: No such file or directory"),
            "the system library libGL.so.1, which is missing: apt install libgl1.",
        ),
        (
            ImportError("libX11.so.6: cannot open shared object file: No such file or directory"),
            "the system library libX11.so.6, which is missing: apt install libx11-6.",
        ),
        (
            ImportError("libfoo.so.2: cannot open shared object file: No such file or directory"),
            "the system library libfoo.so.2, which is missing: apt install libgl1 libx11-6.",
        ),
        (ImportError("undefined symbol: x\ny"), "cannot be loaded (undefined symbol: x y): pip install"),
    ],
    ids=["no extra", "no libGL", "no libX11", "another library", "anything else"],
)
def test_a_missing_library_is_one_sentence_with_the_remedy(
    tmp_path: Path,
    block,  # type: ignore[no-untyped-def]
    error: ImportError,
    said: str,
) -> None:
    """Reading and writing say the same."""
    block(error)
    result = fake_result(1)
    for attempt in (
        lambda: read_step(STEP.encode()),
        lambda: write_setup_step(result[0], result.workpiece, result.toolkit, tmp_path / "set-up.step"),
    ):
        with pytest.raises(InputError) as caught:
            attempt()
        assert said in str(caught.value)
        assert "\n" not in str(caught.value)
    assert not (tmp_path / "set-up.step").exists()


def test_a_question_for_what_python_names_imports_nothing(block) -> None:  # type: ignore[no-untyped-def]
    """As ``inspect.unwrap`` asks it of every object of a module, in which doctest looks for examples."""
    block(ModuleNotFoundError("No module named 'OCP'", name="OCP"))
    assert not hasattr(OpenCascade(), "__wrapped__")


def test_the_command_line_ends_with_code_2_without_the_extra(tmp_path: Path) -> None:
    """A folder with an OCP that cannot be imported stands for a machine without it."""
    (tmp_path / "OCP.py").write_text("raise ModuleNotFoundError(\"No module named 'OCP'\", name='OCP')\n")
    (tmp_path / "part.stp").write_text(STEP)
    script = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); from workhold.cli.main import run; run()"
    done = subprocess.run(
        [sys.executable, "-c", script, "features", str(tmp_path / "part.stp")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1 and NO_EXTRA in done.stderr


def test_other_files_do_not_load_the_library(tmp_path: Path) -> None:
    """Reading a built-in part imports nothing of OCP, which takes a second."""
    script = "import sys, workhold; workhold.load('widget'); sys.exit(any(m.startswith('OCP') for m in sys.modules))"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0


@pytest.mark.parametrize("option", [{"axis": "z"}, {"section": 5.0}])
def test_flat_drawings_have_no_axis(option: dict[str, object]) -> None:
    """A JSON part cannot be looked at from the side."""
    with pytest.raises(InputError, match="only a STEP file can be looked at along an axis"):
        read_workpiece("widget", **option)  # type: ignore[arg-type]
