"""A program's text as blocks of words, and its comments.

Glossary
--------
block : a line of the program.
word : a letter and a number, such as X12.5.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from string import ascii_lowercase, ascii_uppercase

from attrs import field, frozen

from workhold.errors import InputError, plain

__all__ = ["ProgramBlock", "ProgramText", "program_text"]

# An unsigned number has a digit before its point or behind it.
NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)"
WORD = re.compile(rf"([A-Z])[ \t]*({NUMBER})[ \t]*")
BLOCK = BLOCK_START = re.compile(rf"[ \t]*(?:[A-Z][ \t]*{NUMBER}[ \t]*)*")
COMMENT = re.compile(r"\(([^()]*)\)|;(.*)")
# Programs have a number on Fanuc and Haas, alone in its block.
PROGRAM_NUMBER = re.compile(r"[ \t]*(?:O|:)[ \t]*[0-9]+[ \t]*")
MACRO = re.compile(
    r"[#\[\]=<>]|O[ \t]*[0-9]+[ \t]*[A-Z]|[ \t]*(?:N[0-9]+[ \t]*)?(?:IF|WHILE|GOTO|DO|DEF|REPEAT|CALL|PROC)\b"
)
HEIDENHAIN = re.compile(r"[ \t]*(?:[0-9]+[ \t]+)?(?:BEGIN PGM|TOOL CALL|BLK FORM|L [XYZ][+-]|CYCL DEF|CC X)")
SIEMENS = re.compile(r"[ \t]*(?:N[0-9]+[ \t]*)?(?:CYCLE[0-9]+|MCALL|WORKPIECE|TRANS|ROT|POCKET[0-9]+|MSG)\b")
# The number of the switch may stand behind the slash.
SWITCH = re.compile(r"[ \t]*/[0-9]?")
CAPITALS = str.maketrans(ascii_lowercase, ascii_uppercase)
# Characters of a line that a message shows.
SHOWN = 40
# Characters of a block without its comments; controls take a few hundred.
LONGEST = 2000


@frozen
class ProgramBlock:
    """A line with words.

    Parameters
    ----------
    line : its number, from 1.
    words : letters and the texts of their numbers, in order; without the block's own number.
    """

    line: int
    words: list[tuple[str, str]] = field(repr=False)


@frozen
class ProgramText:
    """A program's blocks up to its end, and what stands beside them.

    Parameters
    ----------
    blocks : those that have words.
    comments : (line, text) of each.
    optional : lines that begin with a slash, which a switch of the machine can leave out.
    behind : lines behind the end of the program, which are not read.
    """

    blocks: list[ProgramBlock] = field(repr=False)
    comments: list[tuple[int, str]] = field(repr=False)
    optional: list[int] = field(repr=False)
    behind: list[int] = field(repr=False)


def program_text(text: str) -> ProgramText:
    """Reads a program's text into blocks, until M2, M30 or a second percent sign ends it.

    Raises
    ------
    InputError
        Beginning with the number of the line that is none.
    """
    found = ProgramText([], [], [], [])
    began = ended = False
    for line, content in numbered(text):
        if ended:
            if content.strip() not in ("", "%"):
                found.behind.append(line)
            continue
        written = without_comments(line, content, found.comments)
        code = written.translate(CAPITALS)
        bare = code.strip()
        if not bare:
            continue
        began, ended = True, bare == "%" and began
        if bare == "%":
            continue
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
                continue
            raise InputError(f"line {line}: {refusal(code, written[len(written) - len(code) :])}")
        words = WORD.findall(code)
        if words and words[0][0] == "N":
            del words[0]
        ended = any(letter == "M" and float(text) in (2, 30) for letter, text in words)
        if words:
            found.blocks.append(ProgramBlock(line, words))
    return found


def numbered(text: str) -> Iterator[tuple[int, str]]:
    """The lines of a text, counted as editors do."""
    return enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), 1)


def without_comments(line: int, content: str, comments: list[tuple[int, str]]) -> str:
    """A line without its comments, which are added to a list.

    Raises
    ------
    InputError
        For a parenthesis without its partner.
    """
    if "(" not in content and ";" not in content and ")" not in content:
        return content
    for match in COMMENT.finditer(content):
        comments.append((line, (match[1] or match[2] or "").strip()))
    code = COMMENT.sub(" ", content)
    if "(" in code or ")" in code:
        raise InputError(
            f"line {line}: a comment is not closed, or has another within, which controls read in different "
            "ways: close it, and take parentheses within it out."
        )
    return code


def refusal(code: str, written: str) -> str:
    """Why a line is not a block, and what helps.

    Parameters
    ----------
    code, written : the line in capitals, and as it stands in the file.
    """
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
            f"'{excerpt(written)}' reckons with variables or names, or calls a subprogram: post the program "
            "with its moves written out, and tools as numbers."
        )
    found = BLOCK_START.match(code)
    place = 0 if found is None else found.end()
    letter, rest = code[place : place + 1], excerpt(written[place:])
    if letter in "*%/":
        return f"'{rest}' cannot stand within a line: take it out."
    if letter.isascii() and letter.isalpha():
        return f"'{rest}' has no number behind its letter: write one, such as {letter}10.5."
    return f"'{rest}' is not a word: write letters with numbers, and remarks in parentheses."


def excerpt(text: str) -> str:
    """The beginning of a text as a message shows it."""
    shown = plain(text.strip())
    return shown if len(shown) <= SHOWN else shown[: SHOWN - 3] + "..."
