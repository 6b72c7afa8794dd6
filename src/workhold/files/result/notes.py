"""Notes in result files: their sentences under ``notes``, and the data of each under ``note_data``.

Files of older versions have the sentences alone. Only this module recognizes such sentences: it compares each
with the sentences of all notes that fit its numbers and the query.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any, get_origin, get_type_hints

from attrs import fields
from pydantic import BaseModel, ConfigDict, Field, ValidationError, create_model

from workhold.errors import InputError
from workhold.files.result.forms import Head, describe_first_fault
from workhold.model.notes import (
    KINDS,
    STAGES,
    AskedFor,
    BestOnly,
    Cut,
    FittedOutline,
    KeptBest,
    LeftUndecided,
    MoreSystems,
    NoFixture,
    NoPair,
    NoPlace,
    Note,
    PushedByHand,
    Remark,
    Seated,
    Stopped,
    UndecidedSystem,
)
from workhold.model.query import Query

__all__ = ["find_note_faults", "read_notes"]


def read_notes(head: Head, query: Query) -> tuple[Note, ...]:
    """Return the notes of a file, from their data, or from their sentences alone in an older file.

    Raises
    ------
    InputError
        When the number of entries of data is not that of the sentences, or an entry cannot be used.
    """
    if head.note_data is None:
        verified = 0 if head.proof is None else head.proof.verified
        return tuple(recognize_note(sentence, query, verified) for sentence in head.notes)
    if len(head.note_data) != len(head.notes):
        raise InputError(
            f"note_data has {len(head.note_data)} entries beside {len(head.notes)} notes: it needs one for "
            "each."
        )
    pairs = zip(head.notes, head.note_data, strict=True)
    return tuple(make_note(*pair, query, number) for number, pair in enumerate(pairs))


def find_note_faults(head: Head, notes: Sequence[Note]) -> Iterator[str]:
    """Yield a message for each sentence in a head that
    differs from the words of the note made from its data.
    """
    for sentence, note in zip(head.notes, notes, strict=True):
        if sentence != note.words:
            yield f'the note "{sentence[:80]}" is not what its data say, "{note.words[:80]}"'


def make_note(sentence: str, part: BaseModel, query: Query, number: int) -> Note:
    """Return the note of an entry of data; one of an unknown kind becomes a remark with the sentence.

    ``number`` is the entry's index, for the InputError that is raised for impossible data.
    """
    entry = part.model_dump()
    if (kind := KINDS.get(entry["kind"])) is None:
        return Remark(sentence)
    try:
        given = find_note_form(kind.kind).model_validate(entry).model_dump()
        note = kind(**given, **({"wording": query.toolkit.wording} if has_wording(kind) else {}))
        # It may have data that no sentence can be made of.
        str(note)
    except ValidationError as error:
        key, reason = describe_first_fault(error)
        raise InputError(f"note_data.{number}.{key} cannot be used: {reason}.") from error
    except (ValueError, LookupError) as error:
        raise InputError(f"note_data.{number} cannot be used: no note is like that.") from error
    return note


def has_wording(kind: type[Note]) -> bool:
    """Return whether a kind of note has a field for the toolkit's wording."""
    return any(one.name == "wording" for one in fields(kind))


@cache
def find_note_form(name: str) -> type[BaseModel]:
    """Return the pydantic model that checks the data of notes of a kind, given the kind's name.

    Keys that the kind does not know are allowed.
    """
    kind = KINDS[name]
    hints = get_type_hints(kind)
    # JSON has lists for tuples.
    keys: dict[str, Any] = {
        one.name: (hints[one.name], Field(strict=False) if get_origin(hints[one.name]) is tuple else ...)
        for one in fields(kind)
        if one.eq
    }
    return create_model(
        f"{kind.__name__}Part", __config__=ConfigDict(strict=True, allow_inf_nan=False), **keys
    )


NUMBER = re.compile(r"[-+]?\d+(?:,\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?")


def recognize_note(sentence: str, query: Query, verified: int) -> Note:
    """Return the note whose words the sentence is; a remark with the sentence if no note has these words.

    ``verified`` is the number of verified candidates of the result.
    """
    words = [word.replace(",", "") for word in NUMBER.findall(sentence)]
    thinkable = list_possible_notes([float(word) for word in words], query, verified)
    return next((note for note in thinkable if note.words == sentence), Remark(sentence))


def list_possible_notes(numbers: Sequence[float], query: Query, verified: int) -> Iterator[Note]:
    """Yield all notes whose sentence, for a query, can have exactly the given numbers in this order."""
    wording, asked = query.toolkit.wording, query.asked_of_places
    whole = [int(number) for number in numbers]
    yield PushedByHand()
    yield FittedOutline(query.workpiece.departure)
    if query.restricted_by:
        yield AskedFor(query.restricted_by)
    for stage in STAGES:
        yield from (NoFixture(stage, wording, line) for line in (None, *whole))
        if asked and stage in STAGES[:2]:
            yield NoFixture(stage, wording, asked=asked)
    yield from (NoPlace(verified, wording, with_body) for with_body in (False, True))
    yield from (NoPair(seats, contacts) for contacts in (0, verified) for seats in (0, *whole))
    match whole:
        case [one]:
            yield from (BestOnly(one), LeftUndecided(one), MoreSystems(one), Stopped(numbers[0]))
        case [one, other]:
            yield from (Cut(one, other), KeptBest(one, other), Seated(one, other))
    if len(whole) in (9, 12):
        yield UndecidedSystem(tuple(whole[2::3]), tuple(whole[::3]), tuple(whole[1::3]))
