"""Settings of the whole suite: property tests draw the same examples every time and know no deadline; kernels that only
kernels call can be called by tests too."""

from __future__ import annotations

import os

# Before the first kernel is imported.
os.environ.setdefault("WORKHOLD_KERNELS", "callable")

# Commands that tests run have buffered streams, as a user's have.
os.environ.pop("PYTHONUNBUFFERED", None)

from hypothesis import HealthCheck, settings

settings.register_profile(
    "workhold",
    deadline=None,
    derandomize=True,
    print_blob=False,
    max_examples=60,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("workhold")
