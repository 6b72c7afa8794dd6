"""Leaves out the doctests of what needs an extra that is not installed."""

from importlib.util import find_spec

collect_ignore = [] if find_spec("anywidget") else ["src/workhold/presenting/widget.py"]
