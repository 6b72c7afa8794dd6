"""What the page is told of the kinds of toolkits suffices to ask for every one of them."""

from __future__ import annotations

import json
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest
from attrs import asdict, fields_dict
from running_server import WIDGET, RunningServer, request

from workhold import Plate, design, load
from workhold.files.toolkit_file import list_preset_names, load_preset, load_toolkit
from workhold.fixels.contacts import DIRECTIONS, WALL_END
from workhold.fixels.kinds import ALIASES, KINDS, make_toolkit, resolve_kind
from workhold.fixels.support_hardware import HARDWARE
from workhold.web.answers import describe_fixture
from workhold.web.forms import JobForm
from workhold.web.toolkits import DESCRIBED, DescribedToolkit

RECTANGLE = {"name": "plate", "loops": [[[0, 0, 0], [90, 0, 0], [90, 50, 0], [0, 50, 0]]]}
PLATE = {"kind": "translating-clamp", "pitch": [20, 20], "peg_radius": 3, "directions": ["-x", "-y"]}


def asked(vise: Any) -> Any:
    """The toolkit that a request asks for."""
    form = JobForm.model_validate({"workpiece": WIDGET, "toolkit": json.loads(json.dumps(vise))})
    return form.toolkit.to_toolkit()


def test_every_kind_is_on_the_page() -> None:
    """A kind, or the alias that says most about one; nothing is there twice."""
    names = [one.name for one in DESCRIBED]
    assert len(set(names)) == len(names)
    assert set(KINDS) <= set(names) | {resolve_kind(name)[0] for name in names}
    assert {name for name, (_, said) in ALIASES.items() if said} <= set(names)


@pytest.mark.parametrize("one", DESCRIBED, ids=lambda one: one.name)
def test_every_field_of_a_kind_is_on_the_page(one: DescribedToolkit) -> None:
    """Once for each set of other values, but for those that the name says; what must be filled in begins with a value."""
    kind = KINDS[resolve_kind(one.name)[0]]
    shown = [field.name for field in one.fields]
    assert set(shown) | set(one.said) | set(HARDWARE) == set(fields_dict(kind)) - {"tolerance"}  # type: ignore[arg-type]
    assert not set(shown) & set(one.said)
    for _, group in groupby(sorted(one.fields, key=lambda field: field.name), key=lambda field: field.name):
        alike = list(group)
        assert len({json.dumps(dict(field.when)) for field in alike}) == len(alike)
    assert all(field.name in one.words.start for field in one.fields if field.hint is None and not field.when)
    assert asked({"kind": one.name, **one.words.start}) == make_toolkit(one.name, one.words.start)


@pytest.mark.parametrize("one", DESCRIBED, ids=lambda one: one.name)
def test_every_choice_can_be_asked_for(one: DescribedToolkit) -> None:
    """A field's choices are values that the toolkit takes."""
    for field in one.fields:
        for choice in field.choices:
            value = [choice.value] if field.form == "several" else choice.value
            toolkit = asked({"kind": one.name, **one.words.start, **field.when, field.name: value})
            assert json.loads(json.dumps(getattr(toolkit, field.name))) == json.loads(json.dumps(value))


def test_every_figure_of_hardware_is_on_the_page(server: RunningServer) -> None:
    """Of supports and of the clamp on top, for every kind of toolkit; each can be asked for."""
    for one in server.client.get("/api/toolkits").json():
        assert [table["name"] for table in one["hardware"]] == list(HARDWARE)
        for table in one["hardware"]:
            fields = {field["name"]: field for field in table["fields"]}
            assert set(fields) == {row.name for row in HARDWARE[table["name"]].table.fields}
            assert {field["table"] for field in fields.values()} == {table["name"]}
            assert all(field["hint"] and field["label"] for field in fields.values())
            values = {name: [[0.0, 0.0, 5.0, 90.0]] if name == "reach" else 2.5 for name in fields}
            made = asked({"kind": one["name"], **one["start"], table["name"]: values})
            assert json.loads(json.dumps(asdict(getattr(made, table["name"])))) == values


@pytest.mark.parametrize("one", DESCRIBED, ids=lambda one: one.name)
def test_the_role_of_every_field_of_heights_is_told(one: DescribedToolkit) -> None:
    """So that the page asks for the outlines of the carriers that it gives heights."""
    named = {name: [2.0 + k, 9.0] for k, name in enumerate(one.roles)}
    assert set(named) == {field.name for field in one.fields if field.name.endswith("_heights")}
    if not named:
        # Flat jaws reach as high as they are, and dowels under straps as all pegs do.
        assert {"parallels", "straps"} & {field.name for field in one.fields}
        return
    made = asked({"kind": one.name, **one.words.start, **named})
    assert {one.roles[name]: tuple(ends) for name, ends in named.items()} == made.heights


@pytest.mark.thorough
def test_a_preset_is_of_the_kind_that_says_most(server: RunningServer) -> None:
    """A vise of one column is a gripper; every preset is asked for as the page shows it."""
    presets = {one["name"]: one for one in server.client.get("/api/presets").json()}
    kinds = {name: one["kind"] for name, one in presets.items()}
    assert list(presets) == list(list_preset_names())
    assert kinds["gripper-one-column"] == "gripper" and kinds["gripper-two-columns"] == "vise"
    assert kinds["clamp-plate-20mm"] == "translating-clamp"
    for name, kind in kinds.items():
        assert asked({"kind": kind, **presets[name]["fields"]}) == load_toolkit(name).toolkit


def test_the_words_are_of_the_toolkit(server: RunningServer) -> None:
    """A plate has a clamp that closes, no jaws."""
    told = {one["name"]: one for one in server.client.get("/api/toolkits").json()}
    plate = json.dumps(told["translating-clamp"])
    assert "jaw" not in plate and "vise" not in plate.lower()
    assert (told["translating-clamp"]["mover"], told["vise"]["mover"]) == ("clamp", "jaw")
    assert [one["name"] for one in told["vise"]["types"]] == ["I", "II"]
    assert [one["name"] for one in told["translating-clamp"]["types"]] == ["clamp"]


@pytest.mark.thorough
def test_fixtures_of_a_plate_are_told_apart_by_their_direction(server: RunningServer) -> None:
    """The job tells what there is; each direction by itself, and both by the name they share."""
    url = server.done(request(workpiece=RECTANGLE, toolkit=PLATE))
    state = server.client.get(url).json()
    assert [one["title"] for one in state["arrangements"]] == ["clamp -x", "clamp -y"]
    totals = {}
    for name in ("clamp", "clamp -x", "clamp -y"):
        page = server.client.get(f"{url}/fixtures", params={"type": name, "limit": 1000}).json()
        totals[name] = page["total"]
        titles = {row["title"] for row in page["rows"]}
        assert (
            titles == {"Clamp −x", "Clamp −y"} if name == "clamp" else {name.capitalize().replace("-", "−")}
        )
    assert totals["clamp"] == totals["clamp -x"] + totals["clamp -y"] == state["listed"]
    assert totals["clamp -x"] and totals["clamp -y"]
    assert server.client.get(f"{url}/fixtures", params={"type": "I"}).status_code == 400


@pytest.mark.thorough
def test_what_would_help_says_which_fields_change(server: RunningServer) -> None:
    """So that the page can make any change of any toolkit."""
    vise = {**PLATE, "columns": 2, "rows": 2, "directions": ["-x"]}
    url = server.done(request(workpiece=RECTANGLE, toolkit=vise))
    told = server.client.get(f"{url}/explanation").json()
    assert "helps" in told, told
    helps = told["helps"]
    changes = [one["toolkit"] for one in helps if one["toolkit"] is not None]
    assert changes
    for fields in changes:
        assert (
            server.client.get(server.done(request(workpiece=RECTANGLE, toolkit={**vise, **fields}))).json()[
                "found"
            ]
            > 0
        )


def test_directions_of_the_page_are_those_of_the_plate() -> None:
    """Of one clamp all, of two the pairs that half a turn of the plate does not make of each other."""
    fields = next(one for one in DESCRIBED if one.name == "translating-clamp").fields
    one, two = ([choice.value for choice in field.choices] for field in fields if field.name == "directions")
    assert one == list(DIRECTIONS)
    every = Plate(pitch=20, peg_radius=3, clamps=2, directions=list(DIRECTIONS))
    assert {tuple(pair) for pair in two} == set(every.pushes) and len(two) == 6


@pytest.mark.thorough
def test_a_clamp_that_reaches_no_hole_is_told_by_its_line(server: RunningServer) -> None:
    """The nearest miss of a part that no clamp of this stroke reaches has neither a body nor a length to draw."""
    vise = {**PLATE, "directions": ["-x"], "travel": [300, 301], "columns": 12, "rows": 8}
    url = server.done(request(workpiece=RECTANGLE, toolkit=vise))
    nearest = server.client.get(f"{url}/explanation").json()["nearest"]
    picture = nearest["row"]["picture"]
    assert 'class="clamp-line"' in picture
    assert not any(f'class="{kind}"' in picture for kind in ("clamp-body", "bolt", "travel"))
    assert nearest["row"]["settings"][0]["length"] < 300


@pytest.mark.thorough
def test_a_fence_is_answered_with_its_bar_and_the_contacts_on_it(server: RunningServer) -> None:
    """The ends of the contact are numbered among the pegs, after the locator; a corner tells that it is one."""
    shape = {
        **RECTANGLE,
        "loops": [[[0, 0, 0], [60, 0, 0], [60, 20, 0], [20, 20, 0], [20, 50, 0], [0, 50, 0]]],
    }
    vise = {"kind": "edge", "pitch": [10, 10], "peg_radius": 3, "wall_offset": 5}
    url = server.done(request(workpiece=shape, toolkit=vise))
    row = server.client.get(f"{url}/fixtures/1").json()
    assert row["flush"] == row["corners"] == [1, 2] and row["origin"] == "column A at the fence"
    assert [carrier["pegs"] for carrier in row["carriers"]] == [[0], [1, 2], [3]]
    assert 'class="fence"' in row["picture"]
    assert server.client.get(f"{url}/fixtures/1/sheet.svg").status_code == 200
    square = server.done(request(workpiece=RECTANGLE, toolkit=vise))
    assert "three directions beside" in " ".join(server.client.get(square).json()["notes"])
    assert server.client.get(f"{square}/explanation").json()["removals"]


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["machine-vise-6-inch", "fence-20mm", "clamp-plate-20mm", "plate-20mm"])
def test_each_carrier_has_its_own_pegs(name: str) -> None:
    """By the numbers that they have in the fixture, also where the wall comes first; walls have what lies flush."""
    toolkit = load_preset(name).toolkit
    workpiece = load(Path(__file__).parents[2] / "examples" / "bracket.dxf")
    fixture = design(workpiece, toolkit, best=1)[0]
    row = describe_fixture(fixture, workpiece, toolkit)
    told = {number: each for each in row["carriers"] for number in each["pegs"]}
    assert sorted(told) == list(range(len(fixture.pegs)))
    for number, peg in enumerate(fixture.pegs):
        carrier = toolkit.find_carrier(peg.carrier)
        assert told[number]["peg_radius"] == carrier.peg_radius
        assert (number in row["flush"]) == (carrier.contact is WALL_END)


def test_a_listing_is_of_two_clamps_alone() -> None:
    """Another toolkit, which the page may have been changed to meanwhile, is asked without one."""
    asked = request(listing="all")
    assert JobForm.model_validate(asked).to_queries(1000)[0][1].listing is None
    plate = {"kind": "translating-clamp", "pitch": [20, 20], "peg_radius": 3, "clamps": 2}
    assert JobForm.model_validate(asked | {"toolkit": plate}).to_queries(1000)[0][1].listing == "all"
