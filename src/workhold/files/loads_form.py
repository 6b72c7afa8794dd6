"""The shape of a loads file, for its JSON Schema; what it means is read by ``files.loads_file``."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

__all__ = ["LoadsFile"]

Point = Annotated[list[float | str], Field(min_length=2, max_length=2)] | str
Angles = Annotated[list[float | str], Field(min_length=2, max_length=2)]


class LoadTable(BaseModel):
    """One load: a force at a point or along a path, a moment, or both."""

    model_config = ConfigDict(extra="forbid")

    name: str = ""
    force: float | str = Field(default=0.0, description="in N, or with a unit: 0.2 kN, 45 lbf")
    at: Point | None = Field(default=None, description="where the force acts; or path")
    path: Annotated[list[Point], Field(min_length=2)] | str | None = Field(
        default=None, description="the points it runs along"
    )
    direction: float | str | Angles = Field(
        default="any", description="degrees in the part's frame: 30, 30..60, [30, 60] or any"
    )
    moment: float | str = Field(default=0.0, description="in N mm, or with a unit: 5 N.m, 40 lbf.in")


class LoadsFile(BaseModel):
    """What a cutter, a drill or a hand does to the part."""

    model_config = ConfigDict(extra="forbid")

    unit: str | None = Field(default=None, description="of at and path: mm, cm, m or inch")
    load: list[LoadTable] = Field(min_length=1)
