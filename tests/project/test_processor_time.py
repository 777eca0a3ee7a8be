"""What a run of tests and each test take of the processor: counted with all processes, and judged where that is asked."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from support import processor_time

CONFTEST = """
from support import processor_time

processor_time.fixed_work.slowness = lambda: 1.0
pytest_addoption = lambda parser: processor_time.add_options(parser)
pytest_configure = lambda config: config.pluginmanager.register(processor_time.ProcessorTime(config))
"""
BUSY = "import time\nwhile time.process_time() < 0.15: pass"
TESTS = f"""
import subprocess, sys
import pytest

def test_quick(): pass
def test_waits_for_a_child(): subprocess.run([sys.executable, "-c", {BUSY!r}], check=True)

@pytest.mark.slow
def test_slow(): subprocess.run([sys.executable, "-c", {BUSY!r}], check=True)
"""


@pytest.fixture
def run(tmp_path):
    """Run three small tests in a process of their own; (exit code, output)."""

    def call(*arguments):
        (tmp_path / "conftest.py").write_text(CONFTEST)
        (tmp_path / "pytest.ini").write_text(
            f'[pytest]\nmarkers = slow\npythonpath = "{Path(__file__).parents[1].as_posix()}"\n'
        )
        (tmp_path / "test_some.py").write_text(TESTS)
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "xdist", *arguments]
        environment = os.environ | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}  # they take longer to load than the tests
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        return done.returncode, done.stdout

    return call


@pytest.mark.slow
def test_workers_and_their_children_count_and_limits_are_kept(run):
    code, text = run("-n", "1", "--most-of-one", "0.1", "--dearest", "2")
    assert code == 1
    assert "3 passed" in text
    assert "test_some.py::test_waits_for_a_child took 0." in text
    assert "s, a quick test at most 0.1 s" in text
    assert "test_slow took" not in text
    assert "slow  test_some.py::test_slow" in text


@pytest.mark.few(1)
@pytest.mark.parametrize("limits", [(), ("--most-of-one", "0.1", "-k", "quick or slow")], ids=["none", "kept"])
def test_otherwise_it_is_only_shown(run, limits):
    code, text = run(*limits)
    assert code == 0
    assert "processor time with all processes: " in text
    assert "most for one test: 0." in text
    assert "at most" not in text


@pytest.mark.parametrize(("slowness", "above"), [(0.8, True), (1.0, True), (1.1, False)])
def test_each_test_may_take_longer_on_a_slower_machine(pytestconfig, monkeypatch, slowness, above):
    monkeypatch.setattr(processor_time.fixed_work, "slowness", lambda: slowness)
    plugin = processor_time.ProcessorTime(pytestconfig)
    plugin.most, plugin.of_test = 10.0, {"a": (10.1, False), "b": (99.0, True)}
    assert plugin.judged() == (["a took 10.1 s, a quick test at most 10 s"] if above else [])
