"""An example of every operation of the interface, for its description; each is tried by a test.

Answers are shown in part: lists by their first entries, objects by some of their keys.
"""

from __future__ import annotations

import json
from typing import Any

from attrs import field, frozen

__all__ = ["EXAMPLES", "FAMILY_NAME", "JOB_NAME", "NONE_NAME", "ApiExample"]

# Names of jobs as they stand in examples; a server makes others.
JOB_NAME = "9mQ2mFvVZ1lq2nF3f0n0xA"
NONE_NAME = "Y5oZ7uUeJ0cS4bK1d8w2Lg"
FAMILY_NAME = "c3Rk8tWq5bXo1nZ7yVh0Pw"


@frozen
class ApiExample:
    """A request, and what is answered.

    Parameters
    ----------
    path, query, headers : values of the address and of headers, by name.
    body : JSON, or the text of a file.
    status : of the answer.
    answer : in part; None where it is no JSON and no text.
    type : of the answer's content.
    """

    path: dict[str, Any] = field(factory=dict)
    query: dict[str, Any] = field(factory=dict)
    headers: dict[str, str] = field(factory=dict)
    body: Any = None
    status: int = 200
    answer: Any = None
    type: str = "application/json"


PLATE = {
    "name": "plate",
    "loops": [[[0, 0, 0], [60, 0, 0.2], [60, 40, 0], [0, 35, 0]]],
}
# As it is sent.
VISE = json.loads('{"pitch": [10, 10], "columns": 2, "peg_radius": 3}')
SEARCH = {"workpiece": PLATE, "toolkit": VISE}
SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">'
    '<path d="M0 0H60V40H0Z" fill="none" stroke="black"/></svg>'
)
# The beginning of one: a whole one would fill pages.
NO_STEP = "ISO-10303-21;\nHEADER;\n"
OF_NO_SOLID = {
    "error": "plate.step: the part of this result was not read from a solid at the height of the pegs: "
    "design it again from its STEP file to show its shape.",
    "place": None,
}
PROGRAM = {
    "name": "slot.nc",
    "text": "G21 G90\nT1 M6\nG0 X10 Y20 Z5\nG1 Z-3 F100\nG1 X50 F300\nG0 Z5\nM30\n",
    "tools": {"name": "tools.csv", "text": "tool,diameter\n1,6\n"},
}
LOADS = [{"points": [[30, 20]], "force": 200, "directions": [0, 360]}]
FILE = {"X-Filename": "plate.svg"}
BEGUN = {"job": JOB_NAME, "url": f"/api/v1/jobs/{JOB_NAME}"}
OF_JOB, OF_FIRST = {"name": JOB_NAME}, {"name": JOB_NAME, "rank": 1}
STATE = {"job": JOB_NAME, "kind": "design", "state": "done", "complete": True, "error": None}
EVENT = 'id: 4\nevent: state\ndata: {"job": "' + JOB_NAME + '", "state": "done", "fraction": 1.0}\n\n'
JOB = "/api/v1/jobs/{name}"
FIRST = JOB + "/fixtures/{rank}"

EXAMPLES = {
    "GET /api/v1/about": ApiExample(answer={"limits": {"segments": 2000}}),
    "GET /api/v1/parts": ApiExample(
        answer=[{"name": "8Handle", "title": "round knob with eight lobes, all arcs"}]
    ),
    "GET /api/v1/parts/{name}": ApiExample({"name": "widget"}, answer={"name": "widget", "remarks": []}),
    "POST /api/v1/parts": ApiExample(
        query={"unit": "mm"}, headers=FILE, body=SVG, answer={"name": "plate", "bounds": [0, 0, 60, 40]}
    ),
    "POST /api/v1/parts/survey": ApiExample(
        query={"unit": "mm"}, headers=FILE, body=SVG, answer={"part": {"name": "plate"}, "error": None}
    ),
    "POST /api/v1/parts/check": ApiExample(body=PLATE, answer={"name": "plate", "departure": 0.0}),
    "POST /api/v1/parts/shape": ApiExample(
        query={"job": JOB_NAME},
        headers={"X-Filename": "plate.step"},
        body=NO_STEP,
        status=400,
        answer=OF_NO_SOLID,
    ),
    "POST /api/v1/lesson": ApiExample(body=PLATE, answer={}),
    "POST /api/v1/programs": ApiExample(
        body={"program": PROGRAM, "height": 10}, answer={"moves": 4, "box": [[10, 20, 7], [50, 20, 15]]}
    ),
    "GET /api/v1/toolkits": ApiExample(
        answer=[{"kind": "translating-clamp", "title": "Plate with one clamp or two"}]
    ),
    "GET /api/v1/presets": ApiExample(answer=[{"name": "clamp-plate-20mm", "unit": "mm"}]),
    "GET /api/v1/figures": ApiExample(answer=[{"key": "closure_margin", "more_is_better": True}]),
    "POST /api/v1/jobs": ApiExample(query={"when_left": "keep"}, body=SEARCH, status=202, answer=BEGUN),
    "POST /api/v1/explore": ApiExample(
        body={"workpiece": PLATE, "toolkits": [{**VISE, "title": "ours"}]}, status=202, answer=BEGUN
    ),
    f"GET {JOB}": ApiExample(OF_JOB, answer={**STATE, "counts": {"I": 1040, "II": 427}, "request": SEARCH}),
    f"DELETE {JOB}": ApiExample(OF_JOB, status=204),
    f"POST {JOB}/cancel": ApiExample(OF_JOB, status=202, answer=STATE),
    f"GET {JOB}/events": ApiExample(
        OF_JOB, headers={"last-event-id": "3"}, answer=EVENT, type="text/event-stream"
    ),
    f"GET {JOB}/fixtures": ApiExample(
        OF_JOB,
        {"limit": 5, "sort": "location_error", "angle": "0..90"},
        answer={"total": 669, "rows": [{"rank": 108, "holes": ["L-A4", "L-B1", "R-A2", "R-A6"]}]},
    ),
    f"GET {JOB}/explanation": ApiExample(
        {"name": NONE_NAME}, answer={"helps": [{"change": "with half the pitch", "fixtures": 2}]}
    ),
    f"POST {JOB}/resist": ApiExample(
        OF_JOB, body={"loads": LOADS}, answer={"best": [{"rank": 1044, "load_reaction": 212.223148}]}
    ),
    f"GET {JOB}/result.json": ApiExample(OF_JOB, answer={"format": "workhold-result/1"}),
    f"GET {JOB}/result.csv": ApiExample(OF_JOB, type="text/csv"),
    "POST /api/v1/families": ApiExample(
        body={
            "workpieces": [
                PLATE,
                {**PLATE, "name": "longer", "loops": [[[0, 0, 0], [80, 0, 0.2], [80, 40, 0], [0, 35, 0]]]},
            ],
            "toolkit": VISE,
        },
        status=202,
        answer={"job": FAMILY_NAME, "url": f"/api/v1/jobs/{FAMILY_NAME}"},
    ),
    f"GET {JOB}/family": ApiExample({"name": FAMILY_NAME}, answer={"points": [{"setups": 1, "loss": 1.0}]}),
    f"GET {JOB}/family/{{kind}}": ApiExample(
        {"name": FAMILY_NAME, "kind": "sheets.pdf"}, {"setups": 1}, type="application/pdf"
    ),
    f"GET {FIRST}": ApiExample(OF_FIRST, answer={"rank": 1, "holes": ["L-A2", "L-A7", "L-B1", "R-A3"]}),
    f"POST {FIRST}/loads": ApiExample(
        OF_FIRST, body={"loads": LOADS, "jaw_force": 3000}, answer={"cases": [{"keeps_contact": True}]}
    ),
    f"POST {FIRST}/supports": ApiExample(
        OF_FIRST, body={"thickness": 12, "best": 3}, answer={"sets": [{"holes": ["L-B2", "L-B7", "R-(0,4)"]}]}
    ),
    f"GET {FIRST}/warnings": ApiExample(OF_FIRST, {"jaw_force": 3000}, answer={"rank": 1, "warnings": []}),
    f"GET {FIRST}/seating": ApiExample(OF_FIRST, answer={"rank": 1, "capture_opening": 0.391745576}),
    f"POST {FIRST}/closing": ApiExample(
        OF_FIRST, body={"theta_deg": 269, "x": 3, "y": 66, "opening": 0.2}, answer={"ending": "right"}
    ),
    f"GET {FIRST}/{{kind}}": ApiExample(
        {**OF_FIRST, "kind": "sheet.pdf"}, {"jaw_force": 3000}, type="application/pdf"
    ),
}
