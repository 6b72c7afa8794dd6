"""The shapes of answers about jobs and of errors, for the description of the interface.

Answers are made from plain data and are not checked again when they are sent; tests hold them to these
shapes.
"""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

__all__ = ["ErrorAnswer", "JobAddress", "JobAnswer", "PlaceAnswer"]


class AnswerShape(BaseModel):
    """The base of the shapes: every key is named, and none is left out."""

    model_config = ConfigDict(extra="forbid")


class PlaceAnswer(AnswerShape):
    """A place of a drawing, in mm."""

    x: float
    y: float


class ErrorAnswer(AnswerShape):
    """What is wrong."""

    error: str = Field(description="one sentence, with the remedy")
    place: PlaceAnswer | None = Field(description="where in the drawing, if the sentence names a place")


class JobAddress(AnswerShape):
    """Where a job is that was begun."""

    job: str = Field(description="its name: who knows it can see the job")
    url: str = Field(description="its address, with the version of the interface that was asked")


class ArrangementAnswer(AnswerShape):
    """An arrangement of the fixtures of a toolkit."""

    title: str
    words: str


class JobAnswer(AnswerShape):
    """The state of a job, as it is asked for and as its events have it."""

    job: str
    kind: Literal["design", "explore", "family"]
    state: Literal["queued", "running", "listing", "done", "failed", "cancelled"]
    fraction: float = Field(ge=0, le=1, description="how much of it is done")
    found: int = Field(description="fixtures so far")
    seconds: float = Field(description="since it began")
    counts: dict[str, int] | None = Field(description="all fixtures by type, once it is over")
    distinct: dict[str, int] | None = Field(description="those that no symmetry makes the same")
    listed: int = Field(description="fixtures that can be asked for")
    arrangements: list[ArrangementAnswer]
    ranking: list[str] | None = Field(description="figures of quality, the first decides first")
    complete: bool = Field(description="whether the list has every fixture")
    notes: list[str]
    proof: dict[str, Any] | None = Field(description="the account of the proof, once it is over")
    error: str | None = Field(description="why it failed")
    revision: int = Field(description="grows whenever the fixtures or rows have changed")
    table: list[dict[str, Any]] | None = Field(description="the rows of a comparison")
    request: dict[str, Any] = Field(default={}, description="what was asked; not in events")
