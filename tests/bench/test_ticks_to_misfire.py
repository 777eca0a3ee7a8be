"""The page that goes from the file of a counter to a fitted misfire: its files, programs and commands in their order."""

import csv
import json
import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from torsionnet.app.cli import main

PAGE = Path(__file__).parents[2] / "docs" / "how_to" / "ticks_to_misfire.md"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LOST = 0.4
"""Share of its injection that cylinder 4 has lost on the virtual bench."""


@pytest.fixture
def walked(tmp_path, monkeypatch, capsys):
    """What each command of the page printed."""
    monkeypatch.chdir(tmp_path)
    printed = {}
    for language, text in BLOCK.findall(PAGE.read_text(encoding="utf-8")):
        if language == "yaml":
            Path(re.match(r"# (\w+\.yaml)\n", text)[1]).write_text(text, encoding="utf-8")
        elif language == "python":
            exec(compile(text, PAGE.name, "exec"), {})
        elif language == "sh":
            for line in text.replace("\\\n", " ").splitlines():
                assert main(shlex.split(line)[1:]) == 0, (line, capsys.readouterr())
                printed[line] = capsys.readouterr().out
    return printed


@pytest.mark.slow
def test_ticks_of_a_counter_end_in_the_misfire_of_the_bench(walked, capsys):
    shown = re.search(r"^```text\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)[1]
    with Path("ticks.csv").open(encoding="utf-8") as file:
        rows = list(csv.reader(file))
    assert [",".join(row) for row in rows[:4]] == shown.splitlines()
    counts = np.array([int(row[0]) for row in rows[1:]])
    assert (counts < 2**24).all()
    assert (np.diff(counts) < 0).sum() == int(20 * 80e6 / 2**24)  # wraps in 20 s
    assert len(counts) == 930 / 60 * 60 * 20

    ranked = next(text for line, text in walked.items() if "--rank" in line)
    assert "only a misfire of cylinder 4 of engine (40 % of its injection lost) explains the misfit" in ranked
    assert main(["fit", "misfire.yaml", "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)["parameters"]
    assert found["value"] == pytest.approx(LOST, abs=1e-4)
