"""A few bytes never ask for all memory: what is too large is refused in one sentence, the same for every way in.

Inputs are tried in a process of its own with little address space and a time limit, so that a failure stays there.
"""

from __future__ import annotations

import errno
import json
import resource
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import attrs
import numpy as np
import pytest

from workhold import Vise, Workpiece, answer, limits, load
from workhold.cli.values import read_optional_force
from workhold.errors import InputError, lacks_memory, list_causes
from workhold.files.part.load import read_workpiece
from workhold.limits import choose_thread_count
from workhold.model.query import Query
from workhold.model.requirements import Load, Tolerance
from workhold.statics.loads import compute_load_cases
from workhold.web.worker import explain_task_error

Loops = list[list[list[float]]]
PLATE: list[list[float]] = [[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]
HOLE: list[list[float]] = [[20, 20, 1], [30, 20, 1]]
VISE: dict[str, object] = {"pitch": 10, "columns": 2, "peg_radius": 2}
ADDRESS_SPACE = 3 << 30
SECONDS = 600


@pytest.mark.parametrize("needed", [160_000_000, 1_000_400_000, 999_999_999])
def test_the_address_space_that_is_named_is_enough(needed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    limited = needed // 2
    monkeypatch.setattr(resource, "getrlimit", lambda kind: (limited, limited))
    with pytest.raises(InputError, match=r"takes [\d,]+ MB") as told:
        limits.refuse_little_space(needed, "this", "raise the limit")
    limited = int(str(told.value).split("takes ")[1].split(" MB")[0].replace(",", "")) * 10**6
    limits.refuse_little_space(needed, "this", "raise the limit")


def with_bulge(bulge: float) -> Loops:
    """The plate with a hole, one edge of it bent."""
    return [[[0, 0, bulge], *PLATE[1:]], HOLE]


def moved(by: float) -> Loops:
    """The plate, moved."""
    return [[[x + by, y, b] for x, y, b in PLATE]]


def times(factor: float) -> Loops:
    """The plate, scaled."""
    return [[[x * factor, y * factor, b] for x, y, b in PLATE]]


TRYING = """
import json, sys
from workhold import Workpiece, design
from workhold.contact.problem import Problem
from workhold.errors import InputError, lacks_memory
from workhold.model.requirements import Load
from workhold.model.query import Query
from workhold.model.requirements import Tolerance
from workhold.limits import choose_thread_count
from workhold.statics.loads import compute_load_cases
from workhold.files.input_forms import check_toolkit_entries
from workhold.files.toolkit_file import make_described_toolkit

for searched, loops, vise in json.load(sys.stdin):
    try:
        part = Workpiece.from_loops("part", loops)
        held = make_described_toolkit("vise", check_toolkit_entries({"unit": "mm", **vise})).toolkit
        print(len(design(part, held)) if searched else Problem.from_query(Query(part, held)))
    except InputError as error:
        print(error)
"""
REFUSED: list[tuple[Loops, dict[str, object], str]] = [
    (with_bulge(1e9), {}, "loop 0, segment 0 is an arc of radius 1.5e+10 mm (bulge 1e+09)"),
    (with_bulge(1e300), {}, "is an arc of radius"),
    ([[[0, 0, 2e-6], [18000, 0, 0], [0, 40, 0]]], {}, "is an arc of radius 2.25e+09 mm"),
    (moved(1e9), {}, "has a coordinate beyond 1e+06 mm"),
    (times(1e300), {}, "has a coordinate beyond 1e+06 mm"),
    (times(1e-300), {}, "has zero length"),
    ([PLATE], {"pitch": 1e-9, "peg_radius": 0}, "more than the 250,000"),
    ([PLATE], {"pitch": 1e-300, "peg_radius": 0}, "more than the 250,000"),
    ([PLATE], {"pitch": 1e300}, "pitch 1e+300 is beyond 1e+06 mm"),
    ([PLATE], {"columns": 10**12}, "a jaw of 1,000,000,000,000 holes is beyond the 25,000"),
    ([PLATE], {"columns": 10, "rows": 10**9}, "a jaw of 10,000,000,000 holes is beyond"),
    ([PLATE], {"row_offset": 1e300}, "row offset 1e+300 is beyond"),
    ([PLATE], {"blocked": ["L-A1"] * 20_001}, "20,001 blocked holes are more than the 20,000"),
]


def tried_apart(cases: Sequence[tuple[bool, Loops, dict[str, object]]]) -> list[str]:
    """What a process says of parts and vises that it makes ready for a search, or searches too."""
    done = subprocess.run(
        [sys.executable, "-c", TRYING],
        input=json.dumps([[searched, loops, VISE | vise] for searched, loops, vise in cases]),
        capture_output=True,
        text=True,
        timeout=SECONDS,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE)),
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@pytest.mark.thorough
def test_refused_in_one_sentence() -> None:
    said = tried_apart([(False, loops, vise) for loops, vise, _ in REFUSED])
    for (_, _, words), sentence in zip(REFUSED, said, strict=True):
        assert words in sentence


@pytest.mark.thorough
def test_what_lies_within_the_limits_is_designed() -> None:
    vises: list[dict[str, object]] = [{"columns": 25_000}, {"rows": 12_500}, {"max_opening": 1e6}]
    said = tried_apart([(True, [PLATE, HOLE], vise) for vise in vises])
    assert [int(count) > 0 for count in said] == [True] * len(vises)


@pytest.mark.parametrize("bulge", [1.9e-6, 3e-8, 1e-9, -1e-12, 1e-300])
def test_an_arc_that_is_nowhere_off_its_chord_is_a_line(tmp_path: Path, bulge: float) -> None:
    """Its middle is bulge times half the chord away from it."""
    straight, bent = (
        Workpiece.from_loops("plate", with_bulge(0.0)),
        Workpiece.from_loops("plate", with_bulge(bulge)),
    )
    assert [loop.tolist() for loop in bent.loops] == [loop.tolist() for loop in straight.loops]
    assert straight.remarks == ()
    said = "1 arc that is nowhere farther than 1e-06 mm, or a millionth of its length, from a line taken for one."
    assert bent.remarks == (said,)
    path = tmp_path / "plate.json"
    path.write_text(json.dumps({"units": "mm", "loops": with_bulge(bulge)}))
    assert read_workpiece(path).remarks == bent.remarks
    assert load(path).remarks == bent.remarks


def test_an_arc_with_a_sagitta_stays_one() -> None:
    part = Workpiece.from_loops("plate", with_bulge(2e-6))
    assert part.loops[0][0, 2] == 2e-6
    assert part.remarks == ()


def test_the_algebra_tells_when_it_is_asked_too_much(monkeypatch: pytest.MonkeyPatch) -> None:
    from workhold.algebra import candidates, find_fixtures_by_algebra

    monkeypatch.setattr(candidates, "MOST_PEG_PAIRS", 10)
    with pytest.raises(InputError, match="more than 10 ways"):
        find_fixtures_by_algebra(
            Query(Workpiece.from_loops("plate", [PLATE]), Vise(pitch=10, columns=2, peg_radius=2))
        )


def caused(cause: Exception) -> Exception:
    """An error that comes of another one."""
    error = ValueError("nothing to say of memory")
    error.__cause__ = cause
    return error


def test_the_causes_of_an_error_end_though_it_is_its_own() -> None:
    """Each is told once; what was being handled counts where that is asked for and nothing else is said."""
    first, second, third = ValueError("1"), ValueError("2"), ValueError("3")
    first.__cause__, second.__context__, third.__cause__ = second, third, first
    assert list(list_causes(None)) == []
    assert list(list_causes(first)) == [first, second]
    assert list(list_causes(first, or_context=True)) == [first, second, third]
    second.__cause__ = second
    assert list(list_causes(first, or_context=True)) == [first, second]


@pytest.mark.parametrize(
    ("error", "lacks"),
    [
        (MemoryError(), True),
        (OSError(errno.ENOMEM, "no"), True),
        (OSError(errno.ENOSPC, "no"), False),
        (RuntimeError("can't start new thread"), True),
        (ImportError("libx.so: failed to map segment from shared object"), True),
        (caused(ImportError("x: cannot allocate memory in static TLS block")), True),
        (caused(KeyError("x")), False),
    ],
)
def test_too_little_memory_is_known_by_what_libraries_say(error: Exception, lacks: bool) -> None:
    """On the command line, and to a client of the server, which is told no more."""
    assert lacks_memory(error) is lacks
    assert explain_task_error(error, 5 << 20).startswith("This needs more than the 5 MiB of memory") is lacks


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        (
            lambda: Load(points=[(0, 0)], force=1e308),
            "force 1e+308 is beyond 1e+09 N: check the number and its unit.",
        ),
        (lambda: Load(moment=-1.1e9), "moment -1.1e+09 is beyond 1e+09 N mm"),
        (lambda: Load(points=[(0, 0), (1, -2e6)], force=1), "a load's point -2e+06 is beyond 1e+06 mm"),
        (lambda: Tolerance(peg=1e300), "peg tolerance 1e+300 is beyond 1e+06 mm"),
        (
            lambda: Query(load("widget"), Vise(**VISE), contact_margin=1e300),
            "contact margin 1e+300 is beyond 1e+06 mm",
        ),  # type: ignore[arg-type]
        (lambda: Query(load("widget"), Vise(**VISE), jaw_force=1e300), "jaw force 1e+300 is beyond 1e+09 N"),  # type: ignore[arg-type]
        (lambda: load_cases_of(jaw_force=1e300), "jaw force 1e+300 is beyond 1e+09 N"),
        (lambda: load_cases_of(friction=1e300), "friction 1e+300 is beyond 100: give the coefficient"),
        (lambda: read_optional_force("--jaw-force", "1e9kN"), "--jaw-force 1e+12 is beyond 1e+09 N"),
        (lambda: choose_thread_count(1_001), "1,001 threads are more than the 1,000"),
    ],
)
def test_numbers_whose_products_are_none_are_refused(asked: Callable[[], object], words: str) -> None:
    """Before any reckoning with them warns of an overflow."""
    with pytest.raises(InputError) as caught:
        asked()
    assert str(caught.value).startswith(words)


def test_the_largest_load_is_answered_without_a_warning() -> None:
    """RuntimeWarnings are errors in tests."""
    loads = [Load([(1e6, -1e6)], 1e9, moment=1e9)]
    query = Query(load("widget"), Vise(pitch=8, columns=1, peg_radius=3), loads=loads, best=1)
    result = answer(attrs.evolve(query, jaw_force=1e9, tolerance=Tolerance(1e6, 1e6), contact_margin=0.0))
    assert np.isfinite([*result[0].quality.values()]).all()


def load_cases_of(**asked: float) -> object:
    """Load cases of a fixture."""
    result = answer(Query(load("widget"), Vise(pitch=8, columns=1, peg_radius=3), best=1))
    return compute_load_cases(result[0], result.workpiece, result.toolkit, [Load(moment=1.0)], **asked)  # type: ignore[arg-type]


def test_the_page_of_limits_says_what_the_code_enforces() -> None:
    """Its tables are written from the code; ``python building/limits_page.py`` writes them anew."""
    import limits_page

    page = limits_page.PAGE.read_text(encoding="utf-8")
    assert limits_page.PLACE.findall(page)
    assert limits_page.fill_page(page) == page
