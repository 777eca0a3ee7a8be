"""Phases of ``.ci/run`` and parts of the night: what stops a run, what is counted, what a change reaches."""

import sys

import pytest
from phases import nightly, running
from phases.__main__ import STEPS, WHOLE
from phases.running import Phase, Run
from support import fixed_work

BUSY = "import time\nwhile time.process_time() < 0.2: pass"
CHILD = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {BUSY!r}])"


def phase(name, program="pass", quiet=0.1, **more):
    return Phase(name, (sys.executable, "-c", program), quiet, **more)


@pytest.fixture
def carried_out(monkeypatch, capfdbinary):
    """Carry steps out on a machine of a given slowness; (exit code, run, output)."""

    def call(*steps, limit=10.0, slowness=1.0):
        monkeypatch.setattr(fixed_work, "slowness", lambda _: slowness)
        monkeypatch.setattr(running.signal, "signal", lambda *_: None)
        run = Run("phases", limit)
        code = run.carry_out(steps)
        return code, run, capfdbinary.readouterr().out.decode()

    return call


def test_the_first_failure_ends_all_and_the_table_says_what_ran(carried_out):
    code, run, text = carried_out(
        [[phase("good", "print('3 passed in 1 s')")]], [[phase("bad", "exit(3)")]], [[phase("later")]]
    )
    assert code == 1
    assert [row.phase.name for row in run.rows] == ["good", "bad"]
    assert text.endswith("== FAILED: phase bad (exit code 3)\n")
    assert "3 passed in 1 s\n== good: ok" in text
    assert any(line.startswith("good") and line.endswith("  3 passed in 1 s") for line in text.splitlines())


def test_a_failure_ends_the_lane_beside(carried_out):
    code, run, _ = carried_out([[phase("long", "import time; time.sleep(600)")], [phase("bad", "exit(1)")]])
    assert code == 1
    assert [row.phase.name for row in run.rows] == ["bad"]
    assert run.rows[0].wall < 300


def test_lanes_run_at_once_and_are_shown_whole(carried_out, tmp_path):
    wait = "import sys, time, pathlib as p; p.Path({0!r}).touch(); print({0!r}, flush=True)\nwhile not p.Path({1!r}).exists(): time.sleep(0.01)\nprint('end')"
    here, there = str(tmp_path / "a"), str(tmp_path / "b")
    code, _, text = carried_out([[phase("one", wait.format(here, there))], [phase("two", wait.format(there, here))]])
    assert code == 0
    assert f"== one\n{here}\nend\n== one: ok" in text
    assert f"== two\n{there}\nend\n== two: ok" in text


@pytest.mark.parametrize(("slowness", "red"), [(0.5, True), (1.0, True), (100.0, False)])
def test_children_count_and_the_sum_is_judged_as_on_a_quiet_machine(carried_out, monkeypatch, tmp_path, slowness, red):
    monkeypatch.setattr(running, "PYTHON", tmp_path)
    uncounted = phase("tools", BUSY, quiet=None)
    code, run, text = carried_out([[uncounted]], [[phase("work", CHILD)]], limit=0.1, slowness=slowness)
    assert run.total == pytest.approx(run.rows[1].processor / slowness)
    assert run.rows[1].processor > 0.2
    assert (code, "s of the processor, at most 0 s are allowed" in text) == (red, red)


def test_words_for_the_part_are_not_for_its_targets(carried_out, monkeypatch):
    monkeypatch.setenv("ARGS", "reached")
    monkeypatch.setenv("MAKEFLAGS", " -- ARGS=reached")
    code, _, text = carried_out([[phase("show", "import os; print(not {'ARGS', 'MAKEFLAGS'} & os.environ.keys())")]])
    assert (code, "True" in text) == (0, True)


def test_a_tool_that_lacks_is_no_fault_unless_tools_are_there(carried_out):
    lacking = [[phase("tests", f"print('1 {running.LACKING.decode()}')")]]
    assert carried_out([[phase("tools", "exit(3)", brings_tools=True)]], lacking)[0] == 0
    assert carried_out([[phase("tools", brings_tools=True)]], lacking)[0] == 1


def test_targets_are_those_of_the_whole():
    assert sum(phase.quiet or 0 for step in STEPS for lane in step for phase in lane) == WHOLE
    for part in nightly.PARTS.values():
        assert sum(phase.quiet or 0 for step in part.steps for lane in step for phase in lane) <= nightly.LIMIT


def test_what_a_change_reaches(monkeypatch, tmp_path, capsys):
    noted = tmp_path / "nightly.txt"
    noted.write_text("kernels HEAD 2024-01-01\nfuzz HEAD 2024-01-01\npackages a-lost-commit 2024-01-01\n")
    monkeypatch.setattr(nightly, "GREEN", noted)
    monkeypatch.setattr(
        nightly, "_git", lambda *words: "" if "a-lost-commit^{commit}" in words else "torsionnet/linear/modes/eigen.py"
    )
    assert nightly.reached("kernels", "HEAD") == ["torsionnet/linear/modes/eigen.py"] * 2
    assert nightly.reached("fuzz", "HEAD") == []
    to_run = nightly.status(None)
    assert "fuzz" not in to_run
    assert {"kernels", "packages", "release"} <= to_run.keys()
    assert "packages   to run  never green\n" in capsys.readouterr().out


def test_green_is_noted_with_its_commit_where_all_is_committed(monkeypatch, tmp_path):
    monkeypatch.setattr(nightly, "ROOT", tmp_path)
    monkeypatch.setattr(nightly, "GREEN", tmp_path / "nightly.txt")
    monkeypatch.setattr(Run, "carry_out", lambda *_: 0)
    changed = ["a.py"]
    monkeypatch.setattr(nightly, "_changed_since", lambda _: changed)
    monkeypatch.setattr(nightly, "_git", lambda *words: "2024-01-01" if words[0] == "show" else "abc123")
    assert nightly.run("fuzz") == 0
    assert not nightly.GREEN.exists()
    changed.clear()
    assert nightly.run("fuzz") == 0
    assert nightly.run("kernels") == 0
    assert nightly.GREEN.read_text() == "kernels abc123 2024-01-01\nfuzz abc123 2024-01-01\n"
    monkeypatch.setattr(Run, "carry_out", lambda *_: 1)
    assert nightly.run("release") == 1
    assert "release" not in nightly.GREEN.read_text()


def test_a_word_that_names_no_part():
    with pytest.raises(SystemExit, match="no part fuzzy; there are: kernels"):
        nightly.main(["fuzzy"])
