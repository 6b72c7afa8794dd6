"""Files that are not results are refused in one sentence that says why."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import attrs
import pytest

from workhold import InputError, Result, save
from workhold.verification import verify_file
from workhold.verification.listing import read_listing

Data = dict[str, Any]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is empty"),
        (b"{", "not valid JSON"),
        (b"[1, 2]", "not a result file"),
        (b'{"format": "workhold-result/9", "fixtures": []}', "format cannot be used"),
        (b"\xff\xfe\x00", "it is not text"),
        (b"[" * 100_000, "nested too deeply"),
        (b'{"format": NaN}', "NaN is not a number"),
    ],
)
def test_files_of_another_kind(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "r.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        verify_file(path)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read: No such file"):
        verify_file(tmp_path / "r.json")


def peg(data: Data) -> Data:
    found: Data = data["fixtures"][1]["pegs"][2]
    return found


EDITS: list[tuple[Callable[[Data], object], str]] = [
    (lambda data: data.pop("workpiece"), "the key workpiece is missing"),
    (lambda data: data.pop("fixtures"), "has no list of fixtures"),
    (lambda data: data.pop("counts"), "the key counts is missing"),
    (lambda data: data["counts"].update(I=1.5), "counts.I cannot be used"),
    (lambda data: data["workpiece"].update(units="inch"), "units cannot be used"),
    (lambda data: data["workpiece"].update(loops=[]), "has no loop"),
    (lambda data: data["workpiece"]["loops"][0].append(data["workpiece"]["loops"][0][-1]), "has zero length"),
    (lambda data: data["vise"].update(pitch=[8]), "vise.pitch cannot be used"),
    (lambda data: data["vise"].update(pitch=[8, "x"]), "vise.pitch.1 cannot be used"),
    (lambda data: data["vise"].update(peg_radius=5), "overlap in neighbouring holes"),
    (lambda data: data["vise"].pop("columns"), "the key vise.columns is missing"),
    (lambda data: data.update(contact_margin=-1), "contact margin -1 is not a length"),
    (lambda data: data["fixtures"].append(3), "number 13 in fixtures: it is not a fixture"),
    (lambda data: data["fixtures"][1].pop("pose"), "number 2 in fixtures: it has no pose"),
    (lambda data: data["fixtures"][1]["pegs"].pop(), "number 2 in fixtures: it does not have four pegs"),
    (lambda data: data["fixtures"][1].update(type="III"), "its type is not I or II"),
    (lambda data: data["fixtures"][1].update(quality=[]), "it has no quality"),
    (lambda data: peg(data).update(jaw="middle"), "a peg's jaw is not left or right"),
    (lambda data: peg(data).update(row=1.0), "row is 1.0, not a whole number"),
    (lambda data: peg(data).update(row=True), "row is True, not a whole number"),
    (lambda data: peg(data).update(row=10**30), "not a whole number"),
    (lambda data: peg(data).update(x="far"), "x is 'far', not a number"),
    (lambda data: peg(data).update(x=10**400), "a number with 401 digits"),
    (lambda data: peg(data).pop("force"), "the key force is missing"),
    (lambda data: data["fixtures"][0]["pose"].pop("x"), "number 1 in fixtures: the key x is missing"),
]


@pytest.mark.parametrize(("edit", "message"), EDITS, ids=[message for _, message in EDITS])
def test_files_with_something_unusable(
    widget_data: Data, tmp_path: Path, edit: Callable[[Data], object], message: str
) -> None:
    data = copy.deepcopy(widget_data)
    edit(data)
    path = tmp_path / "r.json"
    path.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(InputError, match=message) as caught:
        verify_file(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)
    assert str(caught.value).endswith(".")
    assert not str(caught.value).endswith("..")


def test_further_keys_and_other_layouts_do_no_harm(widget_data: Data, tmp_path: Path) -> None:
    data = copy.deepcopy(widget_data)
    data["note"] = {"x": 3}
    data["fixtures"][0]["quality"]["more"] = {"unit": "mm"}
    data["fixtures"][0]["pegs"][0]["label"] = "A1"
    path = tmp_path / "r.json"
    path.write_text(json.dumps(data, indent=3), encoding="utf-8")
    assert verify_file(path).proven == 12


def test_a_key_given_twice_is_refused(widget_result: Result, tmp_path: Path) -> None:
    """As in every file that is read: of two values one would be proven and the other one shown."""
    path = tmp_path / "r.json"
    save(widget_result, path)
    text = path.read_text(encoding="utf-8")
    for twice in (
        '"counts": {"I": 0, "II": 0}, "counts"',
        '"complete": false, "complete"',
        '"force": 1, "force"',
    ):
        key = twice.rpartition(" ")[2]
        path.write_text(text.replace(key, twice, 1), encoding="utf-8")
        with pytest.raises(InputError, match="is given twice"):
            verify_file(path)


def test_every_number_is_kept_as_written(widget_data: Data, tmp_path: Path) -> None:
    path = tmp_path / "r.json"
    path.write_text(json.dumps(widget_data), encoding="utf-8")
    listing = read_listing(path)
    for fixture, written in zip(listing.fixtures, widget_data["fixtures"], strict=True):
        assert fixture.travel == written["jaw_separation"]
        assert fixture.quality == written["quality"]
        for peg_read, peg_written in zip(fixture.pegs, written["pegs"], strict=True):
            names = {"segment": "face", "jaw": "carrier"}
            expected = {names.get(key, key): value for key, value in peg_written.items()}
            assert attrs.asdict(peg_read) == expected | {"place": None, "beside": None, "flat_deg": None}
