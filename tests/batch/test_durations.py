"""How long tasks are predicted to take where friction holds the part."""

from __future__ import annotations

from jaw_examples import rectangle
from workhold import Load, PlainVise, Plate, Query, StrapPlate
from workhold.batch.durations import predict_answering_seconds, predict_friction_seconds

LOADS = [Load(points=(30, 10), force=300), Load(points=(50, 10), force=300)]
SIZE = (100.0, 60.0)


def predict(toolkit, **asked):
    return predict_answering_seconds(4, SIZE, toolkit, Query(rectangle(), toolkit, thickness=20.0, **asked))


def test_loads_take_most_of_the_time_of_a_strapped_search():
    """Three seconds and more for the usual twenty seats; seats alone take a part of one."""
    plate = StrapPlate(pitch=20, peg_radius=3, straps=2, columns=12, rows=10)
    without, one, two = predict(plate), predict(plate, loads=LOADS[:1]), predict(plate, loads=LOADS)
    assert without == predict_answering_seconds(4, SIZE, plate) < 1.0
    assert 2.0 < one < two < 10.0
    assert predict(plate, loads=LOADS, strapped=100) > 4 * two


def test_each_hold_of_a_plain_vise_takes_its_time():
    few = PlainVise(jaw_width=152, jaw_height=44, parallels=[20])
    many = PlainVise(jaw_width=152, jaw_height=44, parallels=[20, 25, 32], stop="both")
    per_hold = predict_friction_seconds(4, few, Query(rectangle(), few, thickness=20.0, loads=LOADS)) / 4
    assert 0.02 < per_hold < 0.5
    asked = Query(rectangle(), many, thickness=20.0, loads=LOADS)
    assert abs(predict_friction_seconds(4, many, asked) / 24 - per_hold) < 1e-9
    assert predict(few) < predict(few, loads=LOADS)


def test_pegs_take_no_longer_under_loads():
    plate = Plate(pitch=20, peg_radius=3)
    assert predict_friction_seconds(4, plate, Query(rectangle(), plate, loads=LOADS)) == 0.0
