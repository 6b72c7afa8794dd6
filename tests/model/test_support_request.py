"""What is usual for the supports of a part: thickness, faces and bands of its solid, a pad that fits."""

from __future__ import annotations

import pytest
from attrs import evolve

from workhold import Plate, Vise, Workpiece, design
from workhold.errors import InputError
from workhold.model.solid import SolidOutline
from workhold.model.support_request import SupportRequest

SQUARE = [[0, 0, 0], [80, 0, 0], [80, 60, 0], [0, 60, 0]]
BANDS = [(1.0, 9.0), (2.0, 8.0), None, (0.0, 30.0)]
FLAT = Workpiece.from_loops("plate", [SQUARE])
SOLID = Workpiece.from_loops(
    "solid", [SQUARE], solid=SolidOutline("z", 25.0, 9.0, 0.5, 1.0, BANDS, bottom=[SQUARE], top=[SQUARE[:3]])
)


def test_a_solid_says_how_thick_it_is_and_where_it_is_level() -> None:
    """A drawing says neither: then its thickness has to be given, and the outline is level."""
    request = SupportRequest.from_workpiece(SOLID)
    assert (request.thickness, request.pad_radius, request.tip_radius, request.inside) == (25, 4, 5, 5)
    assert request.bottom is not None and request.top is not None
    assert [len(request.bottom[0]), len(request.top[0])] == [4, 3]
    plain = SupportRequest.from_workpiece(FLAT, 12, pad_radius=3, tip_radius=2)
    assert (plain.thickness, plain.pad_radius, plain.inside, plain.bottom, plain.top) == (
        12,
        3,
        2,
        None,
        None,
    )
    with pytest.raises(InputError, match="the thickness of the part is not known: give it in mm"):
        SupportRequest.from_workpiece(FLAT)


def test_the_usual_pad_is_as_small_as_the_holes_ask_for() -> None:
    """Half of the smallest pitch or gap; where that is next to nothing, the pad is refused in the search."""
    assert (
        SupportRequest.from_workpiece(FLAT, 12, toolkit=Vise(pitch=6, columns=4, peg_radius=2)).pad_radius
        == 3
    )
    assert (
        SupportRequest.from_workpiece(
            FLAT, 12, toolkit=Vise(pitch=(20, 7), columns=4, peg_radius=2)
        ).pad_radius
        == 3.5
    )
    assert SupportRequest.from_workpiece(FLAT, 12, toolkit=Plate(pitch=20, peg_radius=3)).pad_radius == 4
    tight = Vise(pitch=1, columns=9, peg_radius=0.4)
    with pytest.raises(InputError, match="would overlap 1 mm apart"):
        SupportRequest.from_workpiece(FLAT, 12, toolkit=tight).refuse_fat_pads(tight)


def test_each_peg_has_the_band_of_its_face_cut_at_the_thickness() -> None:
    """A band that is given comes first; a corner on a wall has what its faces have together."""
    fixture = design(FLAT, Plate(pitch=20, peg_radius=3), best=1)[0]
    solid = SOLID.solid
    pegs = [evolve(fixture.pegs[0], face=face, beside=beside) for face, beside in ((0, None), (3, None))]
    pegs += [evolve(fixture.pegs[0], face=1, beside=0), evolve(fixture.pegs[0], face=2)]
    held = evolve(fixture, pegs=tuple(pegs))
    own = SupportRequest.from_workpiece(SOLID, 20).adapt_to_fixture(held, solid)
    assert own.bands == ((1, 9), (0, 20), (1, 9), None) and own.band == (0, 20)
    assert own.list_peg_bands(4).tolist() == [[1, 9], [0, 20], [1, 9], [0, 20]]
    given = evolve(SupportRequest.from_workpiece(SOLID, 20), band=(3, 4)).adapt_to_fixture(held, solid)
    assert given.bands is None and given.list_peg_bands(4).tolist() == [[3, 4]] * 4
    assert SupportRequest.from_workpiece(FLAT, 20).adapt_to_fixture(held, None).band == (0, 20)
    assert SupportRequest.from_workpiece(FLAT, 20).adapt_to_fixture(held, None, 6).band == (0, 6)


def test_the_engine_takes_the_bands_of_the_solid() -> None:
    """What it found says the bands that its figures hold for, and they are those of the faces touched."""
    result = design(SOLID, Vise(pitch=10, columns=6, peg_radius=3), best=3)
    for one in result.supports(best=3, each=1, top="outline"):
        faces = [peg.face for peg in one.fixture.pegs]
        assert one.request.bands == tuple(BANDS[face] if face != 3 else (0.0, 25.0) for face in faces)
