"""What tasks took: a file of lines beside the records, which tells nothing about whether a task is done.

Records are the same bytes wherever and however fast they came to be, so this is kept apart from them. Each line is appended
at once, so that two runs can write one file; a line cut short by the end of a run is passed over.
"""

from __future__ import annotations

import os
from pathlib import Path

from attrs import define, field

from workhold.batch.tasks import Outcome
from workhold.files.atomic import plain_errors
from workhold.plain import plain

__all__ = ["Measured"]


@define(eq=False)
class Measured:
    """Seconds and workers of tasks, by name.

    Parameters
    ----------
    path : of the file, in a folder that is there when the first line is added.
    known : what it held, and what was added.
    """

    path: Path
    known: dict[str, tuple[float, str]] = field(factory=dict, init=False)

    def __attrs_post_init__(self) -> None:
        try:
            lines = self.path.read_text(encoding="utf-8", errors="replace").splitlines()
        except OSError:
            return
        for line in lines:
            name, _, rest = line.partition(",")
            seconds, comma, worker = rest.partition(",")
            if comma and worker:
                try:
                    self.known[name] = (float(seconds), worker)
                except ValueError:
                    continue

    def add(self, outcome: Outcome) -> None:
        """Write down what a task took.

        Raises
        ------
        InputError
            When the file cannot be written.
        """
        worker = plain(outcome.worker) or "-"
        self.known[outcome.name] = (outcome.seconds, worker)
        with plain_errors(self.path):
            self.path.parent.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
            try:
                os.write(descriptor, f"{outcome.name},{outcome.seconds:.6f},{worker}\n".encode())
            finally:
                os.close(descriptor)
