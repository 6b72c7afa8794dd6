"""The manifest, the schemas and the pages agree with the files, and with what a grid search finds in truth."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from benchmark.forgeries import FORGERIES, MANIFEST_ONLY
from workhold import answer
from workhold.benchmark.catalogue import load_manifest, load_sets, make_set_query, read_benchmark_file
from workhold.benchmark.matching import ListedPlaces, compare_places, read_entered_fixture

Content = Callable[[str], dict[str, Any]]
ROOT = Path(__file__).resolve().parents[2]


def script(name: str) -> Any:
    """A module of the benchmarks' folder."""
    sys.path.insert(0, str(ROOT / "benchmarks"))
    try:
        return import_module(name)
    finally:
        sys.path.remove(str(ROOT / "benchmarks"))


def test_there_are_workpieces_and_sets_enough() -> None:
    """Sixty workpieces or more, each in a set, with its reason, source and licence; every kind of toolkit."""
    known = load_manifest()["workpieces"]
    assert len(known) >= 60
    assert {one.part for one in load_sets()} == set(known)
    assert all(part[key] for part in known.values() for key in ("family", "reason", "source", "licence"))
    kinds = {(one.toolkit["kind"], one.toolkit.get("clamps", 1)) for one in load_sets()}
    assert len(kinds) == 7
    assert len({one.name for one in load_sets()}) == len(load_sets())


@pytest.mark.thorough
def test_the_workpieces_are_those_of_the_manifest() -> None:
    """Every file has its checksum, and is read."""
    for name, part in load_manifest()["workpieces"].items():
        assert sha256(read_benchmark_file(f"parts/{name}.json")).hexdigest() == part["sha256"]
    for entry in load_sets():
        assert make_set_query(entry).workpiece.name == entry.part


def test_the_data_are_small() -> None:
    """Lists are made, not shipped: all together is far below three million bytes."""
    home = ROOT / "src" / "workhold" / "data" / "benchmark"
    assert sum(path.stat().st_size for path in home.rglob("*.json")) < 1_000_000


@pytest.mark.thorough
@pytest.mark.parametrize(
    "name", ["kite-vise", "bar-plate", "bar-pair", "el-fence", "el-fence-pair", "house-flat-opening"]
)
def test_the_schemas_describe_the_files(name: str, content: Content) -> None:
    """A set of every kind is valid, also as another program's entry, and what is forged is not."""
    jsonschema = pytest.importorskip("jsonschema")
    schema, entry = (json.loads(read_benchmark_file(f"{one}.schema.json")) for one in ("set", "entry"))
    made = content(name)
    made["fixtures"] = made["fixtures"][:50]
    jsonschema.validate(made, schema)
    jsonschema.validate(made, entry)
    del made["fixtures"][0]["pose"]
    for one in (schema, entry):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(made, one)


@pytest.mark.thorough
def test_a_set_made_today_is_the_one_of_the_manifest() -> None:
    """Counts of some sets of every family are those of a search."""
    for entry in load_sets()[::16]:
        if entry.size < 1000:
            assert answer(make_set_query(entry), threads=1).counts == dict(entry.counts), entry.name


def test_the_pages_have_the_figures_of_their_data() -> None:
    """The tables of both pages are those that their data files make."""
    pages = script("tables_of_pages")
    for name in pages.PAGES:
        text = (ROOT / "docs" / name).read_text(encoding="utf-8")
        assert pages.filled(name, text) == text
        assert "|---|" in text


def test_the_datasheet_counts_what_there_is() -> None:
    """Sets, workpieces and fixtures are counted as the manifest has them."""
    page = (ROOT / "docs" / "benchmark.md").read_text(encoding="utf-8")
    assert f"{len(load_sets())} sets" in page
    assert f"{len(load_manifest()['workpieces'])} workpieces" in page
    assert f"refuses {len(FORGERIES) + len(MANIFEST_ONLY)} kinds of forged files" in page
    for kind, clamps in (("vise", 1), ("edge", 1), ("flat-jaw", 1), ("opening-vise", 1)):
        of = [e for e in load_sets() if e.toolkit["kind"] == kind and e.toolkit.get("clamps", 1) == clamps]
        total, empty = sum(e.size for e in of), sum(e.size == 0 for e in of)
        assert f"| {len(of)} | {total:,} | {empty} |" in page


@pytest.mark.thorough
def test_the_share_of_a_grid_is_what_its_program_finds(tmp_path: Path, content: Content) -> None:
    """The naive program of the examples finds just as many as are worked out for its grid."""
    path = tmp_path / "bar-plate.json"
    path.write_text(json.dumps(content("bar-plate")))
    program = ROOT / "examples" / "grid_search.py"
    words = [sys.executable, str(program), str(path), "--step", "2", "--degrees", "2", "--touch", "0.4"]
    mine = json.loads(subprocess.run(words, capture_output=True, check=True, text=True).stdout)
    query = next(make_set_query(one) for one in load_sets() if one.name == "bar-plate")
    complete, theirs = (
        ListedPlaces(query.workpiece, [read_entered_fixture(one) for one in several])
        for several in (content("bar-plate")["fixtures"], mine["fixtures"])
    )
    outcome = compare_places(complete, theirs, 2.0, symmetric=False)
    met = script("grid_share").met(query, answer(query, threads=1).table, 2.0, 0.4)
    assert 0 < int(met.sum()) < 60
    assert len(outcome.found) == int(met.sum())
