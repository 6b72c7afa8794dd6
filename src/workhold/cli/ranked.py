"""A fixture of a result file, asked for by its rank."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from workhold.cli.values import whole_number
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.model.result import Result

__all__ = ["RankArgument", "ResultArgument", "asked_rank", "result_with"]

ResultArgument = Annotated[
    str, typer.Argument(metavar="RESULT", help="A result file (JSON or npz) written by workhold design.")
]
RankArgument = Annotated[str, typer.Argument(metavar="N", help="Which fixture, by rank: 1 is the best.")]


def asked_rank(text: str) -> int:
    """A rank from 1.

    Raises
    ------
    InputError
        For anything else.
    """
    rank = whole_number("fixture", text)
    if rank < 1:
        raise InputError(f"there is no fixture {rank}: fixtures are counted from 1, the best one.")
    return rank


def result_with(path: str, rank: int) -> Result:
    """The result of a file that lists a fixture of a rank.

    Raises
    ------
    InputError
        When the file cannot be used, or lists fewer.
    """
    from workhold.files.result.reader import read_result

    result = read_result(path)
    if rank > len(result):
        raise InputError(f"{path} lists {len(result)} fixtures: there is no fixture {rank}.")
    return result
