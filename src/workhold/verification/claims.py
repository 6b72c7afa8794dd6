"""What a result claims of the seating of its first fixtures, as it is written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from attrs import evolve, frozen

from workhold.files.result.seating_forms import checked_seating
from workhold.model.fixture import Fixture, Pose
from workhold.model.query import Query
from workhold.model.seating import Seating

__all__ = ["Claim", "claim_of", "with_claims"]


@frozen
class Claim:
    """The seating of a fixture.

    Parameters
    ----------
    fields : as they are written.
    told : their meaning in the model, which works out again what follows from other fields.
    """

    fields: Mapping[str, Any]
    told: Seating

    @property
    def capture_opening(self) -> float | None:
        """The capture opening that is claimed, in mm."""
        return self.told.capture_opening


def claim_of(fields: Any, pose: Pose, query: Query, path: Path | str, number: int) -> Claim:
    """The claim that fields make of a fixture, counted from 1, in a pose.

    Raises
    ------
    InputError
        When they cannot be used.
    """
    told = checked_seating(fields, pose, Path(path), number)
    return Claim(fields, told.in_toolkit(query.toolkit, query.opening))


def with_claims(fixtures: Sequence[Fixture], query: Query, path: Path | str = "the result") -> list[Fixture]:
    """Fixtures, whose seating is given by fields or is one of the model, with what is claimed of it.

    Raises
    ------
    InputError
        When fields cannot be used.
    """
    out = list(fixtures)
    for place, fixture in enumerate(out):
        told = fixture.seating
        if told is not None:
            fields = told.as_fields() if isinstance(told, Seating) else told
            out[place] = evolve(fixture, seating=claim_of(fields, fixture.pose, query, path, place + 1))
    return out
