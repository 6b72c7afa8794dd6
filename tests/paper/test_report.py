"""The report of ``make paper``: every number printed is one of its data files, and what it leaves behind can be checked."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections import Counter
from pathlib import Path
from time import sleep

import pytest
from report_reading import Page, at_key, page_of, pdf_numbers

import workhold
from paper.stages import STAGES

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "benchmarks" / "make_paper.py"
SOME = ("table-one", "table-two", "claims", "stages")
EVERY: tuple[str, ...] = ()


def only(names: tuple[str, ...]) -> list[str]:
    """The options that ask for some sections."""
    return [word for name in names for word in ("--only", name)]


def make(out: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Make a small report."""
    command = [sys.executable, str(SCRIPT), "--quick", "--out", str(out), *words]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.fixture(
    scope="module", params=[SOME, pytest.param(EVERY, marks=pytest.mark.prove)], ids=["some", "every"]
)
def folder(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small report, of some sections or of all."""
    out = tmp_path_factory.mktemp("paper")
    made = make(out, *only(request.param))
    assert made.returncode == 0, made.stderr
    return out


@pytest.fixture(scope="module")
def page(folder: Path) -> Page:
    """Its page."""
    return page_of(folder / "report.html")


@pytest.mark.thorough
def test_every_number_of_the_page_is_that_of_its_data_file(folder: Path, page: Page) -> None:
    """The text, read as a number in its unit, is the value at its key to half a unit of the last digit."""
    assert len(page.numbers) > 200
    for number in page.numbers:
        value = at_key(folder, number.key)
        assert abs(number.value - value) <= number.half_unit * (1 + 1e-9) + 1e-12 * abs(value), number


def test_no_number_of_the_page_is_without_a_key(page: Page) -> None:
    """Digits stand in numbers, or in what is marked as a command, a quotation, a label, a reference or a picture."""
    assert page.loose == []


def test_the_pdf_has_the_numbers_of_the_page(folder: Path, page: Page) -> None:
    """The text below each link of the PDF is what the page prints for the same key, as often as there."""
    printed = Counter(
        (number.key, number.text.replace(" ", "")) for number in pdf_numbers(folder / "report.pdf")
    )
    assert printed == Counter((number.key, number.text.replace(" ", "")) for number in page.numbers)


def test_what_is_derived_follows_from_the_rows(folder: Path) -> None:
    """Sums, ratios and counts of Tables 1 and 2 are those of their rows; the shares of the stages add up to the whole."""
    one, two, stages = (
        json.loads((folder / "data" / f"{name}.json").read_text())["data"]
        for name in ("table-one", "table-two", "stages")
    )
    for row in one["rows"]:
        assert row["ratio"] == pytest.approx(row["paper"]["seconds"] / row["seconds"])
        assert row["contacts"] > row["I"] + row["II"] > 0
        proof = row["proof"]
        assert proof["candidates"] == proof["discarded_by_bound"] + proof["verified"] + proof["undecided"]
    seconds, paper = (
        sum(values)
        for values in zip(*((r["seconds"], r["paper"]["seconds"]) for r in one["rows"]), strict=True)
    )
    assert one["together"] == pytest.approx(
        {"seconds": seconds, "paper_seconds": paper, "ratio": paper / seconds}
    )
    assert two["disagreeing"] == sum(row["printed"] > row["poses"] for row in two["rows"]) == 7
    assert two["most"] == {"I": 16, "II": 6} and two["all_agree"]
    for row in stages["rows"]:
        shares = [value for name, value in row.items() if name in STAGES]
        assert len(shares) == len(STAGES) and sum(shares) == pytest.approx(1.0) and min(shares) > -0.05


def test_every_section_says_its_command(folder: Path) -> None:
    """A data file names the command that makes it, whether it is whole, and what it was made by."""
    names = {path.stem for path in (folder / "data").glob("*.json")} - {"run"}
    assert names >= set(SOME)
    for name in names:
        told = json.loads((folder / "data" / f"{name}.json").read_text())
        assert told["command"] == f"python benchmarks/make_paper.py --only {name}"
        assert told["complete"] and told["reason"] == "" and told["quick"]


@pytest.mark.parametrize("name", ["clamp.json", "doubles.json"])
def test_witnesses_are_verified(folder: Path, name: str) -> None:
    """The result files beside the report are proven, complete, and hold the fixture that the claim names."""
    told = json.loads((folder / "data" / "claims.json").read_text())["data"]
    outcome = workhold.verify(folder / "witnesses" / name, complete=True)
    assert outcome.holds and outcome.proven == outcome.fixtures > 0
    assert 1 <= told[f"{name.removesuffix('.json')}_number"] <= outcome.fixtures


def test_the_clamp_of_the_witness_stands_behind_a_locator(folder: Path) -> None:
    """So no vise has it: a right peg would stand to the left of a left one."""
    told = json.loads((folder / "data" / "claims.json").read_text())["data"]
    result = workhold.open(folder / "witnesses" / "clamp.json")
    *locators, clamp = result[told["clamp_number"] - 1].pegs
    assert clamp.x < max(peg.x for peg in locators)


@pytest.mark.parametrize("forged", [False, True])
def test_the_systems_of_the_witness_are_derived_again(folder: Path, tmp_path: Path, forged: bool) -> None:
    """The script that shares nothing with the search accepts the true file and refuses one with a factor changed."""
    told = json.loads((folder / "witnesses" / "degrees.json").read_text())
    if forged:
        told["systems"][4]["factors"][0]["coefficients"][3] += 1
    path = tmp_path / "degrees.json"
    path.write_text(json.dumps(told))
    script = ROOT / "benchmarks" / "paper" / "elimination.py"
    done = subprocess.run(
        [sys.executable, str(script), str(path)], capture_output=True, text=True, check=False
    )
    assert done.returncode == int(forged), done.stderr
    assert done.stdout.count("NOT as in the file") == int(forged)


def test_a_section_is_kept_until_the_program_changes(tmp_path: Path) -> None:
    """``--keep`` leaves a whole file of the same program as it is, and measures again what another one made."""
    path = tmp_path / "data" / "table-two.json"
    words = only(("table-two",))
    assert make(tmp_path, *words).returncode == 0
    first = path.read_bytes()
    assert make(tmp_path, "--keep", *words).returncode == 0
    assert path.read_bytes() == first
    told = json.loads(first)
    for change in ({"fingerprint": "another"}, {"complete": False}, {"quick": False}):
        path.write_text(json.dumps(told | change | {"seconds": -1.0}))
        assert make(tmp_path, "--keep", *words).returncode == 0
        again = json.loads(path.read_text())
        assert again["seconds"] > 0.0 and again["data"] == told["data"]


def test_an_interrupted_run_leaves_a_report_that_says_so(tmp_path: Path) -> None:
    """Ctrl-C ends the section at work, which is marked; what was whole before is in the report, and the rest is named."""
    command = [sys.executable, str(SCRIPT), "--quick", "--out", str(tmp_path)]
    command += only(("table-two", "engines", "proofs"))
    # Whoever runs the tests in the background of a shell ignores the signal, and so would the script.
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as process:
        while process.poll() is None and not (tmp_path / "data" / "table-two.json").exists():
            sleep(0.02)
        os.kill(process.pid, signal.SIGINT)
        _, error = process.communicate(timeout=120)
    assert process.returncode == 130, error
    assert "Traceback" not in error
    told = {path.stem: json.loads(path.read_text()) for path in (tmp_path / "data").glob("*.json")}
    assert told["table-two"]["complete"]
    partial = [name for name, one in told.items() if not one["complete"]]
    assert len(partial) == 1 and told[partial[0]]["reason"] == "interrupted"
    words = (tmp_path / "report.html").read_text()
    assert "Incomplete." in words and partial[0] in words and "Not measured:" in words
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")
