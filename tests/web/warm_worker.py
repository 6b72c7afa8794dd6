"""Workers of tests' servers, forked from a process that has loaded what they need: starting one takes no second.

``test_serve_command`` starts a server as a user does.
"""

from __future__ import annotations

import os
import sys
from functools import cache
from multiprocessing import forkserver, get_context
from typing import Any

import pytest

__all__ = ["warm_context"]


@cache
def warm_context() -> Any:
    """The context in place of "spawn"; its first process is started once for each process of tests."""
    context = get_context("forkserver")
    context.set_forkserver_preload([f"{__name__}_loaded"])
    with pytest.MonkeyPatch.context() as patch:
        # Where the forked ones find what these tests import, and as few threads as in a worker of its own.
        patch.setenv("PYTHONPATH", os.pathsep.join(sys.path))
        patch.setenv("OPENBLAS_NUM_THREADS", "1")
        forkserver.ensure_running()
    return context
