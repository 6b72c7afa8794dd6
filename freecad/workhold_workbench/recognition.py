"""What tells one fixture from another, so that it is found again in the list of a part that has changed."""

import json

__all__ = ["holes_of", "marks_of", "rank_in"]

# In degrees: a part that lies turned by more than this in the same holes is another fixture.
MOST_TURNED = 45.0


def holes_of(fixture):
    """Kind, directions, and holes with their jaws; where a clamp is bolted follows from the part."""
    pegs = [[peg.get("jaw"), peg.get("column"), peg.get("row")] for peg in fixture["pegs"]]
    return [fixture["type"], fixture.get("directions", fixture.get("direction")), pegs]


def marks_of(fixture):
    """What is kept of a fixture as text: its holes, and the angle at which the part lies in them."""
    return json.dumps([holes_of(fixture), fixture["pose"]["theta_deg"]])


def rank_in(fixtures, marks):
    """The rank of the fixture of a result that the marks are of, from 1; None where none is.

    The same holes may hold a part in two ways, such as turned by half a turn.
    """
    holes, angle = json.loads(marks)
    turned = {}
    for rank, one in enumerate(fixtures, 1):
        if holes_of(one) == holes:
            turned[rank] = abs((one["pose"]["theta_deg"] - angle + 180.0) % 360.0 - 180.0)
    nearest = min(turned, key=turned.get, default=None)
    return nearest if nearest is not None and turned[nearest] <= MOST_TURNED else None
