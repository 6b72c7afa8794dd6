"""STEP files read in the process that asks: starting one of its own takes longer than all that tests read there."""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib import import_module
from multiprocessing.connection import Connection
from typing import Any

__all__ = ["READERS", "read_here", "run_here", "work_reading_here"]

# What reads by ``files.apart.run_apart``.
READERS = tuple(f"workhold.files.step.{name}" for name in ("reader", "by_height", "part_shape", "solids"))


def run_here(module: str, content: bytes, options: Mapping[str, Any], what: str) -> Any:
    """What ``files.apart.run_apart`` returns, by way of JSON as well, so that nothing is passed that JSON does not hold."""
    reader = import_module(module)
    reader.prepare()
    return json.loads(json.dumps(reader.read_as_plain_data(content, **json.loads(json.dumps(dict(options))))))


def read_here() -> None:
    """Lets this process read without another from now on."""
    for name in READERS:
        vars(import_module(name))["run_apart"] = run_here


def work_reading_here(connection: Connection, kind: str, memory_bytes: int) -> None:
    """``web.tasks.run_worker``, the main function of a server's worker, in one that reads without another process."""
    from workhold.web.tasks import run_worker

    if kind == "desk":
        read_here()
    run_worker(connection, kind, memory_bytes)
