"""The command: sets are listed, made as the manifest has them, and compared; what cannot be is said in one sentence."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from workhold.cli.main import app

Content = Callable[[str], dict[str, Any]]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Any]:
    """Run the command within this process."""
    monkeypatch.setenv("COLUMNS", "80")
    return lambda *words: CliRunner().invoke(app, ["benchmark", *map(str, words)])


def test_sets_are_listed_by_name_by_part_and_by_word(run: Callable[..., Any]) -> None:
    """A name is one set, a workpiece all of its sets, another word all whose names contain it."""
    assert [one["name"] for one in json.loads(run("list", "kite-vise", "--json").stdout)["sets"]] == [
        "kite-vise"
    ]
    parts = {one["workpiece"] for one in json.loads(run("list", "el", "--json").stdout)["sets"]}
    assert parts == {"el"}
    assert len(json.loads(run("list", "wedge", "--json").stdout)["sets"]) > 8
    shown = run("list", "kite").stdout
    assert "kite-vise" in shown
    assert max(map(len, shown.splitlines())) <= 80


def test_a_name_that_is_none_is_refused_with_those_that_are_close(run: Callable[..., Any]) -> None:
    """One sentence, and the exit code of bad input."""
    outcome = run("list", "kite-wise")
    assert outcome.exit_code == 2
    assert "did you mean kite-vise" in outcome.stderr


def test_sets_are_made_and_hold(
    run: Callable[..., Any], tmp_path: Path, content: Content, checker: Any
) -> None:
    """The folder has the sets with what is needed to check them, and a second run writes the same bytes."""
    outcome = run("run", "bar-plate", "disc-flat", "--out", tmp_path / "sets", "--threads", 1)
    assert outcome.exit_code == 0, outcome.output
    assert "all equal to the manifest" in " ".join(outcome.stdout.split())
    names = {path.name for path in (tmp_path / "sets").iterdir()}
    assert names == {"bar-plate.json", "disc-flat.json", "manifest.json", "check.py", "parts"} | {
        "set.schema.json",
        "entry.schema.json",
    }
    text = (tmp_path / "sets" / "bar-plate.json").read_text()
    assert json.loads(text) == content("bar-plate")
    manifest = json.loads((tmp_path / "sets" / "manifest.json").read_text())
    assert checker.check(json.loads(text), text, manifest, starts=0) == []
    assert run("run", "bar-plate", "--out", tmp_path / "sets", "--threads", 2).exit_code == 0
    assert (tmp_path / "sets" / "bar-plate.json").read_text() == text


def test_a_list_is_compared(run: Callable[..., Any], tmp_path: Path, content: Content) -> None:
    """Found, missed and extra are counted, and named in JSON from 1."""
    fixtures = content("bar-plate")["fixtures"]
    path = tmp_path / "mine.json"
    path.write_text(json.dumps({"fixtures": fixtures[3:]}))
    shown = run("check", path, "--set", "bar-plate", "--threads", 1)
    assert shown.exit_code == 0, shown.output
    assert "95.0 %" in shown.stdout
    assert "Missed: 1, 2, 3, of the complete list" in shown.stdout
    assert max(map(len, shown.stdout.splitlines())) <= 80
    [data] = json.loads(run("check", path, "--set", "bar-plate", "--json").stdout)["files"]
    assert data["missed"] == [1, 2, 3]
    assert (data["listed"], data["theirs"], len(data["found"])) == (60, 57, 57)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("run", "kite-vise"), "--out"),
        (("check",), "needs a file"),
        (("check", "nowhere.json", "--set", "kite-vise"), "nowhere.json"),
        (("play",), "the action"),
        (("list", "--out", "x"), "--out belongs to run"),
        (("check", "a.json", "--tolerance", "-1"), "--tolerance"),
    ],
)
def test_what_cannot_be_is_said_in_a_sentence(
    run: Callable[..., Any], words: tuple[str, ...], sentence: str
) -> None:
    """With the exit code of bad input and without a traceback."""
    outcome = run(*words)
    assert outcome.exit_code == 2
    assert sentence in outcome.stderr
    assert "Traceback" not in outcome.output


def test_the_checker_is_printed_as_it_is(run: Callable[..., Any], checker: Any) -> None:
    """What is printed is the file."""
    assert run("checker").stdout == Path(checker.__file__).read_text(encoding="utf-8")


@pytest.mark.thorough
def test_parquet_says_the_same(
    run: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rows and head of a set in Parquet are those of its JSON, where a row lacks what it has not."""
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr("workhold.benchmark.making.LARGE", 10)
    assert run("run", "bar-pair", "--parquet", "--out", tmp_path, "--threads", 1).exit_code == 0
    assert run("run", "bar-pair", "--out", tmp_path, "--threads", 1).exit_code == 0
    table = parquet.read_table(tmp_path / "bar-pair.parquet")
    head = json.loads(table.schema.metadata[b"workhold-benchmark"])
    content = json.loads((tmp_path / "bar-pair.json").read_text())
    assert [without_none(row) for row in table.to_pylist()] == [
        without_none(one) for one in content["fixtures"]
    ]
    del content["fixtures"]
    assert head == content


def without_none(value: Any) -> Any:
    """A value without the keys that have none."""
    if isinstance(value, dict):
        return {key: without_none(one) for key, one in value.items() if one is not None}
    return [without_none(one) for one in value] if isinstance(value, list) else value
