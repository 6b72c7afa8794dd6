"""A damaged program is read, or refused in one sentence with the line; never does anything else come of it."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from program_examples import PROGRAMS

from workhold import Program
from workhold.errors import InputError

SOURCES = sorted(path for path in PROGRAMS.iterdir() if path.suffix != ".md")
TOOLS = dict.fromkeys(range(30), 6.0)
PIECES = (
    *(
        b"G0 G1 G2 G3 G17 G18 G20 G21 G28 G40 G41 G43 G53 G54 G55 G80 G81 G83 G90 G91 G90.1 G98 G99 G4".split()
    ),
    *(
        b"M0 M3 M6 M30 T1 T99 F0 S-1 X Y5 Z-1e9 I0 J-3 R5 R-1 P2 Q1 L3 K0 A90 H1 D1 N10 O1 % / ( ) ; # [ ] = <".split()
    ),
    *(b"X1e308 Y-.5 Z+ X.. I--1 9999999999999999 .5 - + \xff \xc3\xa9 \t \r \n \x1a \x00".split(b" ")),
)


def damaged(content: bytes, chance: random.Random) -> bytes:
    """A program with one to three faults: words or bytes changed, lost, doubled, moved or put in."""
    for _ in range(chance.randint(1, 3)):
        lines = content.split(b"\n")
        k, other = chance.randrange(len(lines)), chance.randrange(len(lines))
        place = chance.randrange(len(content) + 1)
        kind = chance.randrange(8)
        if kind == 0:
            content = content[:place] + chance.choice(PIECES) + content[place:]
        elif kind == 1:
            content = content[:place] + content[place + chance.randint(1, 5) :]
        elif kind == 2:
            content = content[:place] + bytes([chance.randrange(256)]) + content[place + 1 :]
        elif kind == 3:
            lines[k] += b" " + chance.choice(PIECES)
            content = b"\n".join(lines)
        elif kind == 4:
            lines[k], lines[other] = lines[other], lines[k]
            content = b"\n".join(lines)
        elif kind == 5:
            content = b"\n".join(lines[:k] + lines[k + 1 :])
        elif kind == 6:
            lines[k] = lines[other]
            content = b"\n".join(lines)
        else:
            content = content[:place]
    return content


def read_all(folder: Path, seed: int, count: int) -> tuple[int, int]:
    """Reads damaged programs; returns how many were read and how many were refused."""
    chance = random.Random(seed)
    contents = [path.read_bytes() for path in SOURCES]
    path = folder / "damaged.nc"
    read = refused = 0
    for number in range(count):
        content = damaged(chance.choice(contents), chance)
        path.write_bytes(content)
        try:
            program = Program.read(path, chance.choice((TOOLS, TOOLS, None)), z_zero=0)
        except InputError as error:
            words = str(error).removeprefix(f"{path}: ")
            where = f"number {number}: {words}"
            assert words.isprintable() and words.endswith(".") and 20 < len(words) < 400, where
            known = words.startswith(
                ("line ", "there is no move in it", "the program ", "the file is not text")
            )
            assert known, where
            refused += 1
        else:
            assert np.isfinite(program.moves.start).all() and np.isfinite(program.moves.end).all()
            assert program.moves.line.max() <= content.count(b"\n") + content.count(b"\r") + 1
            read += 1
    return read, refused


def test_damaged_programs_end_in_sentences(tmp_path: Path) -> None:
    """Some hundreds; among them are many that are read and many that are refused."""
    assert min(read_all(tmp_path, 36, 400)) > 60


@pytest.mark.prove
def test_ten_thousand_damaged_programs_end_in_sentences(tmp_path: Path) -> None:
    """The same for ten thousand."""
    assert min(read_all(tmp_path, 1, 10_000)) > 1500
