"""Complete sets: the same triples with the same figures as an independent enumeration has them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from attrs import evolve

from supports.cases import NAMES, case
from workhold.errors import InputError
from workhold.files.supports_file import read_supports, write_supports
from workhold.files.supports_forms import ReadTriple, TripleReader, read_supports_part
from workhold.supports.listing import find_supports
from workhold.verification.supports import verify_supports_file

CHECKER = Path(__file__).parents[1] / "check_supports.py"


def named(triple):
    return tuple((one.carrier, one.column, one.row) for one in triple.supports)


@pytest.mark.parametrize("name", NAMES)
def test_all_triples_of_the_complete_set_and_no_others(name):
    one = case(name)
    found = find_supports(one.fixture, one.query, one.request, one.loads, one.jaw_force)
    known = {tuple(map(tuple, row["holes"])): row for row in one.truth["triples"]}
    assert {named(triple) for triple in found.triples} == set(known)
    assert found.count == one.truth["counts"]["triples"]
    assert found.positions == one.truth["counts"]["positions"]
    for triple in found.triples:
        row = known[named(triple)]
        assert triple.travel == pytest.approx(row["jaw_separation"], abs=1e-9)
        assert (triple.standing, triple.overhang, triple.arm) == pytest.approx(
            (row["standing"], row["overhang"], row["arm"]), rel=1e-6, abs=1e-6
        )
        assert triple.best.clamp_needed == pytest.approx(row["best"]["clamp_needed"], rel=1e-6, abs=1e-6)
        assert triple.best.support_force == pytest.approx(row["best"]["support_force"], rel=1e-5, abs=1e-6)
        assert (triple.given is None) == (row["given"] is None)
        for key, value in (row["given"] or {}).items():
            assert getattr(triple.given, key) == pytest.approx(value, rel=1e-9, abs=1e-9), key


@pytest.mark.parametrize("name", NAMES)
def test_the_jaw_force_needed_is_that_of_the_plane(name):
    one = case(name)
    found = find_supports(one.fixture, one.query, one.request, one.loads, best=1)
    assert found.jaw_force == pytest.approx(one.truth["jaw_needed"], rel=1e-9)


@pytest.mark.thinned(4)
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("is_fixed", [True, False])
@pytest.mark.parametrize("is_loaded", [True, False])
def test_the_best_few_are_the_first_of_all(name, is_fixed, is_loaded):
    one = case(name)
    request = one.request if is_fixed else evolve(one.request, point=None)
    loads = one.loads if is_loaded else ()
    everything = find_supports(one.fixture, one.query, request, loads, one.jaw_force)
    for count in (1, 3, 40):
        best = find_supports(one.fixture, one.query, request, loads, one.jaw_force, best=count)
        assert best.triples == everything.triples[:count]
        assert not best.complete


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", NAMES)
def test_a_file_is_read_back_and_both_judges_find_nothing(name, tmp_path):
    one = case(name)
    found = find_supports(one.fixture, one.query, one.request, one.loads, one.jaw_force)
    path, again = tmp_path / "supports.json", tmp_path / "again.json"
    write_supports(found, path)
    read = read_supports(path)
    assert (read.request, read.loads, read.count) == (found.request, found.loads, found.count)
    write_supports(read, again)
    assert path.read_bytes() == again.read_bytes()
    outcome = verify_supports_file(path)
    assert outcome.holds and outcome.proven == len(found.triples), outcome.unproven[:1]
    told = subprocess.run([sys.executable, CHECKER, path], capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stdout


@pytest.mark.parametrize("key", ["share", "lift", "arm", "clamp_needed", "support_force"])
def test_a_wrong_figure_is_refuted(key, tmp_path):
    one = case("bracketL")
    found = find_supports(one.fixture, one.query, one.request, one.loads, one.jaw_force, best=2)
    first = found.triples[0]
    wrong = evolve(first.best, **{key: getattr(first.best, key) * 1.001 + 1e-3})
    path = tmp_path / "supports.json"
    write_supports(evolve(found, triples=(evolve(first, best=wrong), *found.triples[1:])), path)
    outcome = verify_supports_file(path)
    assert (outcome.refuted, outcome.proven) == (1, 1)
    assert key in outcome.unproven[0].reason


@pytest.mark.thorough
def test_the_command_judges_a_file_of_supports(tmp_path):
    one = case("bracketL")
    found = find_supports(one.fixture, one.query, one.request, one.loads, one.jaw_force, best=2)
    path, command = tmp_path / "supports.json", [sys.executable, "-m", "workhold", "verify"]
    write_supports(found, path)
    good = subprocess.run([*command, path], capture_output=True, text=True, check=False)
    assert good.returncode == 0 and "2 triples of supports: 2 proven" in good.stdout, good.stderr
    write_supports(evolve(found, triples=(evolve(found.triples[0], standing=1.0),)), path)
    bad = subprocess.run([*command, path], capture_output=True, text=True, check=False)
    assert bad.returncode == 2 and "Triple 1 is refuted: standing" in bad.stdout, bad.stderr


@pytest.mark.parametrize(
    ("before", "after", "place"),
    [
        ('"share": ', '"share": "x", "was": ', "triples.1.best.share"),
        ('"standing": ', '"stand": ', "triples.1.standing"),
    ],
)
def test_triples_are_checked_one_by_one_as_they_are_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, before: str, after: str, place: str
) -> None:
    """They never lie in memory all at once as they are written; what is wrong of one is named with its place."""
    one = case("bracketL")
    found = find_supports(one.fixture, one.query, one.request, one.loads, one.jaw_force, best=3)
    path = tmp_path / "supports.json"
    write_supports(found, path)
    forms = []
    usual = TripleReader.read_triple
    monkeypatch.setattr(
        TripleReader, "read_triple", lambda self, entry: (forms.append(self.count), usual(self, entry))[1]
    )
    assert all(isinstance(triple, ReadTriple) for triple in read_supports_part(path).triples)
    assert forms == [0, 1, 2]
    head, first, second, *rest = path.read_text().split('\n{"holes"')
    path.write_text('\n{"holes"'.join([head, first, second.replace(before, after, 1), *rest]))
    with pytest.raises(InputError, match=f"not a complete file of supports: {place} cannot be used"):
        read_supports(path)
