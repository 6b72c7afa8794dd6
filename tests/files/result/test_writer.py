"""The result file: what is written can be read, says the same, and a damaged file is refused in one sentence."""

from __future__ import annotations

import copy
import io
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest

import check_toolkit
from fakes import fake_proof, fake_result
from workhold import Tolerance, Vise, design, load
from workhold.errors import InputError
from workhold.files.result import fixture_text
from workhold.files.result.reader import read_result
from workhold.files.result.writer import write_result, write_result_text
from workhold.files.toolkit_file import load_preset
from workhold.model.fixture_table import FixtureTable
from workhold.model.notes import Remark
from workhold.model.search_report import UndecidedCandidate


@pytest.fixture
def document(tmp_path: Path) -> dict[str, Any]:
    """A result file of five fixtures, parsed."""
    write_result(fake_result(5), tmp_path / "r.json")
    data: dict[str, Any] = json.loads((tmp_path / "r.json").read_text())
    return data


@pytest.mark.thorough
@pytest.mark.parametrize("count", [0, 1, 7, 4096, 5000])
def test_writing_what_was_read_gives_the_same_bytes(tmp_path: Path, count: int) -> None:
    result = fake_result(count, notes=("remark ä",), complete=False)
    result = attrs.evolve(result, query=attrs.evolve(result.query, contact_margin=0.25))
    write_result(result, tmp_path / "a.json")
    again = read_result(tmp_path / "a.json")
    write_result(again, tmp_path / "b.json")
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()
    assert again.counts == result.counts
    assert (again.found, again.distinct) == (result.found, result.distinct)
    assert (again.complete, again.notes) == (False, (Remark("remark ä"),))
    assert again.query == result.query


@pytest.mark.parametrize("types", [("I",), ("II",), ("I", "II")])
def test_the_types_asked_for_survive_and_bound_what_is_listed(tmp_path: Path, types: tuple[str, ...]) -> None:
    """A file that says for which types it was asked says so when written again, and may list no other."""
    result = fake_result(6)
    query, names = attrs.evolve(result.query, types=types), [fixture.type for fixture in result]
    write_result(attrs.evolve(result, query=query), tmp_path / "a.json")
    assert json.loads((tmp_path / "a.json").read_text())["types"] == list(types)
    strange = [number for number, name in enumerate(names, 1) if name not in types]
    if strange:
        with pytest.raises(InputError, match=f"fixture {strange[0]} is of a type that was not asked for"):
            read_result(tmp_path / "a.json")
        table = result.table.take(np.array([name in types for name in names]))
        write_result(attrs.evolve(result, query=query, table=table), tmp_path / "a.json")
    assert read_result(tmp_path / "a.json").query == query


def test_numbers_survive_within_their_rounding(tmp_path: Path) -> None:
    result = fake_result(500)
    write_result(result, tmp_path / "a.json")
    table, again = result.table, read_result(tmp_path / "a.json").table
    for name in ("arrangement", "column", "row", "face"):
        np.testing.assert_array_equal(getattr(again, name), getattr(table, name))
    np.testing.assert_allclose(again.theta, table.theta, rtol=0, atol=2e-12)
    np.testing.assert_allclose(again.position, table.position, rtol=0, atol=6e-10)
    np.testing.assert_allclose(again.jaw_separation, table.jaw_separation, rtol=0, atol=6e-10)
    np.testing.assert_allclose(again.force, table.force, rtol=1e-11)
    np.testing.assert_allclose(again.null_vector, table.null_vector, rtol=1e-10)


def test_the_file_says_what_the_fixture_objects_say(tmp_path: Path) -> None:
    result = fake_result(40)
    write_result(result, tmp_path / "a.json")
    listed = json.loads((tmp_path / "a.json").read_text())["fixtures"]
    for fixture, entry in zip(result, listed, strict=True):
        assert entry["type"] == fixture.type
        assert entry["pose"] == pytest.approx(attrs.asdict(fixture.pose), abs=1e-9)
        assert entry["jaw_separation"] == pytest.approx(fixture.travel, abs=1e-9)
        assert entry["quality"] == pytest.approx(dict(fixture.quality))
        for peg, expected in zip(entry["pegs"], fixture.pegs, strict=True):
            assert list(peg) == ["jaw", "column", "row", "x", "y", "segment", "force"]
            peg["face"] = peg.pop("segment")
            peg["carrier"] = peg.pop("jaw")
            entries = attrs.asdict(expected).items()
            expected_entry = {
                name: value for name, value in entries if name not in ("place", "beside", "flat_deg")
            }
            assert peg == pytest.approx(expected_entry, abs=1e-8)


def test_one_fixture_stands_on_one_line(tmp_path: Path) -> None:
    write_result(fake_result(9), tmp_path / "a.json")
    lines = (tmp_path / "a.json").read_text().splitlines()
    assert sum(line.startswith('{"type"') for line in lines) == 9


def test_no_negative_zero_and_no_full_turn_is_written() -> None:
    result = fake_result(1)
    table = attrs.evolve(
        result.table,
        theta=np.array([2 * np.pi - 1e-15]),
        position=np.array([[-1e-13, -0.0]]),
        arrangement=np.array([0], np.int8),
    )
    stream = io.StringIO()
    stream.writelines(write_result_text(attrs.evolve(result, table=table)))
    assert '"pose": {"theta_deg": 0.0, "x": 0.0, "y": 0.0}' in stream.getvalue()
    assert "-0.0" not in stream.getvalue().replace("-0.0]", "")


@pytest.mark.thorough
def test_fixtures_become_objects_a_block_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    sizes: list[int] = []
    take = FixtureTable.take

    def recorded(self: FixtureTable, order: Any) -> FixtureTable:
        sizes.append(order.stop - order.start)
        return take(self, order)

    monkeypatch.setattr(FixtureTable, "take", recorded)
    io.StringIO().writelines(write_result_text(fake_result(9000)))
    assert sizes == [fixture_text.BLOCK] * 3


def test_any_layout_of_the_same_json_is_read(tmp_path: Path, document: dict[str, Any]) -> None:
    write_result(fake_result(5), tmp_path / "a.json")
    for number, text in enumerate(
        (json.dumps(document), json.dumps(document, indent=1), json.dumps(document, indent=4))
    ):
        path = tmp_path / f"{number}.json"
        path.write_text(text)
        write_result(read_result(path), tmp_path / "b.json")
        assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()


def test_the_keys_of_the_model_are_enough(tmp_path: Path, document: dict[str, Any]) -> None:
    for key in ("types", "contact_margin", "found", "distinct", "complete", "notes"):
        del document[key]
    for fixture in document["fixtures"]:
        fixture["quality"] = {}
        fixture["remark"] = "further keys are allowed"
        fixture["pegs"].reverse()
    (tmp_path / "a.json").write_text(json.dumps(document))
    result = read_result(tmp_path / "a.json")
    assert result.complete
    assert result.query.types == ("I", "II")
    assert result.found == result.counts
    assert all(
        fixture.pegs[0].carrier == "left" and fixture.pegs[-1].carrier == "right" for fixture in result
    )
    np.testing.assert_allclose(result.table.null_vector.sum(axis=1), 1)


def test_an_error_on_the_way_leaves_the_earlier_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.json"
    path.write_text("old")

    def broken(*_: object) -> object:
        raise MemoryError

    monkeypatch.setattr(fixture_text, "round_to_steps", broken)
    with pytest.raises(MemoryError):
        write_result(fake_result(3), path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


Damage = Callable[[dict[str, Any]], object]

DAMAGED: list[tuple[Damage, str]] = [
    (lambda d: d.pop("vise"), "the key vise is missing"),
    (lambda d: d.pop("format"), "the key format is missing"),
    (lambda d: d.update(format="workhold-result/9"), "format cannot be used"),
    (lambda d: d.pop("fixtures"), "no list of fixtures"),
    (lambda d: d.update(fixtures={}), "no list of fixtures"),
    (lambda d: d["workpiece"].update(units="inch"), "workpiece.units cannot be used"),
    (lambda d: d["workpiece"]["loops"][0][1].pop(), "loop 0 is not a list"),
    (
        lambda d: d["workpiece"]["loops"][0][1].__setitem__(0, "x"),
        r"workpiece\.loops\.0\.1\.0 cannot be used",
    ),
    (lambda d: d["vise"].update(pitch=[10]), r"vise\.pitch cannot be used"),
    (lambda d: d["vise"].update(pitch=[-10, 10]), "pitch -10"),
    (lambda d: d["vise"].update(columns=2.5), r"vise\.columns cannot be used"),
    (lambda d: d["vise"].update(columns=1), "has a peg in a column beyond the 1 of the left jaw"),
    (lambda d: d["vise"].update(rows=1), "has a peg in a row beyond the 1 of the left jaw"),
    (lambda d: d["counts"].update(I=99), "counts say 99 fixtures of type I"),
    (lambda d: d["counts"].pop("II"), "counts does not give a number for each of the types I, II"),
    (lambda d: d["fixtures"][2].pop("pose"), "fixture 3 has no key 'pose'"),
    (lambda d: d["fixtures"][2]["pegs"].pop(), "fixture 3 cannot be used: it does not have four pegs"),
    (lambda d: d["fixtures"][2].update(type="III"), "fixture 3 cannot be used: its type is not I or II"),
    (
        lambda d: d["fixtures"][1]["pegs"][0].update(jaw="upper"),
        "fixture 2 cannot be used: a peg's jaw is not left or right",
    ),
    (lambda d: d["fixtures"][1]["pegs"][0].update(jaw=[]), "fixture 2 cannot be used"),
    (
        lambda d: d["fixtures"][1]["pegs"][3].update(jaw="left"),
        "fixture 2 does not have the pegs of its type",
    ),
    (
        lambda d: d["fixtures"][1]["pegs"][0].update(row=1.5),
        "fixture 2 cannot be used: .* is not a whole number",
    ),
    (
        lambda d: d["fixtures"][1]["pegs"][0].update(row=True),
        "fixture 2 cannot be used: .* is not a whole number",
    ),
    (lambda d: d["fixtures"][1]["pegs"][0].update(row=-1), "fixture 2 cannot be used: .* is negative"),
    (lambda d: d["fixtures"][1]["pegs"][0].update(row=10**400), "a number with 401 digits"),
    (
        lambda d: d["fixtures"][1]["pegs"][0].update(x="1"),
        "fixture 2 cannot be used: .* is not a finite number",
    ),
    (lambda d: d["fixtures"][1]["pegs"][0].update(x=10**400), "a number with 401 digits"),
    (lambda d: d["fixtures"][1]["pegs"][0].update(y=1e400), "not a result file: Infinity is not a number"),
    (lambda d: d["fixtures"][1]["pegs"][0].update(y=float("nan")), "not a result file: NaN is not a number"),
    (
        lambda d: d["fixtures"][1]["pegs"][0].update(y=0.123),
        "fixture 2 has a peg whose x, y are not those of its hole",
    ),
    (
        lambda d: d["fixtures"][1]["pegs"][0].update(segment=77),
        "fixture 2 has a peg on a segment that does not name",
    ),
    (
        lambda d: d["fixtures"][1]["pegs"][0].update(force=0),
        "fixture 2 has a peg whose force is not positive",
    ),
    (lambda d: d["fixtures"][4].update(quality=[]), "fixture 5 cannot be used"),
    (lambda d: d["fixtures"].__setitem__(0, None), "fixture 1 cannot be used"),
    (lambda d: d["fixtures"].__setitem__(0, []), "fixture 1 cannot be used"),
]


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("damage", "message"), DAMAGED)
def test_a_damaged_file_is_refused_with_its_place(
    tmp_path: Path, document: dict[str, Any], damage: Damage, message: str
) -> None:
    damaged = copy.deepcopy(document)
    damage(damaged)
    (tmp_path / "d.json").write_text(json.dumps(damaged))
    with pytest.raises(InputError, match=message) as caught:
        read_result(tmp_path / "d.json")
    assert "\n" not in str(caught.value)
    assert str(caught.value).endswith(".")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is empty"),
        (b"  \n", "is empty"),
        (b"\x00\xff\xfe\x80", "is not text"),
        (b"hello", "not valid JSON: expecting value at line 1, column 1"),
        (b"[1, 2]", "no list of fixtures"),
        (b"3", "no list of fixtures"),
        (b"[" * 100_000, "nested too deeply"),
        (b'{"fixtures": []}', "the key format is missing"),
    ],
)
def test_what_is_no_result_file_is_refused(tmp_path: Path, content: bytes, message: str) -> None:
    (tmp_path / "d.json").write_bytes(content)
    with pytest.raises(InputError, match=re.escape(message)):
        read_result(tmp_path / "d.json")


def test_every_truncation_is_refused(tmp_path: Path) -> None:
    write_result(fake_result(3), tmp_path / "a.json")
    whole = (tmp_path / "a.json").read_bytes()
    for length in range(0, len(whole) - 3, 41):
        (tmp_path / "t.json").write_bytes(whole[:length])
        with pytest.raises(InputError):
            read_result(tmp_path / "t.json")


def test_the_account_of_the_search_survives_the_round_trip(tmp_path: Path) -> None:
    """``proof`` is written key for key as documented and read back as the same object."""
    result = fake_result(3, proof=fake_proof(2))
    write_result(result, tmp_path / "a.json")
    assert json.loads((tmp_path / "a.json").read_text())["proof"] == {
        "cells": 288,
        "candidates": 82_766,
        "discarded_by_bound": 81_440,
        "verified": 1324,
        "escalated": 34,
        "undecided": [
            {
                "type": kind,
                "segments": [0, 1, 2, 4],
                "columns": [0, 1, 0, -k],
                "rows": [0, -3, 1, k],
                "theta_deg": 7.25 * k,
                "reach_deg": None,
                "reason": f"reason {k}",
            }
            for k, kind in enumerate(("I", "II"))
        ],
    }
    again = read_result(tmp_path / "a.json")
    assert again.proof == result.proof
    write_result(again, tmp_path / "b.json")
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()


def test_a_file_may_come_without_an_account(tmp_path: Path, document: dict[str, Any]) -> None:
    assert "proof" not in document
    for data in (document, document | {"proof": None}):
        (tmp_path / "a.json").write_text(json.dumps(data))
        assert read_result(tmp_path / "a.json").proof is None


@pytest.mark.parametrize("angle", [360.0, -1e-14, 359.99999999999])
def test_an_undecided_orientation_is_written_below_a_whole_turn(tmp_path: Path, angle: float) -> None:
    lost = UndecidedCandidate("I", (0, 1, 2, 4), (0, 1, 0, 1), (0, 0, 1, 1), angle, "reason")
    proof = attrs.evolve(fake_proof(1), undecided=(lost,))
    write_result(fake_result(1, proof=proof), tmp_path / "a.json")
    again = read_result(tmp_path / "a.json").proof
    assert again is not None
    assert again.undecided[0].theta_deg == 0.0


DAMAGED_PROOFS: list[tuple[Damage, str]] = [
    (lambda p: p.pop("cells"), r"the key proof\.cells is missing"),
    (lambda p: p.pop("undecided"), r"the key proof\.undecided is missing"),
    (lambda p: p.update(cells=-1), r"proof\.cells cannot be used"),
    (lambda p: p.update(verified=1.5), r"proof\.verified cannot be used"),
    (lambda p: p.update(escalated=True), r"proof\.escalated cannot be used"),
    (lambda p: p.update(candidates="82766"), r"proof\.candidates cannot be used"),
    (
        lambda p: p.update(candidates=82_767),
        "says 82767 candidates, but 82766 are discarded, verified or undecided",
    ),
    (
        lambda p: p.update(undecided=[]),
        "says 82766 candidates, but 82764 are discarded, verified or undecided",
    ),
    (lambda p: p.update(undecided={}), r"proof\.undecided cannot be used"),
    (lambda p: p["undecided"][1].pop("reason"), r"the key proof\.undecided\.1\.reason is missing"),
    (lambda p: p["undecided"][1].update(reason=""), r"proof\.undecided\.1\.reason cannot be used"),
    (
        lambda p: p["undecided"][1].update(type="III"),
        "undecided candidate 2 of the proof is not of type I or II",
    ),
    (lambda p: p["undecided"][1]["rows"].pop(), r"proof\.undecided\.1\.rows cannot be used"),
    (lambda p: p["undecided"][1]["columns"].append(0), r"proof\.undecided\.1\.columns cannot be used"),
    (lambda p: p["undecided"][0].update(theta_deg=360), r"proof\.undecided\.0\.theta_deg cannot be used"),
    (
        lambda p: p["undecided"][1]["segments"].__setitem__(0, 77),
        "undecided candidate 2 .* names a segment that is not a face",
    ),
]


@pytest.mark.parametrize(("damage", "message"), DAMAGED_PROOFS)
def test_a_damaged_account_is_refused_with_its_place(tmp_path: Path, damage: Damage, message: str) -> None:
    write_result(fake_result(3, proof=fake_proof(2)), tmp_path / "d.json")
    data = json.loads((tmp_path / "d.json").read_text())
    damage(data["proof"])
    (tmp_path / "d.json").write_text(json.dumps(data))
    with pytest.raises(InputError, match=message) as caught:
        read_result(tmp_path / "d.json")
    assert "\n" not in str(caught.value)
    assert str(caught.value).endswith(".")
    assert str(caught.value).count(". ") == 0


@pytest.mark.parametrize("account", [3, [], "proof", True])
def test_what_is_no_account_is_refused(tmp_path: Path, document: dict[str, Any], account: object) -> None:
    (tmp_path / "d.json").write_text(json.dumps(document | {"proof": account}))
    with pytest.raises(InputError, match="proof cannot be used"):
        read_result(tmp_path / "d.json")


@pytest.mark.thorough
def test_the_bytes_do_not_depend_on_the_threads(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The account's counts, and everything else, are the same on any number of threads; the independent checker, which
    knows nothing of the account, reads the file all the same."""
    part, vise = load("small4Handle"), Vise(pitch=10, columns=2, peg_radius=3)
    files = []
    for threads in (1, 2, 5):
        result = design(part, vise, threads=threads)
        assert result.proof is not None
        assert result.proof.candidates > result.proof.verified > 0
        files.append(tmp_path / f"{threads}.json")
        write_result(result, files[-1])
    assert len({path.read_bytes() for path in files}) == 1
    monkeypatch.setattr("sys.argv", ["check_toolkit.py", str(files[0])])
    with pytest.raises(SystemExit) as ended:
        check_toolkit.main()
    assert ended.value.code == 0
    assert capsys.readouterr().out.endswith(" fixtures, 0 faulty\n")


def test_missing_files_and_folders_are_refused(tmp_path: Path) -> None:
    for path, words in ((tmp_path, "is not a file"), (tmp_path / "none.json", "cannot be read")):
        with pytest.raises(InputError, match=words):
            read_result(path)


def test_statistics_survive_the_round_trip(tmp_path: Path) -> None:
    result = design(load("small4Handle"), Vise(pitch=10, columns=10, peg_radius=3), types=["I"])
    write_result(result, tmp_path / "a.json")
    again = read_result(tmp_path / "a.json")
    assert again.statistics == result.statistics
    write_result(again, tmp_path / "b.json")
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()


def test_the_fit_of_the_dowels_survives_the_round_trip(tmp_path: Path) -> None:
    """What a named vise says of its pins and their holes is what the sheet of the result tells; None stays None."""
    for fit in (load_preset("plate-20mm").tolerance.fit, None):
        result = fake_result(2)
        result = attrs.evolve(
            result, query=attrs.evolve(result.query, tolerance=Tolerance(0.0145, 0.02, fit))
        )
        write_result(result, tmp_path / "r.json")
        assert read_result(tmp_path / "r.json").query.tolerance == result.query.tolerance
