"""Subprograms of a file: the blocks of a program in the order in which a control runs them.

M98 P100 runs the blocks behind O100 until M99, M97 P100 those from the block N100 on; L is the number of
repeats. On Fanuc, a P with five or more digits has the subprogram's number in its last four digits, and the
number of repeats before them.

Glossary
--------
call : a block with M98 or M97; its other words take effect before the call.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from attrs import define, evolve

from workhold.errors import InputError
from workhold.files.budget import LIMITS, Budget
from workhold.files.program.words import (
    CALLS,
    RETURN,
    SWITCHED_END,
    ProgramBlock,
    ProgramText,
    normalize_code,
)

__all__ = ["expand_calls"]

# Calls within calls; controls take from 4 to 10.
MOST_CALLS = 10
MOST_REPEATS = 9999
# Letters of words that may stand beside a call, and of those that belong to it.
BESIDE, OF_CALLS = frozenset("GMSF"), frozenset("PL")
Starts = dict[tuple[str, float], list[int]]


@define
class RunningSubprogram:
    """A subprogram that runs.

    Parameters
    ----------
    begin : index of its first block.
    back : index of the block behind its call.
    left : number of runs left, this one included.
    call : line and words of its call, for messages.
    program : number of the program that contains it.
    """

    begin: int
    back: int
    left: int
    call: str
    program: int | None

    def make_endless_error(self) -> InputError:
        """Return the error for a subprogram without M99."""
        return InputError(f"{self.call} a subprogram without an end: write M99 behind its last block.")


def expand_calls(listing: ProgramText) -> ProgramText:
    """Return the text with its subprograms written out where they are called; unchanged if it has no calls.

    Raises InputError for a call of a subprogram that is not in the file, a subprogram without an end, and an
    M99 outside any subprogram.
    """
    if not any(block.functions & {*CALLS, RETURN} for block in listing.blocks):
        return listing
    blocks = list(run_blocks(listing.blocks, set(listing.optional)))
    ran = {block.line for block in blocks}
    last = next((block.line for block in listing.blocks if block.ends), 0)
    called = {block.line for block in listing.blocks if block.functions & {*CALLS, RETURN}}
    behind = [block.line for block in listing.blocks if block.line > last > 0]
    left = [line for line in behind if line not in ran | called]
    return evolve(listing, blocks=blocks, behind=sorted({*listing.behind, *left}))


def run_blocks(blocks: Sequence[ProgramBlock], optional: set[int]) -> Iterator[ProgramBlock]:
    """Yield blocks in the order in which they run, without calls and M99, up to the program's end.

    ``optional`` has the lines that begin with a slash. Raises InputError in the cases of
    :func:`expand_calls`.
    """
    running: list[RunningSubprogram] = []
    starts = find_subprogram_starts(blocks)
    budget, index = Budget(LIMITS["program"]), 0
    while index < len(blocks):
        block = blocks[index]
        index += 1
        try:
            budget.spend()
        except InputError as error:
            raise InputError(f"line {block.line}: {error}") from error
        if running and block.program != running[-1].program:
            raise running[-1].make_endless_error()
        try:
            if block.functions & CALLS.keys():
                call = begin_call(blocks, starts, block, index)
                if len(running) == MOST_CALLS:
                    raise InputError(
                        f"subprograms call each other more than {MOST_CALLS} deep: post the program with its moves "
                        "written out."
                    )
                yield from remove_call_from_block(block)
                running.append(call)
                index = call.begin
                continue
            if RETURN not in block.functions:
                yield block
                if block.ends and block.line in optional and index < len(blocks):
                    raise InputError(SWITCHED_END)
                if block.ends:
                    return
                continue
            refuse_return(block, bool(running), block.line in optional)
        except InputError as error:
            raise InputError(f"line {block.line}: {error}") from error
        yield from remove_call_from_block(block)
        last = running[-1]
        last.left -= 1
        index = last.begin if last.left else last.back
        if not last.left:
            running.pop()
    if running:
        raise running[-1].make_endless_error()


def begin_call(
    blocks: Sequence[ProgramBlock], starts: Starts, block: ProgramBlock, back: int
) -> RunningSubprogram:
    """Return the subprogram that a block calls; ``back`` is the index of the block after the call.

    Raises InputError for a subprogram that is not in the file or is in it twice, and for words that a call
    cannot have.
    """
    given = {letter: float(text) for letter, text in block.words if letter in OF_CALLS}
    code = min(block.functions & CALLS.keys())
    other = next(
        (letter for letter, _ in block.words if letter not in BESIDE | OF_CALLS or "6" in block.functions),
        None,
    )
    if other is not None or block.ends:
        raise InputError(
            f"M{code} stands in a block with a move, a tool change or the end: write that in a block of its own."
        )
    number, repeats = given.get("P"), given.get("L", 1.0)
    if number is None or number != int(number):
        raise InputError(
            f"M{code} calls a subprogram without its number P: post the program with its moves written out."
        )
    found = starts.get((CALLS[code], number), [])
    if not found and code == "98" and number >= 10_000 and "L" not in given:
        # Fanuc's short form: how often, and four digits of the program.
        repeats, number = divmod(int(number), 10_000)
        found = starts.get(("O", number), [])
    name = f"{CALLS[code]}{number:g}"
    if len(found) != 1:
        where = "is not in this file" if not found else "stands more than once in this file"
        raise InputError(
            f"M{code} calls the subprogram {name}, which {where}: post the program with its moves written out, or "
            "put the subprogram into the file once."
        )
    if repeats != int(repeats) or not 1 <= repeats <= MOST_REPEATS:
        raise InputError(
            f"M{code} runs {name} {repeats:g} times: write a whole number from 1 to {MOST_REPEATS}."
        )
    call = f"line {block.line}: M{code} calls {name},"
    return RunningSubprogram(found[0], back, int(repeats), call, blocks[found[0]].program)


def find_subprogram_starts(blocks: Sequence[ProgramBlock]) -> Starts:
    """Return the indices of the blocks at which subprograms begin, by letter ("N" or "O") and number."""
    starts: Starts = {}
    before: int | None = None
    for index, block in enumerate(blocks):
        if block.number is not None:
            starts.setdefault(("N", block.number), []).append(index)
        if block.program is not None and block.program_line != before:
            starts.setdefault(("O", block.program), []).append(index)
        before = block.program_line
    return starts


def refuse_return(block: ProgramBlock, is_called: bool, is_optional: bool) -> None:
    """Raise InputError for an M99 that does not simply return to the block after the call.

    That is an M99 outside a subprogram, on a line with a slash, or with P. ``is_called`` tells whether a
    subprogram is running, ``is_optional`` whether the line begins with a slash.
    """
    if not is_called:
        raise InputError("M99 stands outside of a subprogram, where the program begins anew: write M30.")
    if is_optional:
        raise InputError(
            "a switch (/) decides whether the subprogram ends here: take the slash out, or the line."
        )
    if any(letter == "P" for letter, _ in block.words):
        raise InputError("M99 with P goes on at another block: post the program with its moves written out.")


def remove_call_from_block(block: ProgramBlock) -> Iterator[ProgramBlock]:
    """Yield the block without its call or M99, if any words are left."""
    is_call = bool(block.functions & CALLS.keys())
    words = [
        (letter, text)
        for letter, text in block.words
        if not (letter == "M" and normalize_code(text) in {*CALLS, RETURN})
        and not (is_call and letter in OF_CALLS)
    ]
    if words:
        yield evolve(block, words=words)
