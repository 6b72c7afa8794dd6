"""Routes of a fixture's seating: what else its pegs can do with the part, and closings from where the part was put."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request

from workhold.errors import InputError
from workhold.model.seating import Seating
from workhold.seating.by_hand import ByHand
from workhold.web.fixture_routes import Rank, Revision, UnitName, ranked
from workhold.web.job_routes import found_job, result_of_job
from workhold.web.seating import ClosingForm, ClosingOrder, Held, seating_answer
from workhold.web.state import at_desk, at_desk_while_heard, state_of

__all__ = ["router"]

router = APIRouter(prefix="/api/jobs/{name}/fixtures/{rank}")


async def seated(request: Request, name: str, rank: int, revision: int | None) -> tuple[Held, Seating | ByHand]:
    """A fixture with its seating, or how it is put into two clamps: worked out once and kept with the job while it is
    used."""
    job = found_job(request, name)
    result = result_of_job(job, revision)
    held = result[ranked(result, rank)], result.workpiece, result.toolkit
    key = (job.revision, rank)
    if key not in job.seatings:
        # On a first run kernels are compiled for it, which takes as long as a search may.
        told = await at_desk(request, "seating", held, state_of(request).limits.seconds)
        job.keep_seating(key, told)
        return held, told
    return held, job.seatings[key]


@router.get("/seating", summary="Whether the part ends up there")
async def seating(
    request: Request, name: str, rank: Rank, unit: UnitName = "mm", revision: Revision = None
) -> dict[str, Any]:
    """From how wide open the part is caught, every other seat of the same pegs, and the same in sentences."""
    held, told = await seated(request, name, rank, revision)
    return {"rank": rank, **seating_answer(held, told, unit)}


@router.post("/closing", summary="Close the jaws from where the part was put")
async def closing(
    request: Request, name: str, rank: Rank, form: ClosingForm, revision: Revision = None
) -> dict[str, Any] | None:
    """The way that part and jaws go without friction, as turn in degrees, x and y of its pose and how far the
    jaws are open beyond where they hold it, in mm, and what it ends in: ``right``,
    ``same place``, ``wrong``, ``elsewhere``, ``stop``, ``outside`` or ``lost``. Who hangs up has it stopped."""
    held, told = await seated(request, name, rank, revision)
    if isinstance(told, ByHand):
        raise InputError("no closing can be played with two clamps: the part is put against its locators by hand.")
    answer: dict[str, Any] | None = await at_desk_while_heard(request, "closing", ClosingOrder(held, told, form))
    return answer
