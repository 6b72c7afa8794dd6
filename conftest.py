"""Leaves out the doctests of modules that import, as they are loaded, what is not installed, such as an extra's library."""

import re
from functools import cache
from importlib.util import find_spec
from pathlib import Path

IMPORT = re.compile(r"^(?:import|from) (\w+)(?:\.\w+)*(?: import | as |,|$)", re.MULTILINE)
is_missing = cache(lambda package: find_spec(package) is None)

collect_ignore = [
    str(path)
    for path in Path(__file__).with_name("src").rglob("*.py")
    if any(map(is_missing, IMPORT.findall(path.read_text(encoding="utf-8"))))
]
