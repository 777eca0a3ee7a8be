"""What a run of tests and each test take of the processor: counted with all processes, and judged where that is asked."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from support import processor_time

CONFTEST = """
from support import processor_time

processor_time.MOST_OF_ONE = 0.1
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
        (tmp_path / "pytest.ini").write_text(f"[pytest]\nmarkers = slow\npythonpath = {Path(__file__).parent}\n")
        (tmp_path / "test_some.py").write_text(TESTS)
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "xdist", *arguments]
        environment = os.environ | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}  # they take longer to load than the tests
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        return done.returncode, done.stdout

    return call


@pytest.mark.slow
def test_workers_and_their_children_count_and_limits_are_kept(run):
    code, text = run("-n", "1", "--processor-seconds", "0.3", "--dearest", "2")
    assert code == 1
    assert "3 passed" in text
    assert "test_some.py::test_waits_for_a_child took 0." in text
    assert "s, a quick test at most 0.1 s" in text
    assert "test_slow took" not in text
    assert "slow  test_some.py::test_slow" in text
    assert "s, at most 0.3 s are allowed" in text


@pytest.mark.few(1)
@pytest.mark.parametrize("limits", [(), ("--processor-seconds", "60", "-k", "quick or slow")], ids=["none", "kept"])
def test_otherwise_it_is_only_shown(run, limits):
    code, text = run(*limits)
    assert code == 0
    assert "processor time with all processes: " in text
    assert "most for one test: 0." in text
    assert "at most" not in text


@pytest.mark.parametrize(("total", "above"), [(300.0, True), (400.0, True), (575.0, False)])
def test_each_test_may_take_longer_on_a_slower_machine(pytestconfig, total, above):
    found = processor_time.ProcessorTime(pytestconfig)
    found.limit, found.total, found.of_test = 1000.0, total, {"a": (10.1, False), "b": (99.0, True)}
    assert found.faults() == (["a took 10.1 s, a quick test at most 10 s"] if above else [])
