"""What shells ask for when somebody presses Tab."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from workhold.cli.main import COMMANDS

BASH = shutil.which("bash")
TRY = """
eval "$(workhold completion bash)"
for line in "workhold " "workhold fea" "workhold show r.json 1 --dr" "workhold nothing --"; do
    IFS=' ' read -ra COMP_WORDS <<< "$line"
    [[ $line == *" " ]] && COMP_WORDS+=("")
    COMP_CWORD=$(( ${#COMP_WORDS[@]} - 1 ))
    _workhold_completion workhold
    echo "${COMPREPLY[@]}"
done
"""


@pytest.mark.thorough
@pytest.mark.skipif(BASH is None, reason="there is no bash")
def test_bash_completes_commands_and_options(tmp_path: Path) -> None:
    """With the script that the command prints; after a word that is not a command there are the options of all."""
    starter = tmp_path / "workhold"
    starter.write_text(f"#!{sys.executable}\nfrom workhold.__main__ import run\nrun()\n")
    starter.chmod(0o755)
    environment = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"}
    outcome = subprocess.run(
        [str(BASH), "--norc", "-c", TRY], capture_output=True, text=True, env=environment
    )
    assert (
        outcome.stdout.splitlines() == [" ".join(COMMANDS), "features", "--draw", "--version --help"]
        and not outcome.stderr
    )


@pytest.mark.parametrize(
    ("shell", "words"), [("bash", "complete -o default"), ("zsh", "compdef"), ("FISH", "complete --command")]
)
def test_every_shell_has_its_script(run: Any, shell: str, words: str) -> None:
    outcome = run("completion", shell)
    assert outcome.exit_code == 0 and words in outcome.stdout and "_WORKHOLD_COMPLETE" in outcome.stdout


def test_other_shells_are_refused(run: Any) -> None:
    outcome = run("completion", "cmd")
    assert outcome.exit_code == 2 and "give bash, zsh or fish" in outcome.stderr
