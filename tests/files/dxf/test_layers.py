"""Outlines of several layers that do not go together: which they are, and what to give instead."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from reading_helpers import area, read_dxf, rectangle

from workhold.errors import InputError

COMMAND = {"layers": "--layer"}


def crossing(space: Any) -> None:
    """A plate with a hole, and bend lines on a layer of their own that end on its outline; a frame around it."""
    rectangle(space, layer="Outline")
    space.add_circle((30, 20), 5, dxfattribs={"layer": "Holes"})
    space.add_line((0, 0), (60, 40), dxfattribs={"layer": "Bend lines"})


def test_a_junction_of_layers_names_them_and_the_command(tmp_path: Path) -> None:
    """Three ends meet at a corner: the one on the other layer is left out."""
    with pytest.raises(InputError) as caught:
        read_dxf(tmp_path, crossing, called=COMMAND)
    said = str(caught.value)
    assert "is on layer 'Outline' and LINE" in said and "is on layer 'Bend lines'" in said
    assert "give --layer Outline --layer Holes to read an outline without the rest." in said
    part = read_dxf(tmp_path, crossing, layers=["Outline", "Holes"]).workpiece
    assert len(part.loops) == 2


def test_in_python_the_layers_are_a_list(tmp_path: Path) -> None:
    """The same sentence without a command."""
    with pytest.raises(InputError, match=r"give layers Outline, Holes to read"):
        read_dxf(tmp_path, crossing)


def test_loops_that_cross_name_their_layers(tmp_path: Path) -> None:
    """A tool path beside the outline crosses it; names with blanks are quoted as a shell takes them."""

    def draw(space: Any) -> None:
        rectangle(space, layer="Part outline")
        rectangle(space, 10, 10, 60, 40, layer="Tool path")

    with pytest.raises(InputError) as caught:
        read_dxf(tmp_path, draw, called=COMMAND)
    assert "is on layer 'Part outline' and LINE" in str(caught.value)
    assert "give --layer 'Part outline' to read an outline without the rest." in str(caught.value)
    assert area(read_dxf(tmp_path, draw, layers=["Part outline"]).workpiece) == pytest.approx(2400)


def test_a_fault_within_one_layer_names_none(tmp_path: Path) -> None:
    """What another choice of layers does not mend is said as before."""

    def draw(space: Any) -> None:
        rectangle(space, layer="Outline")
        space.add_line((0, 0), (5, 5), dxfattribs={"layer": "Outline"})
        space.add_circle((100, 100), 3, dxfattribs={"layer": "Other"})

    with pytest.raises(InputError) as caught:
        read_dxf(tmp_path, draw)
    assert "is on layer" not in str(caught.value)


def test_no_choice_is_promised_that_does_not_do(tmp_path: Path) -> None:
    """Both layers hold a fault of their own: they are named, and nothing is proposed."""

    def draw(space: Any) -> None:
        for layer, x in (("A", 0), ("B", 30)):
            space.add_line((0, 0), (x + 5, 20), dxfattribs={"layer": layer})
            space.add_line((0, 0), (x + 5, -20), dxfattribs={"layer": layer})

    with pytest.raises(InputError) as caught:
        read_dxf(tmp_path, draw)
    assert "is on layer 'A'" in str(caught.value) and "give layers" not in str(caught.value)
