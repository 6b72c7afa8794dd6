"""Each rule of ``building/house_rules.py`` finds an offence that is planted, and nothing where there is none."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest

import house
import house_rules as rules
from house_rules import Source
from house_words import replaced_words
from workhold.fixels.kinds import TABLES

ROOT = Path(__file__).parent.parent


def planted(text: str, name: str = "drawing/some.py") -> list[Source]:
    """One file of sources with a text in it."""
    return [Source(name, text)]


def places(found: Sequence[rules.Finding] | object) -> list[str]:
    """The places of findings."""
    return [one.place for one in found]  # type: ignore[attr-defined]


ASKING = [
    "isinstance(toolkit, Vise)",
    "isinstance(toolkit, Plate | Fence)",
    "isinstance(toolkit, (OpeningVise, int))",
    "isinstance(toolkit, model.Plate)",
    "issubclass(kind, Fence)",
    'toolkit.kind == "vise"',
    '"plate" != name',
    'kind in ("plate", "fence")',
    'toolkit.kind == "translating-clamp"',
    "type(toolkit) is Vise",
    "toolkit.kind == OpeningVise.kind",
    '{"vise": 1, "plate": 2}[kind]',
    "carrier.is_on_wall",
    "carrier.is_on_a_wall",
    "peg.has_a_hole",
    "clamp.is_along_x",
    "carrier.is_wall",
    "toolkit.wall",
    "toolkit.needs_pairs",
    "fixture.pair is None",
    "pair is not None",
    "match kind:\n    case 'fence': pass",
    "match toolkit:\n    case Plate(): pass",
]


@pytest.mark.parametrize("text", ASKING)
def test_a_line_that_asks_for_the_kind_is_found(text: str) -> None:
    assert len(places(rules.lines_asking_for_kind(planted(text)))) == 1


@pytest.mark.parametrize(
    "text",
    [
        "isinstance(value, int)",
        "from workhold.fixels.vise import Vise",
        "Vise(pitch=8)",
        'NOUN = "vise"',
        "wall = 3",
        "toolkit.wall = 3",
        "other is None",
        "toolkit.kind",
        '"""Asks isinstance(toolkit, Vise)."""',
        "{'name': kind}",
    ],
)
def test_other_lines_do_not_ask_for_the_kind(text: str) -> None:
    assert places(rules.lines_asking_for_kind(planted(text))) == []


def test_every_kind_that_has_a_table_is_known() -> None:
    assert set(TABLES) <= rules.KIND_NAMES


def test_a_line_that_asks_twice_counts_once() -> None:
    assert places(rules.lines_asking_for_kind(planted("a.wall or b.is_wall\nc.wall"))) == [
        "drawing/some.py:1",
        "drawing/some.py:2",
    ]


@pytest.mark.parametrize("name", ["fixels/vise.py", "verification/rules/vise.py"])
def test_the_rooms_of_kinds_may_ask_and_be_named_so(name: str) -> None:
    assert places(rules.lines_asking_for_kind(planted("a.wall", name))) == []
    assert places(rules.modules_named_after_kind(planted("", name))) == []


@pytest.mark.parametrize(
    "name", ["search/fence.py", "files/dxf/plates.py", "listing/on_plate.py", "a/opening_b.py"]
)
def test_a_module_named_after_a_kind_is_found(name: str) -> None:
    assert [one.key for one in rules.modules_named_after_kind(planted("", name))] == [
        name.removesuffix(".py")
    ]


@pytest.mark.parametrize("name", ["fence/some.py", "search/template.py", "drawing/advise.py"])
def test_a_module_named_otherwise_is_none(name: str) -> None:
    assert places(rules.modules_named_after_kind(planted("", name))) == []


NAMING = [
    "toolkit.row_offset",
    "query.toolkit.row_offset",
    "Vise(row_offset=3)",
    "evolve(toolkit, row_offset=3)",
    "getattr(self.toolkit, 'row_offset', 1)",
    'ToolkitField("row_offset", "length")',
    "MIN_GAP.shown(label, follows='row_offset')",
    'fields["row_offset"]',
    'toolkit.get("row_offset")',
    'fields.pop("row_offset", None)',
    'changed({"row_offset": 1, "pitch": 2})',
    '("pitch", "row_offset")',
    'name != "row_offset"',
    "@made_from_table\nclass Kind:\n    def f(self): return self.row_offset",
]
NOT_NAMING = [
    "row_offset = 3",
    '"""The row_offset."""',
    "# row_offset",
    "row_offsets(a.offset)",
    "carrier.row_offset",
    "toolkit.carriers[0].row_offset",
    "class Lattice:\n    def f(self): return self.row_offset",
    "evolve(lattice, row_offset=3)",
    "Carrier(row_offset=3)",
    '{"row_offset": 1, "letter": 2}',
    '("offset", "row_offset")',
    'Literal["row_offset"]',
    'form == "row_offset"',
    'answer["row_offset"]',
    "ROW_OFFSET.name",
    "@made_from_table\nclass Kind:\n    row_offset: float",
]


@pytest.mark.parametrize("text", NAMING)
def test_a_file_that_names_a_field_of_a_toolkit_is_found_once(text: str) -> None:
    found = list(rules.files_naming_fields(planted(f"{text}\n{text}"), ["row_offset", "pitch"]))
    assert [one.key for one in found if one.key == "row_offset"] == ["row_offset"]
    assert found[0].place.startswith("drawing/some.py:")


@pytest.mark.parametrize("text", NOT_NAMING)
def test_what_another_thing_has_under_the_name_of_a_field_is_none(text: str) -> None:
    assert places(rules.files_naming_fields(planted(text), ["row_offset", "pitch"])) == []


def test_fields_are_those_of_the_tables() -> None:
    names = rules.field_names()
    assert {"row_offset", "wall_offset", "peg_radius", "max_opening"} <= set(names)
    assert not rules.COMMON_WORDS & set(names)


def test_files_that_are_too_long_or_too_short_are_found() -> None:
    lengths = {"a/short.py": 39, "a/least.py": 40, "a/most.py": 800, "b/long.py": 801, "a/__init__.py": 0}
    sources = [Source(name, "\n" * count) for name, count in lengths.items()]
    assert places(rules.long_files(sources)) == ["b/long.py"]
    assert places(rules.short_files(sources)) == ["a/short.py"]
    assert house.counts_of({"size": house.by_key(list(rules.sizes(sources)))}) == {
        "size": {"files": 5, "lines": 1680}
    }


def test_a_class_name_used_again_is_found() -> None:
    sources = [
        Source("a/one.py", "class Box: pass\nclass Lid: pass"),
        Source("b/two.py", "\nclass Box: pass"),
    ]
    assert [(one.key, one.place) for one in rules.repeated_classes(sources)] == [("Box", "b/two.py:2")]


@pytest.mark.parametrize(
    "opening",
    [
        "The same for three pegs.",
        "Those of a plate.",
        "That of a fence.",
        "The one with two clamps.",
        "Its length.",
        "Of two clamps the first.",
        "As ``load`` does.",
        "Write a file.",
        "Return the length.",
        "Open the file.",
        "Name what is missing.",
    ],
)
def test_a_poor_opening_is_found(opening: str) -> None:
    for text in (f'"""{opening}"""', f'def f():\n    """{opening}"""', f'class A:\n    """{opening}"""'):
        assert len(places(rules.poor_openings(planted(text)))) == 1


@pytest.mark.parametrize(
    "opening",
    [
        "Writes a file.",
        "The length of a line.",
        "Whether a peg stands there.",
        "Order of rows.",
        "Start of an edge.",
        "Set of numbers.",
        "Items of a list.",
        "Open and closed loops.",
        "The other side of a part.",
        "Readings of the vise.",
    ],
)
def test_another_opening_is_none(opening: str) -> None:
    assert places(rules.poor_openings(planted(f'"""{opening}"""'))) == []


def test_a_long_sentence_is_found() -> None:
    long, short = " ".join(["word"] * 31), " ".join(["word"] * 30)
    assert len(places(rules.long_sentences(planted(f'"""{long}."""')))) == 1
    assert len(places(rules.long_sentences(planted(f'"""{short}. {long.title()}. {short.title()}."""')))) == 1
    assert places(rules.long_sentences(planted(f'"""{short}. {short.title()}."""'))) == []


def test_entries_and_examples_are_no_part_of_a_sentence() -> None:
    words = " ".join(["word"] * 20)
    text = f"{words}.\n\nParameters\n----------\na : {words}\nb : {words}\n\nExamples\n--------\n>>> f({words})\n{words}\n"
    assert places(rules.long_sentences(planted(f'"""{text}"""'))) == []
    numbered = f"Steps:\n\n1. {words};\n2. {words}.\n- {words}"
    assert places(rules.long_sentences(planted(f'"""{numbered}"""'))) == []
    entry = f"{words}.\n\nParameters\n----------\na : {words}\n    {words}\n"
    assert len(places(rules.long_sentences(planted(f'"""{entry}"""')))) == 1


def test_a_long_line_is_found() -> None:
    assert places(rules.long_lines(planted(f"a = 1\n#{'x' * 110}\n#{'x' * 109}"))) == ["drawing/some.py:2"]


@pytest.mark.parametrize(
    "text", ["import_module(name)", "importlib.import_module('a')", "__import__('a')", "beyond('a')()"]
)
def test_an_import_by_name_is_found(text: str) -> None:
    assert [one.key for one in rules.imports_by_name(planted(text))] == ["drawing/some.py"]


def test_other_imports_are_none() -> None:
    assert places(rules.imports_by_name(planted("from importlib import import_module\nfind_spec('a')"))) == []


@pytest.fixture
def glossary(tmp_path: Path) -> Path:
    path = tmp_path / "glossary.md"
    table = (
        "| word | instead |\n|---|---|\n| told, tells | said |\n| Door | frame |\n| `beyond` | hand in |\n"
    )
    path.write_text(
        f"| word | meaning |\n|---|---|\n| loop | chain |\n\n## Words replaced\n\n{table}\n## More\n\n| peg | pin |\n"
    )
    return path


@pytest.mark.parametrize(
    "text", ["# As told.", "told = 1", "how_it_is_told(a)", '"""Told."""', "Door()", "# it tells"]
)
def test_a_replaced_word_is_found(text: str, glossary: Path) -> None:
    assert len(places(replaced_words(glossary)(planted(text)))) == 1


@pytest.mark.parametrize("text", ["# a loop, a peg", "untold = 1", "toldest(a)", "door = Doorway()", "word"])
def test_another_word_is_none(text: str, glossary: Path) -> None:
    assert places(replaced_words(glossary)(planted(text))) == []


@pytest.mark.parametrize(
    "text",
    [
        "def beyond(): pass",
        "async def beyond(): pass",
        "class beyond: pass",
        "import a.beyond",
        "from a import beyond",
        "from a.beyond import b",
        "beyond(a)",
        "a.beyond",
    ],
)
def test_a_word_of_plain_english_is_found_as_a_name(text: str, glossary: Path) -> None:
    assert len(places(replaced_words(glossary)(planted(text)))) == 1


def test_a_word_of_plain_english_is_none_elsewhere(glossary: Path) -> None:
    text = '"""Beyond the end."""\nbeyond = 1\nf(beyond)  # how far beyond the end\n'
    assert places(replaced_words(glossary)(planted(text))) == []
    assert places(replaced_words(glossary)(planted("", "drawing/beyond.py"))) == ["drawing/beyond.py:1"]


def test_the_glossary_of_the_manual_has_replaced_words() -> None:
    found = replaced_words(ROOT / "docs" / "glossary.md")(planted("told = Door"))
    assert sorted(one.key for one in found) == ["Door", "told"]


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project with one file, whose counts are recorded."""
    for folder in ("src/workhold/drawing", "docs", "building"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "docs" / "glossary.md").write_text(
        "## Words replaced\n\n| word | instead |\n| told | said |\n"
    )
    write(tmp_path, "a.wall\n")
    assert house.record(tmp_path, may_raise=False) == 0
    return tmp_path


def write(project: Path, text: str) -> None:
    """Writes the one file of a project."""
    (project / "src" / "workhold" / "drawing" / "some.py").write_text(text)


def test_equal_counts_pass(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert house.check(project) == 0
    assert capsys.readouterr().out == "The house is no worse than recorded.\n"


def test_a_fallen_count_passes_and_is_to_be_recorded(
    project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(project, "a = 1\n")
    assert house.check(project) == 0
    assert "write them down" in capsys.readouterr().out


def test_a_raised_count_is_one_sentence_with_place_and_remedy(
    project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(project, "a.wall or\\\n b.is_wall\n")
    assert house.check(project) == 1
    said = capsys.readouterr().out.splitlines()
    assert said == [
        "lines asking for the kind, drawing: 2 where 1 are recorded: ask its data or its contact kinds in fixels "
        "(drawing/some.py:1, drawing/some.py:2).",
        "size, lines: 2 where 1 are recorded: take away what is no longer needed (src/workhold).",
    ]


def test_a_count_that_was_not_recorded_is_raised(project: Path) -> None:
    write(project, "b = told")
    assert house.check(project) == 1


def test_the_record_takes_lower_counts_and_refuses_higher_ones(project: Path) -> None:
    path = project / house.RECORD
    before = path.read_text()
    write(project, "a.wall\nb.wall\n")
    assert house.record(project, may_raise=False) == 1
    assert path.read_text() == before
    write(project, "a = 1\n")
    assert house.record(project, may_raise=False) == 0
    assert house.read_record(project)["lines asking for the kind"] == {}
    write(project, "a.wall\n")
    assert house.check(project) == 1
    assert house.record(project, may_raise=True) == 0
    assert path.read_text() == before


def test_the_record_has_one_number_a_line_in_order(project: Path) -> None:
    text = (project / house.RECORD).read_text()
    assert text == json.dumps(json.loads(text), indent=1, sort_keys=True) + "\n"
    assert '  "drawing": 1' in text.splitlines()


def test_places_are_shown(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    house.show(project, ["lines asking"])
    assert capsys.readouterr().out == "lines asking for the kind, drawing: 1\n  drawing/some.py:1\n"


def test_other_words_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert house.main(["record", "--lower"]) == 2
    assert house.main([]) == 2
    assert "usage" in capsys.readouterr().err


def git(project: Path, *words: str) -> None:
    """Runs git in a project, as somebody."""
    who = ("-c", "user.name=A", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false")
    subprocess.run(["git", "-C", project, *who, *words], check=True, capture_output=True)


def test_a_long_subject_since_the_record_began_is_found(project: Path) -> None:
    git(project, "init")
    git(project, "commit", "--allow-empty", "-m", "x" * 80)
    git(project, "add", "building")
    git(project, "commit", "-m", "y" * 80)
    git(project, "commit", "--allow-empty", "-m", "z" * 72)
    assert list(rules.long_subjects(project, house.RECORD)) == []
    git(project, "commit", "--allow-empty", "-m", "z" * 73)
    (found,) = rules.long_subjects(project, house.RECORD)
    assert found.endswith("its subject has 73 characters: 72 are the most.")
    assert house.check(project) == 1


def test_without_history_no_subject_is_too_long(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert list(rules.long_subjects(project, house.RECORD)) == []
    monkeypatch.setenv("PATH", "")
    assert list(rules.long_subjects(project, house.RECORD)) == []


def test_every_rule_is_recorded() -> None:
    """The record of the project has the counts of each rule, and no others."""
    assert sorted(house.read_record(ROOT)) == sorted(rule.name for rule in house.rules_of(ROOT))


def test_the_help_of_a_command_may_be_in_the_imperative() -> None:
    """Other docstrings of the command line, and of other rooms, may not."""
    text = '"""Write the sheet.\n\nExample: workhold sheet r.json 1\n"""'
    assert places(rules.poor_openings(planted(text, "cli/some.py"))) == []
    assert len(places(rules.poor_openings(planted(text)))) == 1
    assert len(places(rules.poor_openings(planted('"""Write the sheet."""', "cli/some.py")))) == 1
