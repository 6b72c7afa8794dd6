"""The fields of every kind of toolkit, one row each, from which files, requests, options and the page are
made.

A new field, or one with another meaning for a new kind, is a row here and an argument of the kind's
constructor.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations_with_replacement

from workhold.fixels.contacts import DIRECTIONS, TOWARDS
from workhold.fixels.table import (
    CLAMPS_SECTION,
    HEIGHTS_SECTION,
    REQUIRED,
    Choice,
    LiftedLimit,
    PageLabel,
    ToolkitField,
)

# The names of kinds that people give, and what they are.
NAMES: Mapping[str, str] = {
    "vise": "a vise that clamps the part by closing",
    "opening-vise": "a vise that clamps by opening, from inside the part's holes or around a waist",
    "gripper": "a vise of one column",
    "plate": "three locators on a plate of holes, and a clamp or two",
    "fence": "a straight wall that the part lies flush against, one locator and a clamp",
    "flat-jaw": "a vise with one flat jaw, and two pegs on the other",
    "plain-vise": "a vise with two flat jaws, which hold the part by friction, on parallels",
    "strapped": "three locators on a plate of holes, and strap clamps that hold the part down by friction",
}


def name_direction_pair(one: str, other: str) -> str:
    """Return the words for the directions in which two clamps push, on a plan with y up.

    >>> name_direction_pair("-x", "-y"), name_direction_pair("-x", "-x"), name_direction_pair("-x", "+x")
    ('to the left and downward', 'both to the left', 'against each other, to the left and right')
    """
    if one == other:
        return f"both {TOWARDS[one]}"
    against = "against each other, " if one[1] == other[1] else ""
    return (
        f"{against}{TOWARDS[one]} and {TOWARDS[other].removeprefix('to the ') if against else TOWARDS[other]}"
    )


ONE_CLAMP, TWO_CLAMPS = {"clamps": 1}, {"clamps": 2}
WAYS = tuple(Choice(way, TOWARDS[way]) for way in DIRECTIONS)
# Half a turn of a plate makes the other pairs of these; a fence turns with the plate, so that there all pairs
# differ.
DISTINCT = (("-x", "-y"), ("-x", "+y"), ("-x", "-x"), ("-y", "-y"), ("-x", "+x"), ("-y", "+y"))
PAIRS = tuple(Choice([one, other], name_direction_pair(one, other)) for one, other in DISTINCT)
ALL_PAIRS = tuple(
    Choice([*two], name_direction_pair(*two)) for two in combinations_with_replacement(DIRECTIONS, 2)
)

PITCH = ToolkitField(
    "pitch",
    "pitch",
    "Distance between neighbouring holes, one for both directions or X,Y.",
    (PageLabel("Pitch", is_usual=True),),
    default=REQUIRED,
    entry="write the distance between holes as one number, or [x, y]",
    missing="distance between holes",
    belongs_to="holes",
)
COLUMNS = ToolkitField(
    "columns",
    "count",
    "Columns of holes on each jaw, or on the plate: as many as needed if not given.",
    (PageLabel("Columns a jaw", is_usual=True),),
    default=REQUIRED,
    entry="write how many columns of holes each jaw has, such as columns = 2",
    missing="columns",
    most=200,
    belongs_to="holes",
)
PEG_RADIUS = ToolkitField(
    "peg_radius",
    "length",
    "Radius of the pegs where they touch the part.",
    (PageLabel("Peg radius", is_usual=True),),
    default=REQUIRED,
    entry="write the radius of the pegs as a number",
    missing="pegs' radius",
    least="0",
    belongs_to="pegs",
)
BODY_RADIUS = ToolkitField(
    "body_radius",
    "length",
    "Radius of the pegs' thickest part, such as a shoulder below the part; the peg radius if not given.",
    (PageLabel("Shoulder radius", "peg radius"),),
    figure="radius of the pegs' bodies",
    follows="peg_radius",
    at_least="peg_radius",
    below="body radius {value:g} is less than the peg radius {least:g}: give the peg radius or more, in mm.",
    lifted=LiftedLimit("bodies that would overlap", "bodies", "with pegs without a shoulder"),
    least="0",
    belongs_to="jaws",
)
FLAT = ToolkitField(
    "flat",
    "flat",
    (
        "Distance of a peg's flat from the peg's centre, and half the flat's width. The peg is "
        "turned so that the flat lies on straight faces."
    ),
    (PageLabel("Centre to flat", "round, no flat"),),
    entry="write its distance from a peg's centre, or that and half its width, such as [2.5, 1.5]",
    least="0",
    belongs_to="pegs",
)
ROWS = ToolkitField(
    "rows",
    "count",
    "Rows of holes; as many as needed if not given.",
    (PageLabel("Rows a jaw", "as needed"),),
    lifted=LiftedLimit("rows of holes", "holes", "with as many rows as needed"),
    most=100_000,
    belongs_to="holes",
)
BLOCKED = ToolkitField(
    "blocked",
    "holes",
    "Holes that no peg can stand in: L-B3,R-A1; L-B is a whole column. May be repeated.",
    (PageLabel("Blocked holes", "L-B3, R-A"),),
    default=(),
    figure="blocked",
    entry='write a list of holes and columns by name, such as ["L-B3", "R-A"]',
    carriers=("left", "right"),
    carrier_noun="jaw",
    lifted=LiftedLimit("blocked holes", "holes", "with no hole blocked"),
    belongs_to="jaws",
)
MIN_GAP = ToolkitField(
    "min_gap",
    "length",
    "Smallest distance along x from a left peg's centre to a right peg's; the x pitch if not given.",
    (PageLabel("Smallest gap", "pitch x"),),
    figure="smallest gap between left and right pegs",
    follows="pitch",
    is_always_shown=True,
    least="0",
    belongs_to="jaws",
)
MAX_OPENING = ToolkitField(
    "max_opening",
    "length",
    "Largest distance from the left jaw's last column to the right jaw's first; no limit if not given.",
    (PageLabel("Largest opening", "no limit"),),
    figure="largest opening",
    unset="no limit",
    at_least="min_gap",
    below="max opening {value:g} is below the min gap {least:g}: no opening is left.",
    lifted=LiftedLimit("largest opening", "travel", "with a larger opening"),
    belongs_to="jaws",
)
JAW_WIDTH = ToolkitField(
    "jaw_width",
    "length",
    "For a flat jaw: the width of the jaws, with the peg plate in their middle; endless if "
    "not given. Needs the number of columns.",
    (PageLabel("Width of the jaws", "endless"),),
    figure="width of the jaws",
    unset="endless",
    lifted=LiftedLimit("width of the jaws", "reach", "with a flat jaw as wide as the part"),
    belongs_to="flat jaw",
    entry="write the width of the jaws as a number",
)
ROW_OFFSET = ToolkitField(
    "row_offset",
    "length",
    "Height of the right jaw's rows above the left jaw's.",
    (PageLabel("Row offset", "0"),),
    figure="right rows above left rows",
    default=0.0,
    least="any",
    belongs_to="jaws",
)
CLAMPS = ToolkitField(
    "clamps",
    "count",
    "1 or 2 clamps; two are needed together, as for a plain rectangle square to the plate. 1 if not given.",
    (PageLabel("Clamps", "1", is_usual=True, choices=(Choice(1, "one"), Choice(2, "two, needed together"))),),
    default=1,
    figure="clamps, needed together",
    entry="write 1 or 2",
    allowed=(1, 2),
    belongs_to="clamp beside its jaws",
    most=2,
    section=CLAMPS_SECTION,
    metavar="1|2",
)
CLAMP_RADIUS = ToolkitField(
    "clamp_radius",
    "length",
    "Radius of the clamp's round tip; the peg radius if not given.",
    (PageLabel("Clamp tip radius", "as a locator"),),
    figure="radius of the clamp's tip",
    follows="peg_radius",
    is_always_shown=True,
    least="0",
    belongs_to="clamp beside its jaws",
    section=CLAMPS_SECTION,
)
TRAVEL = ToolkitField(
    "travel",
    "span",
    "Stroke of the clamp: the least and the most from the hole of its bolt to its tip. If "
    "not given, any stroke does, and the clamp's body is not checked.",
    (PageLabel("Stroke", "any"),),
    figure="from the clamp's hole to its tip",
    unset="any",
    lifted=LiftedLimit("stroke of the clamp", "travel", "with a clamp of any stroke"),
    entry="write the least and the most from the clamp's hole to its tip, such as [10, 35]",
    least="0",
    belongs_to="clamp beside its jaws",
    section=CLAMPS_SECTION,
)
DIRECTION = ToolkitField(
    "directions",
    "directions",
    "Directions in which the clamp may push: among -x, +x, -y, +y, such as {option}=-x,-y. "
    "If not given, all directions that a turn of the plate does not make equal to another "
    "one. For two clamps give pairs, such as {option}=-x:-y,-x:+y, or single directions for "
    "all pairs of them.",
    (
        PageLabel("The clamp pushes", "all that differ", several=True, choices=WAYS, when=ONE_CLAMP),
        PageLabel("The clamps push", "across each other", several=True, choices=PAIRS, when=TWO_CLAMPS),
    ),
    figure="the part is pushed along",
    entry='write a list of "-x", "+x", "-y" and "+y", or of two clamps a list of pairs such as ["-x", "-y"]',
    belongs_to="clamp beside its jaws",
    section=CLAMPS_SECTION,
    word="direction",
)
WALL_OFFSET = ToolkitField(
    "wall_offset",
    "length",
    "For a fence: distance from its wall to the centres of the first row of holes; must be given.",
    (PageLabel("Fence to row 1", is_usual=True),),
    figure="from the fence to the first row of holes",
    default=REQUIRED,
    entry="write the distance from the fence to the first row of holes",
    missing="distance from the first row of holes",
    at_least="peg_radius",
    below="wall offset {value:g} is less than the peg radius {least:g}: a locator in the first row would "
    "stand in the fence; give the distance from the fence to the first row of holes, in mm.",
    belongs_to="wall",
    section=CLAMPS_SECTION,
)


def make_heights_field(carrier: str, whose: str, belongs_to: str) -> ToolkitField:
    """Return the field ``<carrier>_heights``: the lower and the upper end of the elements on a carrier.

    Parameters
    ----------
    carrier : first part of the field's name, such as "clamp".
    whose : words for the element with these heights, such as "the clamp's tip".
    belongs_to : the part of a toolkit that the field describes.
    """
    return ToolkitField(
        f"{carrier}_heights",
        "heights",
        f"Heights between which {whose} can touch, above the plane on which the part lies. If not "
        "given, they reach up to the peg height, as all pegs do.",
        (PageLabel(f"Heights of {whose}", "as all pegs"),),
        figure=f"heights of {whose}",
        entry="write the lower and the upper end above the plane on which the part lies, such as [6, 14]",
        least="0",
        belongs_to=belongs_to,
        section=HEIGHTS_SECTION,
    )


LEFT_HEIGHTS = make_heights_field("left", "the left jaw's pegs", "jaws with pegs")
RIGHT_HEIGHTS = make_heights_field("right", "the right jaw's pegs", "jaws with pegs")
LOCATOR_HEIGHTS = make_heights_field("locator", "the locators", "locators")
CLAMP_HEIGHTS = make_heights_field("clamp", "the clamp's tip", "clamp beside its jaws")
WALL_HEIGHTS = make_heights_field("wall", "the straight wall", "wall")
JAW_HEIGHTS = make_heights_field("jaw", "the jaw's pegs", "single jaw with pegs")

JAW_HEIGHT = ToolkitField(
    "jaw_height",
    "length",
    "Flat jaws: how high they stand above the vise's bed; any height if not given.",
    (PageLabel("Height of the jaws", "any", is_usual=True),),
    figure="height of the jaws above the bed",
    unset="any",
    belongs_to="pair of flat jaws",
)
JAW_THICKNESS = ToolkitField(
    "jaw_thickness",
    "length",
    "Flat jaws: how thick they are at their top, for the tools of a program; endless if not given.",
    (PageLabel("Thickness of the jaws", "endless"),),
    figure="thickness of the jaws",
    unset="endless",
    belongs_to="pair of flat jaws",
)
PARALLELS = ToolkitField(
    "parallels",
    "lengths",
    "Heights of the parallels in the drawer, one fixture for each, such as 20,25,32; the part lies on the bed if "
    "not given.",
    (PageLabel("Parallels", "none", is_usual=True),),
    default=(),
    figure="parallels",
    entry="write a list of heights, such as [20, 25, 32]",
    least="0",
    belongs_to="bed",
)
PARALLEL_THICKNESS = ToolkitField(
    "parallel_thickness",
    "length",
    "How thick the parallels are, for drills and cutters that come through the part; 8 mm if not given.",
    (PageLabel("Thickness of the parallels", "8 mm"),),
    figure="thickness of the parallels",
    unset="taken to be 8 mm",
    least="above 0",
    belongs_to="bed",
    is_optional_key=True,
)
LEAST_GRIP = ToolkitField(
    "least_grip",
    "length",
    "Least height that both flat jaws must grip.",
    (PageLabel("Grip at least", "3 mm"),),
    default=3.0,
    figure="least grip",
    belongs_to="pair of flat jaws",
)
STOP = ToolkitField(
    "stop",
    "choice",
    "At which end of the flat jaws the work stop is; both: one fixture for each. Without one the part lies in the "
    "middle.",
    (
        PageLabel(
            "Work stop",
            "none",
            is_usual=True,
            choices=(
                Choice(None, "none"),
                Choice("left", "at the left end"),
                Choice("right", "at the right end"),
                Choice("both", "left and right, each a set-up"),
            ),
        ),
    ),
    figure="work stop",
    unset="none",
    entry='write "left", "right" or "both"',
    choices=("left", "right", "both"),
    belongs_to="work stop",
)
STOP_OFFSET = ToolkitField(
    "stop_offset",
    "length",
    "How far inward from the end of the jaws the stop touches the part.",
    (PageLabel("Stop inward by", "0"),),
    default=0.0,
    figure="stop from the jaws' end",
    least="any",
    belongs_to="work stop",
)
STOP_WIDTH = ToolkitField(
    "stop_width",
    "length",
    "How wide the work stop is, across the jaws, for the tools of a program; 7 % of the jaws' width if not given.",
    (PageLabel("Width of the work stop", "7 % of the jaws"),),
    figure="width of the work stop",
    unset="7 % of the jaws' width",
    least="above 0",
    belongs_to="work stop",
    is_optional_key=True,
)
MAX_FORCE = ToolkitField(
    "max_force",
    "force",
    "Rated force of the vise, in N or with its unit.",
    (PageLabel("Rated force", "not known"),),
    figure="rated force",
    unset="not known",
    entry="write the force in N as a number",
    belongs_to="rated force",
)
SCREW_LEAD = ToolkitField(
    "screw_lead",
    "length",
    "The vise's screw: how far one turn moves the jaw, for the torque that closes it.",
    (PageLabel("Lead of the screw", "not known"),),
    figure="lead of the screw",
    unset="not known",
    belongs_to="screw",
)
STRAPS = ToolkitField(
    "straps",
    "count",
    "How many strap clamps press the part down, 1 to 4; 2 if not given.",
    (PageLabel("Straps", "2", is_usual=True),),
    default=2,
    figure="straps",
    entry="write 1, 2, 3 or 4",
    allowed=(1, 2, 3, 4),
    most=4,
    belongs_to="straps",
)
TIP_RADIUS = ToolkitField(
    "tip_radius",
    "length",
    "Radius of a strap's round tip.",
    (PageLabel("Strap tip radius", "6 mm"),),
    default=6.0,
    figure="radius of a strap's tip",
    is_always_shown=True,
    entry="write the radius of a strap's tip",
    belongs_to="straps",
)
STRAP_REACH = ToolkitField(
    "reach",
    "span",
    "For straps: least and greatest distance from the middle of the bolt's hole to the tip.",
    (PageLabel("Straps reach", "20 to 60 mm"),),
    default=(20.0, 60.0),
    figure="from a strap's bolt to its tip",
    entry="write the least and the most from the bolt's hole to the tip, such as [20, 60]",
    least="0",
    belongs_to="straps",
)
STRAP_HEIGHT = ToolkitField(
    "strap_height",
    "length",
    "How high a strap stands above the face that it presses on, with nut and stud, for the tools of a program; six radii "
    "of its tip if not given.",
    (PageLabel("Strap above its face", "6 tip radii"),),
    figure="height of a strap above its face",
    unset="six radii of the tip",
    least="above 0",
    belongs_to="straps",
)
STRAPS_OVER = ToolkitField(
    "over",
    "choice",
    "What lies under the straps: the plate, with the whole foot of the part on it, or three supports, each tip over one "
    "of them; the plate if not given.",
    (
        PageLabel(
            "Straps press over",
            "the plate",
            choices=(Choice("plate", "the plate"), Choice("supports", "three supports")),
        ),
    ),
    default="plate",
    figure="what straps press the part onto",
    entry='write "plate" or "supports"',
    choices=("plate", "supports"),
    belongs_to="straps",
)
BOLT_PITCH = ToolkitField(
    "bolt_pitch",
    "pitch",
    "Distance between the holes for the straps' bolts, one for both directions or X,Y; the dowels' own holes take the "
    "bolts if not given.",
    (PageLabel("Pitch of bolt holes", "dowel holes"),),
    figure="pitch of the bolts' holes",
    unset="the dowels' own",
    entry="write the distance between holes for bolts as one number, or [x, y]",
    belongs_to="bolts",
)
BOLT_OFFSET = ToolkitField(
    "bolt_offset",
    "pitch",
    "From the first dowel hole to the first hole for a bolt, one length for both directions or X,Y.",
    (PageLabel("Bolt holes from hole A1", "0"),),
    default=(0.0, 0.0),
    figure="first bolt hole from the first dowel hole",
    least="any",
    entry="write the distance from the first dowel hole to the first hole for a bolt, or [x, y]",
    belongs_to="bolts",
)

# All fields, in the order of the command's help; a kind may show some of them in another way.
OPTIONS = (
    PITCH,
    COLUMNS,
    PEG_RADIUS,
    BODY_RADIUS,
    FLAT,
    ROWS,
    BLOCKED,
    MIN_GAP,
    MAX_OPENING,
    JAW_WIDTH,
    ROW_OFFSET,
    CLAMPS,
    CLAMP_RADIUS,
    TRAVEL,
    DIRECTION,
    WALL_OFFSET,
    LEFT_HEIGHTS,
    RIGHT_HEIGHTS,
    LOCATOR_HEIGHTS,
    CLAMP_HEIGHTS,
    WALL_HEIGHTS,
    JAW_HEIGHTS,
    JAW_HEIGHT,
    JAW_THICKNESS,
    PARALLELS,
    PARALLEL_THICKNESS,
    LEAST_GRIP,
    STOP,
    STOP_OFFSET,
    STOP_WIDTH,
    MAX_FORCE,
    SCREW_LEAD,
    STRAPS,
    TIP_RADIUS,
    STRAP_REACH,
    STRAP_HEIGHT,
    STRAPS_OVER,
    BOLT_PITCH,
    BOLT_OFFSET,
)
ON_A_PLATE = (
    PITCH,
    COLUMNS.relabel(
        PageLabel("Columns", "as needed", is_usual=True),
        default=None,
        lifted=LiftedLimit("columns of holes", "holes", "with as many columns as needed"),
    ),
    ROWS.relabel(PageLabel("Rows", "as needed", is_usual=True)),
    PEG_RADIUS.relabel(PageLabel("Locator radius", is_usual=True)),
)
