"""The software paper: its citations exist, its length is that of the journal, its script says what it lacks."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

PAPER = Path(__file__).parents[2] / "paper"
TEXT = (PAPER / "paper.md").read_text(encoding="utf-8")


def test_every_citation_has_an_entry_and_every_entry_is_cited():
    entries = set(re.findall(r"^@\w+\{(\w+),", (PAPER / "paper.bib").read_text(encoding="utf-8"), re.MULTILINE))
    assert set(re.findall(r"@(\w+)[\],;]", TEXT.partition("# Summary")[2])) == entries


def test_length_is_what_the_journal_asks_for():
    assert 750 <= len(re.findall(r"\w+", TEXT.partition("# Summary")[2])) <= 1750


@pytest.mark.slow
def test_script_says_that_opentorsion_is_missing():
    environment = {name: value for name, value in os.environ.items() if name != "OPENTORSION_PYTHON"}
    run = subprocess.run(
        [sys.executable, PAPER / "compare_with_opentorsion.py"],
        check=False,
        capture_output=True,
        text=True,
        env={**environment, "PYTHONPATH": str(PAPER.parent)},
    )
    assert run.returncode == 4
    assert "pip install opentorsion==0.3.2" in run.stderr
