"""DXF drawings that are nearly right: headers, tables, layouts and entities with single group codes and values replaced."""

from __future__ import annotations

import random
from math import cos, pi, sin

__all__ = ["make_dxf"]

VALUES = (
    *("x", "", "nan", "inf", "-1", "0", "1", "1e308", "-1e308", "1e400", "1e-300", "9" * 400, "4.5", "65535"),
    *("A" * 3000, "\x1b]0;x\x07", "ANSI_9999", "AC9999", "AC1009", "MODEL", "*Model_Space", "Ärger"),
)
CODES = (
    "  0",
    "  2",
    "  5",
    "  8",
    " 10",
    " 20",
    " 40",
    " 42",
    " 62",
    " 70",
    "100",
    "210",
    "330",
    "999",
    "1071",
    "x",
)


def make_dxf(chance: random.Random) -> bytes:
    """A drawing of an outline with holes, blocks, splines and lines doubled, up to four of its tags damaged."""
    tags = header(chance) + tables(chance) + blocks(chance)
    tags += section("ENTITIES", entities(chance)) + objects(chance) + [("  0", "EOF")]
    for _ in range(chance.choice((0, 1, 1, 2, 4))):
        at = chance.randrange(len(tags))
        code, value = tags[at]
        match chance.randrange(6):
            case 0 | 1:
                tags[at] = (code, chance.choice(VALUES))
            case 2:
                tags[at] = (chance.choice(CODES), value)
            case 3:
                del tags[at]
            case 4:
                tags[at] = (code, tags[chance.randrange(len(tags))][1])
            case _:
                tags[at:at] = tags[at : at + chance.randint(1, 12)]
    text = "".join(f"{code}\n{value}\n" for code, value in tags)
    if chance.random() < 0.05:
        text = text[: chance.randrange(len(text) + 1)]
    if chance.random() < 0.1:
        text = text.replace("\n", chance.choice(("\r\n", "\r")))
    return text.encode(
        chance.choice(("utf-8", "cp1252", "utf-16")) if chance.random() < 0.1 else "utf-8", "replace"
    )


Tags = list[tuple[str, str]]


def section(name: str, inside: Tags) -> Tags:
    """A section."""
    return [("  0", "SECTION"), ("  2", name), *inside, ("  0", "ENDSEC")]


def header(chance: random.Random) -> Tags:
    """A header with some of the usual variables; none now and then."""
    if chance.random() < 0.05:
        return []
    variables = [
        ("$ACADVER", [("  1", chance.choice(("AC1009", "AC1015", "AC1021", "AC1032")))]),
        ("$INSUNITS", [(" 70", chance.choice(("4", "4", "4", "1", "0", "5", "99", "x", "nan", "1e400")))]),
        ("$DWGCODEPAGE", [("  3", chance.choice(("ANSI_1252", "ANSI_932", "none")))]),
        ("$EXTMIN", [(" 10", chance.choice(("0", "nan", "1e20"))), (" 20", "0"), (" 30", "0")]),
        ("$HANDSEED", [("  5", chance.choice(("FFFF", "0", "x", "F" * 40)))]),
        ("$MEASUREMENT", [(" 70", "1")]),
    ]
    chosen = [one for one in variables if chance.random() < 0.8]
    return section("HEADER", [tag for name, tags in chosen for tag in (("  9", name), *tags)])


def tables(chance: random.Random) -> Tags:
    """Layers, with odd colours and flags, perhaps twice."""
    if chance.random() < 0.3:
        return []
    rows: Tags = []
    for name in chance.sample(("0", "CUT", "NOTES", "Defpoints", "0"), chance.randint(1, 5)):
        flags, colour = chance.choice(("0", "1", "4", "99999")), chance.choice(("7", "-7", "x"))
        rows += [("  0", "LAYER"), ("  5", f"{chance.randrange(16, 40):X}"), ("100", "AcDbLayerTableRecord")]
        rows += [("  2", name), (" 70", flags), (" 62", colour), ("  6", "CONTINUOUS")]
    table = [("  0", "TABLE"), ("  2", "LAYER"), (" 70", "9"), *rows, ("  0", "ENDTAB")]
    return section("TABLES", table * chance.choice((1, 1, 2)))


def blocks(chance: random.Random) -> Tags:
    """Blocks that insert each other, and sometimes themselves."""
    found: Tags = []
    for k in range(chance.randrange(3)):
        inner = circle(chance, chance.uniform(5, 50), 10) + line((0, 0), (1, 1))
        if chance.random() < 0.5:
            inner += insert(chance, f"B{chance.randrange(3)}")
        found += [("  0", "BLOCK"), ("  8", "0"), ("  2", f"B{k}"), (" 70", "0"), (" 10", "0"), (" 20", "0")]
        found += [*inner, ("  0", "ENDBLK"), ("  8", "0")]
    return section("BLOCKS", found)


def entities(chance: random.Random) -> Tags:
    """A plate of lines or a polyline, with holes, perhaps a line too many, a spline or an ellipse."""
    width, height = chance.uniform(20, 200), chance.uniform(20, 200)
    corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
    found: Tags = []
    if chance.random() < 0.5:
        for start, end in zip(corners, corners[1:] + corners[:1], strict=True):
            found += line(start, end)
    else:
        found += polyline(chance, corners)
    for _ in range(chance.randrange(3)):
        found += circle(chance, chance.uniform(0, width), chance.uniform(0, height))
    if chance.random() < 0.3:
        found += line(chance.choice(corners), (width / 2, chance.choice((0.0, height, height / 2))))
    if chance.random() < 0.3:
        found += line((width, 0.0), (2 * width, 0.0)) + line((2 * width, 0.0), (2 * width, height))
        found += line((2 * width, height), (width, height))
    if chance.random() < 0.3:
        found += spline(chance)
    if chance.random() < 0.2:
        found += insert(chance, f"B{chance.randrange(3)}")
    if chance.random() < 0.2:
        sides = chance.choice((6, 16, 57))
        found += polyline(
            chance, [(9 * cos(2 * pi * k / sides) + 300, 9 * sin(2 * pi * k / sides)) for k in range(sides)]
        )
    return found


def line(start: tuple[float, float], end: tuple[float, float]) -> Tags:
    """A LINE."""
    places = [(" 10", start[0]), (" 20", start[1]), (" 11", end[0]), (" 21", end[1])]
    return [("  0", "LINE"), ("  8", "0"), *((code, repr(value)) for code, value in places)]


def circle(chance: random.Random, x: float, y: float) -> Tags:
    """A CIRCLE or an ARC."""
    tags = [("  8", chance.choice(("0", "CUT"))), (" 10", repr(x)), (" 20", repr(y)), (" 40", "4.5")]
    if chance.random() < 0.7:
        return [("  0", "CIRCLE"), *tags]
    return [
        ("  0", "ARC"),
        *tags,
        (" 50", chance.choice(("0", "20", "-1e9"))),
        (" 51", chance.choice(("360", "200"))),
    ]


def polyline(chance: random.Random, corners: list[tuple[float, float]]) -> Tags:
    """An LWPOLYLINE or an old POLYLINE, some of its corners with bulges."""
    bulge = chance.choice(("0", "0", "0.2", "-0.3", "1e300", "nan"))
    rows = [[(" 10", repr(x)), (" 20", repr(y))] for x, y in corners]
    rows[0].append((" 42", bulge))
    if chance.random() < 0.6:
        head = [("  0", "LWPOLYLINE"), ("100", "AcDbEntity"), ("  8", "0"), ("100", "AcDbPolyline")]
        return [*head, (" 90", str(len(rows))), (" 70", "1"), *(tag for row in rows for tag in row)]
    head = [
        ("  0", "POLYLINE"),
        ("  8", "0"),
        (" 66", "1"),
        (" 70", chance.choice(("1", "1", "9", "16", "4"))),
    ]
    for row in rows:
        head += [("  0", "VERTEX"), ("  8", "0"), *row]
    return [*head, ("  0", "SEQEND"), ("  8", "0")]


def spline(chance: random.Random) -> Tags:
    """A SPLINE, or an ELLIPSE."""
    if chance.random() < 0.3:
        values = [
            (" 10", "50"),
            (" 20", "20"),
            (" 11", "9"),
            (" 21", "0"),
            (" 40", chance.choice(("0.5", "1", "0"))),
        ]
        return [
            ("  0", "ELLIPSE"),
            ("100", "AcDbEntity"),
            ("  8", "0"),
            ("100", "AcDbEllipse"),
            *values,
            (" 41", "0"),
            (" 42", "6.283185307179586"),
        ]
    knots = ["0"] * 4 + ["1"] * 4
    if chance.random() < 0.2:
        chance.shuffle(knots)
    head = [
        ("  0", "SPLINE"),
        ("100", "AcDbEntity"),
        ("  8", "0"),
        ("100", "AcDbSpline"),
        (" 70", "8"),
        (" 71", "3"),
    ]
    head += [(" 72", "8"), (" 73", "4"), *((" 40", knot) for knot in knots)]
    for k in range(4):
        head += [(" 10", repr(300 + 10.0 * k)), (" 20", repr(chance.uniform(0, 20))), (" 30", "0")]
    return head


def insert(chance: random.Random, name: str) -> Tags:
    """An INSERT, perhaps an array of many."""
    count = chance.choice(("1", "1", "2", "300", "32767", "-5"))
    scale = chance.choice(("1", "1", "-1", "0", "1e200"))
    tags = [
        ("  8", "0"),
        ("  2", name),
        (" 10", "60"),
        (" 20", "5"),
        (" 41", scale),
        (" 42", chance.choice(("1", scale))),
    ]
    return [
        ("  0", "INSERT"),
        *tags,
        (" 70", count),
        (" 71", chance.choice(("1", count))),
        (" 44", "9"),
        (" 45", "9"),
    ]


def objects(chance: random.Random) -> Tags:
    """Dictionaries and layouts that name each other, or nothing."""
    if chance.random() < 0.6:
        return []
    rows: Tags = [
        ("  0", "DICTIONARY"),
        ("  5", "C"),
        ("  3", "ACAD_LAYOUT"),
        ("350", chance.choice(("D", "C", "0", "x"))),
    ]
    rows += [
        ("  0", "DICTIONARY"),
        ("  5", "D"),
        ("  3", chance.choice(("Model", "Infinity"))),
        ("350", "1A"),
    ]
    rows += [("  0", "LAYOUT"), ("  5", "1A"), ("100", "AcDbPlotSettings"), ("100", "AcDbLayout")]
    rows += [("  1", chance.choice(("Model", "Layout1"))), ("330", chance.choice(("17", "1F", "D")))]
    return section("OBJECTS", rows)
