"""A drawing without a unit: refused with both sizes, and on a terminal asked for."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import typer
from reading_helpers import new_dxf, rectangle

from workhold.cli import options


@pytest.fixture
def drawing(tmp_path: Path) -> Path:
    """A plate of 60 by 40, nobody knows of what."""
    document, space = new_dxf(0)
    rectangle(space)
    document.saveas(tmp_path / "plate.dxf")
    return tmp_path / "plate.dxf"


def test_both_sizes_are_shown(run: Callable[..., Any], drawing: Path) -> None:
    """What it would be in mm and in inches, and the option that says which."""
    outcome = run("features", drawing)
    assert outcome.exit_code == 2 and outcome.stdout == ""
    assert (
        "it is 60 mm wide, or 60 in = 1,524 mm; say which with --unit mm (or inch, cm, m)" in outcome.stderr
    )


def test_somebody_at_a_terminal_is_asked(
    run: Callable[..., Any], drawing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The answer is the drawing's unit; one that is none is refused."""
    monkeypatch.setattr(options, "at_terminal", lambda: True)
    answers = iter(["inch", "ell"])
    monkeypatch.setattr(typer, "prompt", lambda *words, **more: next(answers))
    outcome = run("features", drawing)
    assert outcome.exit_code == 0 and "plate: 1524.000 x 1016.000 mm" in outcome.stdout
    assert "it is 60 mm wide" in outcome.stderr
    refused = run("features", drawing)
    assert "Unit 'ell' is not known" in refused.stderr and refused.exit_code == 2
