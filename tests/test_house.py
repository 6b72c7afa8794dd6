"""Each rule of ``building/house.py`` finds an offence that is planted, and nothing where there is none."""

from __future__ import annotations

import house
from house import Source
from workhold.fixels.kinds import TABLES

ASKING = (
    "isinstance(toolkit, Vise)",
    "isinstance(toolkit, Plate | Fence)",
    "isinstance(toolkit, (OpeningVise, int))",
    "isinstance(toolkit, model.Plate)",
    "issubclass(kind, Fence)",
    'toolkit.kind == "vise"',
    '"plate" != name',
    'kind in ("plate", "fence")',
    "type(toolkit) is Vise",
    "toolkit.kind == OpeningVise.kind",
    '{"vise": 1, "plate": 2}[kind]',
    "carrier.is_on_wall",
    "peg.has_a_hole",
    "clamp.is_along_x",
    "carrier.is_wall",
    "toolkit.wall",
    "toolkit.needs_pairs",
    "fixture.pair is None",
    "match kind:\n    case 'fence': pass",
    "match toolkit:\n    case Plate(): pass",
)
NOT_ASKING = (
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
    '{"plate": corners(body)}',
)
NAMING = (
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
    "@make_class_from_table\nclass Kind:\n    def f(self): return self.row_offset",
)
NOT_NAMING = (
    "row_offset = 3",
    '"""The row_offset."""',
    "row_offsets(a.offset)",
    "carrier.row_offset",
    "toolkit.carriers[0].row_offset",
    "class Lattice:\n    def f(self): return self.row_offset",
    "evolve(lattice, row_offset=3)",
    "Carrier(row_offset=3)",
    '{"row_offset": 1, "letter": 2}',
    '("offset", "row_offset")',
    'answer["row_offset"]',
    "ROW_OFFSET.name",
    "@make_class_from_table\nclass Kind:\n    row_offset: float",
)


def asked(text: str, name: str = "drawing/some.py") -> list[str]:
    return list(house.find_lines_asking_for_kind([Source(name, text)]))


def scattered(text: str, files: int) -> list[str]:
    """What is said of a text that stands in so many files."""
    sources = [Source(f"drawing/{number}.py", text) for number in range(files)]
    return [
        one for one in house.find_scattered_fields(sources, ["row_offset", "pitch"]) if "row_offset" in one
    ]


def test_a_line_that_asks_for_the_kind_is_found_once() -> None:
    """But where it may."""
    assert [text for text in ASKING if len(asked(text)) != 1] == []
    assert [text for text in NOT_ASKING if asked(text)] == []
    assert [one.split()[0] for one in asked("a.wall or b.is_wall\nc.wall")] == [
        "drawing/some.py:1",
        "drawing/some.py:2",
    ]
    assert asked("a.wall", "fixels/vise.py") == asked("a.wall", "verification/rules/vise.py") == []
    assert set(TABLES) <= house.KIND_NAMES


def test_a_field_that_too_many_files_name_is_found() -> None:
    most = house.MOST_FILES_OF_A_FIELD
    assert [text for text in NAMING if scattered(text, most) or len(scattered(text, most + 1)) != 1] == []
    assert [text for text in NOT_NAMING if scattered(text, most + 1)] == []
    names = set(house.list_field_names())
    assert {"row_offset", "wall_offset", "peg_radius", "max_opening"} <= names
    assert not house.COMMON_WORDS & names


def test_a_class_name_used_again_is_found() -> None:
    """Unless it is one of those that are named."""
    first = Source("a/one.py", "class Box: pass\nclass Lid: pass\nclass Edge: pass")
    second = Source("b/two.py", "\nclass Box: pass\nclass Edge: pass")
    (found,) = house.find_repeated_classes([first, second])
    assert found.startswith("b/two.py:2 has a class Box like a/one.py:1")
