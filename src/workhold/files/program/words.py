"""A program's text as blocks of words with comments; its codes: groups, refusals, and the state of a control.

Of the codes of a group, one is in force at a time, and a block may have one: T. R. Kramer, F. M. Proctor, E.
Messina, "The NIST RS274NGC interpreter, version 3", NISTIR 6556, 2000, "Modal groups". Cycles are a group of
their own here, as on Fanuc and Haas.

Glossary
--------
block : a line of the program.
word : a letter and a number, such as X12.5.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Set
from functools import cache
from string import ascii_lowercase, ascii_uppercase
from typing import NoReturn

from attrs import define, field, frozen

from workhold.errors import InputError, make_printable
from workhold.units import INCH, MILLIMETRE, Unit

__all__ = [
    "CALLS",
    "CANCEL",
    "CYCLES",
    "FUNCTIONS",
    "GROUPS",
    "LOOK_AHEAD",
    "NOSE",
    "NUMBERED",
    "OTHER_UNITS",
    "RETURN",
    "SWITCHED_END",
    "UNITS",
    "VISITS",
    "ControlState",
    "ProgramBlock",
    "ProgramText",
    "normalize_code",
    "is_spline",
    "parse_program_text",
    "refuse_code",
    "refuse_function",
]

# Drilling, tapping and boring; those that come up at the feed as they went down.
CYCLES = ("73", "74", "81", "82", "83", "84", "85", "86", "89")
AT_FEED_UP = ("74", "84", "85", "89")
MOTIONS = ("0", "1", "2", "3")
# Cancels the cycle in force; the motion before it goes on, as on Fanuc and Haas.
CANCEL = "80"
# Zeros of the control; Haas has twenty more of them as G110 to G129, and all as G154 with P.
OFFSETS: tuple[str, ...] = ("54", "55", "56", "57", "58", "59", "59.1", "59.2", "59.3", "54.1", "154")
OFFSETS += tuple(str(number) for number in range(110, 130))
# Those that P numbers; G54 of some controls too.
NUMBERED = ("54", "54.1", "154")
# How a control looks ahead, smooths and rounds, and what it watches, with the letters that belong to it: none
# of them says where the path goes.
LOOK_AHEAD: Mapping[str, str] = {
    "23": "",
    "67": "",
    "255": "",
    "5": "PQR",
    "5.1": "PQR",
    "8": "P",
    "9": "",
    "61": "P",
    "61.1": "PQR",
    "62": "",
    "64": "PQ",
    "103": "P",
    "187": "PE",
}
# Moves to places of the machine's own.
VISITS = ("28", "30", "53")
GROUPS: Mapping[str, str] = {
    **dict.fromkeys(MOTIONS, "motion"),
    **dict.fromkeys((CANCEL, *CYCLES), "cycle"),
    **dict.fromkeys(("17", "18", "19"), "plane"),
    **dict.fromkeys(("20", "21"), "unit"),
    **dict.fromkeys(("90", "91"), "distance"),
    **dict.fromkeys(("90.1", "91.1"), "centre"),
    **dict.fromkeys(("93", "94", "95"), "feed"),
    **dict.fromkeys(("98", "99"), "return"),
    **dict.fromkeys(("43", "49"), "length"),
    **dict.fromkeys(OFFSETS, "offset"),
    **dict.fromkeys(("61", "61.1", "62", "64"), "path"),
    **dict.fromkeys(("4", *VISITS, "52", "92", "92.1", "92.2"), "once"),
    # Of these a block may have several.
    **{code: f"look-ahead G{code}" for code in ("5", "5.1", "8", "9", "23", "67", "103", "187", "255")},
    # A unit on some controls, a pattern of holes on others.
    **dict.fromkeys(("70", "71"), "other unit"),
    "40": "compensation",
    "15": "polar",
    "50": "scale",
    "69": "rotation",
    "97": "speed",
}
# M0 to M9 and M30; none moves the tool but for M6. All others are passed over and listed, but for those that
# do more than switch something.
FUNCTIONS = (*(str(number) for number in range(10)), "30")
ENDS = frozenset(("2", "30"))
# What calls a subprogram, with the letter of the number at which it begins, and what leads back.
CALLS: Mapping[str, str] = {"97": "N", "98": "O"}
RETURN = "99"

COMPENSATION = (
    "offsets the path by a radius that only the control knows: post the program with the compensation made "
    "by the computer"
)
CYCLE = "is a cycle that is not read: post the program with its moves written out"
ZERO = "sets another zero: post the program with one zero, and give it where it lies on the part"
TURNED = "turns, mirrors or scales the axes: post the program without"
SUBPROGRAM = "calls a subprogram: post the program with its moves written out"
REASONS: Mapping[str, str] = {
    **dict.fromkeys(("41", "42", "41.1", "42.1"), COMPENSATION),
    **dict.fromkeys(("12", "13", "76", "84.2", "84.3", "87", "88", "81.2", "150"), CYCLE),
    **dict.fromkeys(("10", "52", "92", "92.1", "92.2", "92.3"), ZERO),
    **dict.fromkeys(("16", "51", "51.1", "50.1", "68", "68.2"), TURNED),
    **dict.fromkeys(("65", "66", "67"), SUBPROGRAM),
    **dict.fromkeys(
        ("43.1", "43.2", "43.4", "44"), "shifts the tool's length in a way that is not read: use G43"
    ),
    **dict.fromkeys(
        ("70", "71", "72"), "means other things on other controls: write G20 or G21 for the unit"
    ),
    **dict.fromkeys(
        ("38.2", "38.3", "38.4", "38.5", "31"), "probes, so that the path is not known: take it out"
    ),
    **dict.fromkeys(("5", "5.1", "5.2", "5.3", "6.2"), "is a spline: post the program with lines and arcs"),
}
FUNCTION_REASONS: Mapping[str, str] = {
    "198": SUBPROGRAM,
    **dict.fromkeys(("46", "96"), "jumps to another line: post the program with its moves written out"),
    **dict.fromkeys(("16", "61"), "puts a tool into the spindle in a way that is not read: write M6"),
    "72": "brings codes back that were in force before: write those that are meant",
}
UNITS = {"20": INCH, "21": MILLIMETRE, "inch": INCH, "mm": MILLIMETRE}
OTHER_UNITS = {"70": INCH, "71": MILLIMETRE}
# An unsigned number has a digit before its point or behind it.
NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)"
WORD = re.compile(rf"([A-Z])[ \t]*({NUMBER})[ \t]*")
BLOCK = re.compile(rf"[ \t]*(?:[A-Z][ \t]*{NUMBER}[ \t]*)*")
COMMENT = re.compile(r"\(([^()]*)\)|;(.*)")
# A comment with others within, behind the first end of which nothing stands but further ends.
WITHIN = re.compile(r"\(([^();]*\([^);]*\)(?:[ \t]*\))*[ \t]*)\)")
# Programs have a number on Fanuc and Haas, alone in its block.
PROGRAM_NUMBER = re.compile(r"[ \t]*(?:O|:)[ \t]*[0-9]+[ \t]*")
MACRO = re.compile(
    r"[#\[\]=<>]|O[ \t]*[0-9]+[ \t]*[A-Z]|[ \t]*(?:N[0-9]+[ \t]*)?(?:IF|WHILE|GOTO|DO|DEF|REPEAT|CALL|PROC)\b"
)
HEIDENHAIN = re.compile(r"[ \t]*(?:[0-9]+[ \t]+)?(?:BEGIN PGM|TOOL CALL|BLK FORM|L [XYZ][+-]|CYCL DEF|CC X)")
SIEMENS = re.compile(r"[ \t]*(?:N[0-9]+[ \t]*)?(?:CYCLE[0-9]+|MCALL|WORKPIECE|TRANS|ROT|POCKET[0-9]+|MSG)\b")
# grbl's own lines. Questions to it, and the word that unlocks it, move nothing; $H sends all axes to the
# machine's own ends, as G28 to its zero. What writes its settings ($100=250) is refused.
QUESTION = re.compile(r"\?|\$(?:\$|#|G|I|N|X)?")
HOMING = "$H"
# The number of the switch may stand behind the slash.
SWITCH = re.compile(r"[ \t]*/[0-9]?")
CAPITALS = str.maketrans(ascii_lowercase, ascii_uppercase)
SWITCHED_END = (
    "a switch (/) decides whether the program ends here, and there is more behind it: take "
    "the slash out, or the line."
)
NO_FUNCTION: frozenset[str] = frozenset()
# Characters of a line that a message shows.
SHOWN = 40
# Characters of a block without its comments; controls take a few hundred.
LONGEST = 2000


@cache
def normalize_code(text: str) -> str:
    """Return the number of a code without leading and trailing zeros.

    Examples
    --------
    >>> normalize_code("01"), normalize_code("91.1"), normalize_code("28.")
    ('1', '91.1', '28')
    """
    return f"{float(text):.10g}"


def refuse_code(code: str) -> NoReturn:
    """Raise InputError for a code of letter G, with the reason why it is not supported."""
    reason = REASONS.get(code, "is not known: take it out, or write the moves that it makes")
    raise InputError(f"G{code} {reason}.")


def refuse_function(code: str) -> None:
    """Raise InputError for an M code that the reader does not support because it may move or change
    something.
    """
    if code in FUNCTION_REASONS:
        raise InputError(f"M{code} {FUNCTION_REASONS[code]}.")


def is_spline(code: str, letters: Set[str], turns: float) -> bool:
    """Return whether a code is G5 or G5.1 in its meaning as a curve.

    The same codes may also switch how a control looks ahead; then, and for all other codes, the answer is
    False.

    Parameters
    ----------
    letters : letters of the block's words.
    turns : value of P, which calls a stored path from 10001 on; 0 where there is none.
    """
    return code in ("5", "5.1") and (bool(letters & set("XYZIJL")) or turns > 10_000)


# No tool length is in force in a program that has some otherwise: Z is that of the spindle's nose.
NOSE = "nose"


@define
class ControlState:
    """The part of a control's state that determines the path; lengths in mm, from the program's own zero.

    Parameters
    ----------
    unit : unit of lengths; None until the program gives it.
    motion : code of the motion in force, None before the first.
    cycle : code of the drill cycle in force, None outside one.
    plane, distance, centre, feed_kind, back : codes in force.
    offset : code of the zero in force.
    place : x, y and z of the tip, None where it is not known.
    lost : reason why each of x, y and z is not known; empty if the program has not given it yet.
    named : whether the program has given any of x, y and z.
    length : name of the tool length in force, such as H2 or T2; None before any is given, :data:`NOSE` where
        heights are those of the spindle's nose.
    called, tool : number in the last word T, and number of the tool in the spindle; None before the first.
    feed, spindle : as they are written.
    sticky : values of the cycle in force by their letters, in mm; Z and R are heights.
    initial : height at which the cycle in force began.
    """

    unit: Unit | None = None
    motion: str | None = None
    cycle: str | None = None
    plane: str = "17"
    distance: str = "90"
    centre: str = "91.1"
    feed_kind: str = "94"
    back: str = "98"
    offset: str = "54"
    place: list[float | None] = field(factory=lambda: [None, None, None])
    lost: list[str] = field(factory=lambda: ["", "", ""])
    named: bool = False
    length: str | None = None
    called: int | None = None
    tool: int | None = None
    feed: float = 0.0
    spindle: float = 0.0
    sticky: dict[str, float] = field(factory=dict)
    initial: float | None = None


@frozen
class ProgramBlock:
    """A line with words.

    Parameters
    ----------
    line : its number, from 1.
    words : letters and the texts of their numbers, in order; without the block's own number.
    number : the block's number N; None without one.
    program, program_line : number (O) of the program that contains it, and the line of that O; None before
        any O.
    functions : codes of its words M.
    """

    line: int
    words: list[tuple[str, str]] = field(repr=False)
    number: float | None = None
    program: int | None = None
    program_line: int | None = None
    functions: frozenset[str] = frozenset()

    @property
    def ends(self) -> bool:
        """Whether the program ends with this block."""
        return bool(self.functions & ENDS)


@frozen
class ProgramText:
    """A program's blocks up to its end, with its comments and special lines.

    Parameters
    ----------
    blocks : those that have words; also those behind the end where a subprogram is called.
    comments : (line, text) of each.
    optional : lines that begin with a slash, which a switch of the machine can leave out.
    asked : lines with questions to the control, which move nothing.
    behind : lines behind the end of the program, which are not read.
    """

    blocks: list[ProgramBlock] = field(repr=False)
    comments: list[tuple[int, str]] = field(repr=False)
    optional: list[int] = field(repr=False)
    asked: list[int] = field(repr=False)
    behind: list[int] = field(repr=False)


def parse_program_text(text: str) -> ProgramText:
    """Return a program's text as blocks, until M2, M30 or a second percent sign ends it.

    If a subprogram is called, blocks behind M30 are included, up to the percent sign. Raises InputError, with
    the line, for a line that is not a block.
    """
    found = ProgramText([], [], [], [], [])
    began = ended = is_closed = calls = False
    program: int | None = None
    program_line: int | None = None
    for line, content in number_lines(text):
        if ended:
            if content.strip() not in ("", "%"):
                found.behind.append(line)
            continue
        written = strip_comments(line, content, found.comments)
        code = written.translate(CAPITALS)
        bare = code.strip()
        if not bare:
            continue
        began, ended = True, bare == "%" and began
        is_closed = ended
        if bare == "%":
            continue
        if QUESTION.fullmatch(bare):
            found.asked.append(line)
            continue
        if bare == HOMING:
            code = "G28"
        if bare.startswith("/"):
            found.optional.append(line)
            code = SWITCH.sub("", code)
        if len(code) > LONGEST:
            raise InputError(
                f"line {line}: it has {len(code):,} characters, more than the {LONGEST:,} of a block: break "
                "it."
            )
        if BLOCK.fullmatch(code) is None or "O" in code:
            if PROGRAM_NUMBER.fullmatch(code):
                program, program_line = int(code.strip(" \tO:")), line
                continue
            raise InputError(f"line {line}: {explain_refusal(code, written[len(written) - len(code) :])}")
        words = WORD.findall(code)
        number = None
        if words and words[0][0] == "N":
            number = float(words.pop(0)[1])
        functions = NO_FUNCTION
        if "M" in code:
            functions = frozenset(normalize_code(text) for letter, text in words if letter == "M")
        calls = calls or bool(functions & CALLS.keys())
        ended = bool(functions & ENDS) and not calls
        if words or number is not None:
            found.blocks.append(ProgramBlock(line, words, number, program, program_line, functions))
    if found.behind and found.blocks and found.optional[-1:] == [found.blocks[-1].line] and not is_closed:
        raise InputError(f"line {found.optional[-1]}: {SWITCHED_END}")
    return found


def number_lines(text: str) -> Iterator[tuple[int, str]]:
    """Yield (number, line) for the lines of a text, from 1; LF, CR and CR LF end lines."""
    return enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), 1)


def strip_comments(line: int, content: str, comments: list[tuple[int, str]]) -> str:
    """Return a line without its comments, which are appended to ``comments`` with the line's number.

    When comments are nested, some controls end the outer comment at the first closing parenthesis, others at
    the last. Nested comments are accepted if nothing stands between these two parentheses. Raises InputError
    for a parenthesis without its partner.
    """
    if "(" not in content and ";" not in content and ")" not in content:
        return content
    if content.count("(") > 1 and len(content) <= LONGEST:
        for match in WITHIN.finditer(content):
            whole = match[0]
            if whole.count("(") == whole.count(")") and ";" not in content[: match.start()]:
                comments.append((line, match[1].strip()))
                content = content.replace(whole, " ", 1)
    for match in COMMENT.finditer(content):
        comments.append((line, (match[1] or match[2] or "").strip()))
    code = COMMENT.sub(" ", content)
    if "(" in code or ")" in code:
        raise InputError(
            f"line {line}: a comment is not closed, or has another within, which controls read in different "
            "ways: close it, and take parentheses within it out."
        )
    return code


def explain_refusal(code: str, written: str) -> str:
    """Return a sentence on why a line is not a block, with a remedy.

    ``code`` is the line in capitals, ``written`` as it stands in the file.
    """
    if code.lstrip().startswith("$"):
        return (
            f"'{shorten_excerpt(written)}' speaks to the control itself, and may set how far it moves: take it out, and "
            "send it before the program."
        )
    if HEIDENHAIN.match(code):
        return (
            "this is Heidenhain's plain language, not RS-274: post the program for an ISO control, such as "
            "Haas, Fanuc or LinuxCNC."
        )
    if SIEMENS.match(code):
        return (
            "this is a call of Siemens' own language, not RS-274: post the program for another ISO control, "
            "such as Haas, Fanuc or LinuxCNC, with its moves written out."
        )
    if MACRO.search(code):
        return (
            f"'{shorten_excerpt(written)}' reckons with variables or names, or calls a subprogram: post the program "
            "with its moves written out, and tools as numbers."
        )
    found = BLOCK.match(code)
    place = 0 if found is None else found.end()
    letter, rest = code[place : place + 1], shorten_excerpt(written[place:])
    if letter in "*%/":
        return f"'{rest}' cannot stand within a line: take it out."
    if letter.isascii() and letter.isalpha():
        return f"'{rest}' has no number behind its letter: write one, such as {letter}10.5."
    return f"'{rest}' is not a word: write letters with numbers, and remarks in parentheses."


def shorten_excerpt(text: str) -> str:
    """Return a text without unprintable characters, cut to ``SHOWN`` characters."""
    shown = make_printable(text.strip())
    return shown if len(shown) <= SHOWN else shown[: SHOWN - 3] + "..."
