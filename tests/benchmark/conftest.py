"""Complete lists of small sets of each kind, made once, and the checker loaded from the file that users copy out."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import workhold
from workhold.benchmark.catalogue import find_set, format_set_text
from workhold.benchmark.making import make_list

Content = dict[str, Any]


@pytest.fixture(scope="session")
def checker() -> ModuleType:
    """The checker, as its own file and nothing else."""
    path = Path(workhold.__file__).parent / "data" / "benchmark" / "check.py"
    found = spec_from_file_location("benchmark_check", path)
    assert found is not None and found.loader is not None
    module = module_from_spec(found)
    sys.modules[found.name] = module
    found.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def set_texts() -> Callable[[str], str]:
    """The text of a set's file by name, made by a search the first time."""
    known: dict[str, str] = {}

    def text(name: str) -> str:
        if name not in known:
            made = make_list(find_set(name), threads=1)
            assert made is not None
            known[name] = format_set_text(*made)
        return known[name]

    return text


@pytest.fixture
def content(set_texts: Callable[[str], str]) -> Callable[[str], Content]:
    """The content of a set's file by name, a new copy each time."""

    def copied(name: str) -> Content:
        made: Content = json.loads(set_texts(name))
        return made

    return copied
