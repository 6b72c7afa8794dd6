"""The program of a result file is written and read in parts, with the bytes and the moves that it has as a whole."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import workhold
from workhold import Program, Query, Vise, answer, load
from workhold.errors import InputError
from workhold.files.result import writer
from workhold.files.result.parts import parse_head
from workhold.files.result.reader import read_result
from workhold.files.result.writer import write_head_json, write_program_json
from workhold.model.cutting_tool import Tool
from workhold.model.moves import SweptPiece, pack_piece, unpack_moves

EXAMPLES = Path(__file__).parents[3] / "examples"


def program(**how: Any) -> Program:
    """That of the bracket."""
    return Program.read(EXAMPLES / "bracket.nc", EXAMPLES / "tools.toml", thickness=12, **how)


@pytest.mark.parametrize("rapid", ["straight", "box"])
@pytest.mark.parametrize("at_once", [1, 7, 2000])
def test_text_in_parts_is_that_of_the_whole(
    rapid: str, at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However many pieces are written at a time, the text is the JSON of the entries, also within a head."""
    monkeypatch.setattr(writer, "AT_ONCE", at_once)
    one = program(rapid=rapid)
    assert "".join(write_program_json(one)) == json.dumps(one.to_dict())
    head = {"format": "x", "program": one.make_head(), "name": "Bügel", "best": None}
    told = json.loads("".join(write_head_json(head, one, ", ")) + "}")
    assert told == {**head, "program": one.to_dict()} and list(told) == list(head)


@pytest.mark.parametrize("rapid", ["straight", "box"])
def test_pieces_are_packed_while_a_head_is_read(rapid: str) -> None:
    """Not one piece is an object once the text is read; the program is the same as from entries, but for feeds."""
    one = program(rapid=rapid)
    entries = parse_head("".join(write_program_json(one)))
    assert {type(piece) for piece in entries["pieces"]} == {bytes}
    read, plain = Program.from_entries(entries), Program.from_entries(one.to_dict())
    assert read == plain and read.pieces == one.pieces
    assert (read.moves.start == one.moves.start).all() and (read.moves.bulge == one.moves.bulge).all()


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda pieces: pieces.pop(4), "the pieces of line"),
        (lambda pieces: pieces.append(dict(pieces[-1])), "the pieces of line"),
        (lambda pieces: pieces[5].update(radius=1.25), "the pieces of line"),
        (lambda pieces: pieces[5].update(z=[1.0, 2.5]), "the pieces of line"),
        (lambda pieces: pieces[5].update(tool=9), "the pieces of line"),
        (lambda pieces: pieces[5].update(kind="drill"), "cannot be used: leave it out"),
        (lambda pieces: pieces[5].update(path=[]), "cannot be used: leave it out"),
        (
            lambda pieces: pieces[5].update(path=[[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 0, 0]]),
            "cannot be used: leave it out",
        ),
        (lambda pieces: pieces[5].update(line=2**70), "cannot be used: leave it out"),
    ],
)
def test_pieces_that_are_none_are_refused(change: Any, sentence: str) -> None:
    """A move that lacks a piece, has one too many or another shape, and what is not a piece at all, name their line."""
    entries = program().to_dict()
    change(entries["pieces"])
    with pytest.raises((InputError, LookupError), match=sentence):
        Program.from_entries(parse_head(json.dumps(entries)))


def test_packed_pieces_make_the_moves_of_their_objects() -> None:
    """One move for each tool's stack of cylinders, its ends and bulge those of the path."""
    one = program()
    moves = unpack_moves([pack_piece(piece.to_dict()) for piece in one.pieces], one.tools)
    assert moves.start.tolist() == one.moves.start.tolist() and moves.line.tolist() == one.moves.line.tolist()
    assert moves.cutting.tolist() == one.moves.cutting.tolist() and not moves.feed.any()
    assert len(unpack_moves([], one.tools)) == 0
    (first, *_) = one.tools[1].cylinders
    corners = ((0, 0, 0), (4, 0, 0), (4, 5, 0), (0, 5, 0), (0, 0, 0))
    box = SweptPiece(3, 1, "rapid", corners, (9, 8), first.radius, (first.low, first.high))
    (line,) = unpack_moves([pack_piece(box.to_dict())], {1: Tool(1, [first], 10)}).line
    assert line == 3


@pytest.mark.thorough
@pytest.mark.parametrize("form", ["json", "npz"])
def test_a_result_comes_back_with_its_program(form: str, tmp_path: Path) -> None:
    """Both forms of a file have all that is swept, and read back to the same list."""
    result = answer(
        Query(load(EXAMPLES / "bracket.dxf"), Vise(20, 2, 4), program=program(), peg_height=6, best=4)
    )
    path = tmp_path / f"a.{form}"
    workhold.save(result, path)
    back = read_result(path)
    assert back.query.program is not None and result.query.program is not None
    assert back.query.program.pieces == result.query.program.pieces
    assert [[peg.hole for peg in one.pegs] for one in back] == [
        [peg.hole for peg in one.pegs] for one in result
    ]
