"""The question of a search: what is asked of the fixtures besides part and toolkit."""

from __future__ import annotations

from typing import Any

from attrs import frozen

from workhold.asking.declaring import PageLabel, check_fields, declare

__all__ = [
    "HEIGHTS",
    "LOADS",
    "RANKING",
    "RULING_OUT",
    "SEARCH",
    "SEATING",
    "RestrictionQuestion",
    "SearchQuestion",
]

# Sections of the command's help. What is ruled out, loads and ranking are asked of a comparison of toolkits
# as well.
RULING_OUT, LOADS, RANKING, SEATING, SEARCH = "Ruling out", "Loads", "Ranking", "Seating", "The search"
# Of heights, which stand with the part or its program.
HEIGHTS = "Heights"


@frozen(field_transformer=check_fields)
class RestrictionQuestion:
    """What fixtures must keep clear of, and what they must touch; :class:`workhold.Restrictions` explains the fields."""

    avoid: Any = declare(
        "faces",
        "Faces that no peg may touch.",
        default=(),
        section=RULING_OUT,
        typed="Faces that no peg may touch, such as 3,7 (see workhold features).",
    )
    zones: Any = declare(
        "zones",
        "Places where no peg may stand.",
        default=(),
        section=RULING_OUT,
        word="keep_out",
        typed="Places where no peg may stand, in the drawing's coordinates: circle=X,Y,RADIUS or "
        "polygon=X,Y;X,Y;X,Y. May be repeated.",
    )
    angles: Any = declare(
        "angles",
        "Angles at which the part may lie, in degrees.",
        default=(),
        section=RULING_OUT,
        word="angle",
        typed="Angles at which the part may lie, in degrees: -10..10. May be repeated.",
    )
    touch: Any = declare(
        "faces",
        "Faces that every fixture must touch; not with two clamps.",
        PageLabel("Must touch faces", "none"),
        default=(),
        section=RULING_OUT,
        typed="Faces that every fixture must touch, such as 3,7; not with two clamps.",
    )


@frozen(field_transformer=check_fields, kw_only=True)
class SearchQuestion:
    """What is asked of the fixtures; :class:`workhold.Query` explains the fields."""

    contact_margin: float = declare(
        "length",
        "Smallest distance from a contact to the end of its face.",
        PageLabel("Edge margin", "0"),
        default=0.0,
        least="0",
        section=RULING_OUT,
    )
    max_location_error: float | None = declare(
        "length",
        "List only fixtures whose location error is at most this.",
        PageLabel("Error up to", "any"),
        called="largest location error",
        section=RULING_OUT,
    )
    best: int | None = declare(
        "count", "Keep only the best K fixtures.", section=SEARCH, most=10_000, metavar="K"
    )
    listing: str | None = declare(
        "choice",
        "With two clamps: best lists the best pair of clamps of each seat, and the number of its "
        "pairs; all lists every pair; best if not given.",
        choices=("best", "all"),
        section=SEARCH,
    )
    jaw_force: float | None = declare(
        "force",
        "Force that closes the vise or tightens the clamp, in N or with its unit (3kN, 700lbf); "
        "for two clamps the sum of both, for straps that of each at its tip. With it the search warns of pegs that "
        "let go under the loads; where friction holds the part it says how many times the loads are held.",
        PageLabel("Your clamping force", "not known"),
        least="0",
        section=LOADS,
    )
    friction: Any = declare(
        "coefficients",
        "Coefficients of friction by name where friction holds the part: jaw, or plate and tip; usual ones, which "
        "the answer names, if not given.",
        section=LOADS,
        typed="Coefficients of friction where friction holds the part, such as jaw=0.15, or plate=0.15,tip=0.2 under "
        "straps; usual ones, which the answer names, if not given.",
    )
    safety: float | None = declare(
        "number",
        "Safety factor on the loads where friction holds the part; 2 if not given.",
        PageLabel("Safety factor", "2"),
        section=LOADS,
    )
    weight: float | None = declare(
        "force",
        "Weight of the part, which helps to hold it where straps press it down.",
        section=LOADS,
        least="0",
        typed="Weight of the part, in N or with its unit, which helps to hold it where straps press it down.",
    )
    raw: Any = declare(
        "margins",
        "For a first operation: by how much the raw block that the jaws touch is larger than the finished part, on each "
        "side, above it and below it; the part itself is held if not given.",
        PageLabel("Raw block: side, top, bottom", "none"),
        section=LOADS,
        called="raw block",
        typed="For a first operation: by how much the raw block that the jaws touch is larger than the finished part, on "
        "each side, above it and below it, such as side=3,top=2,bottom=5; the part itself is held if not given.",
    )
    strapped: int | None = declare(
        "count",
        "For a plate with straps: number of the best seats for which straps are sought; 20 if not given.",
        section=LOADS,
        most=1_000,
        metavar="M",
    )
    seating: int | None = declare(
        "count",
        "For each of the first K fixtures, find how wide the jaws may stand open, or how far the "
        "clamp may be drawn back, so that the part still settles in its place, and where else it "
        "can come to rest. Order these fixtures by that too.",
        PageLabel("Check the first", "none", is_usual=True),
        section=SEATING,
        most=1_000,
        typed="For each of the first K fixtures, find how wide the jaws may stand open, or how far the "
        "clamp may be drawn back, so that the part still settles in its place, and where else it "
        "can come to rest. Order these fixtures by that too (see workhold seat).",
        metavar="K",
    )
    opening: float | None = declare(
        "length",
        "Among the first K fixtures, list only those into which the part settles with the jaws open, "
        "or the clamp drawn back, by this much more than where they hold it; wrong places beyond "
        "this opening do not count.",
        PageLabel("Settles from", "any", is_usual=True),
        section=SEATING,
        needs="seating",
    )
    foolproof: bool = declare(
        "flag",
        "Among the first K fixtures, list only those without a wrong place to rest in, and "
        "those whose wrong places a caliper shows.",
        PageLabel("Only if a caliper shows every wrong place", is_usual=True),
        default=False,
        section=SEATING,
        needs="seating",
    )
    thickness: float | None = declare("length", "Thickness of the part.", section=HEIGHTS)
    peg_height: float | None = declare(
        "length", "Height that pegs reach above the plane on which the part lies.", section=HEIGHTS
    )
