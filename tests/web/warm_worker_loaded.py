"""Imported by the process that ``warm_worker`` forks workers from: everything that workers load."""

from workhold.web.tasks import warm_up

for kind in ("search", "desk"):
    warm_up(kind)
