"""Section of a report on loops of a component bench: numbers, stages and remarks, in German as well."""

import pytest
from support.command_line import run
from support.loop_records import stage_record

import torsionnet as tn
from torsionnet.signals import loops

DRIFTING = "das Drehmoment driftet um"


def written(tmp_path, language, **given):
    path = tmp_path / "bench.md"
    tn.write_report("dmf_component", path, sections=["loops"], date=None, language=language, **given)
    return path.read_text(encoding="utf-8")


@pytest.fixture
def found():
    return loops(stage_record(3, drift=1.5), "T", "gamma")


def test_numbers_stages_and_remarks_are_those_of_the_loops(found, tmp_path):
    found.to_json(tmp_path / "loops.json")
    path = tmp_path / "bench.md"
    run("report", "dmf_component", "--loops", tmp_path / "loops.json", "--section", "loops", "-o", path)
    text = path.read_text(encoding="utf-8")
    assert "Loops of the component bench" in text
    assert "loops_1.svg" in text
    (loop,) = found.loops
    for stage in loop.stages:
        row = next(line for line in text.splitlines() if line.startswith(f"| {stage.side} | {stage.number} |"))
        assert f"{stage.stiffness.value:.4g}" in row
    assert f"{loop.secant_stiffness.value:.4g}" in text
    assert "the torque drifts by" in text


def test_words_and_remarks_are_german(found, tmp_path):
    text = written(tmp_path, "de", loops=[found])
    assert DRIFTING in text
    assert "Reibmoment" in text
    assert not [line for line in text.splitlines() if line.startswith("- ") and " the " in line]


def test_without_loops_there_is_no_section(tmp_path):
    assert "Loops of" not in written(tmp_path, "en")
