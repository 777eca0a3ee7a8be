"""For pytest with ``--reach``: notes what every test reaches, and its processor time, and writes the map."""

from __future__ import annotations

import json
import os
import shutil
import sys
import sysconfig
import tempfile
from pathlib import Path

import pytest
from support.processor_time import spent

from reach import recording
from reach.reach_map import ReachMap


class Noting:
    """Notes of one process; those of all processes become the map."""

    def __init__(self, config):
        self.by_test, self.by_fixture = {}, {}
        self.map = Path(config.getoption("--reach"))
        self.worker = getattr(config, "workerinput", {}).get("workerid")
        if self.worker is None:
            os.environ["TORSIONNET_REACH_NOTES"] = tempfile.mkdtemp()
            code = f"import sys; sys.path.append({str(Path(__file__).parents[1])!r}); from reach.recording import start_in_child; start_in_child()"
            # Python runs it at the start of every process, as coverage.py has it done: tests choose environments of their own.
            self.start = Path(sysconfig.get_paths()["purelib"]) / f"torsionnet_reach_{os.getpid()}.pth"
            self.start.write_text(
                f"import os; os.environ.get({recording.CHILDREN!r}) and exec({code!r})\n", encoding="utf-8"
            )
        self.notes = Path(os.environ["TORSIONNET_REACH_NOTES"])
        self.children = self.notes / f"children-{os.getpid()}"
        self.children.mkdir()

    def pytest_sessionstart(self):
        recording.start()

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_fixture_setup(self, fixturedef):
        """What is made once for several tests counts for each that asks for it."""
        if fixturedef.scope == "function":
            return (yield)
        before = recording.restart()
        try:
            return (yield)
        finally:
            own = recording.restart()
            self.by_fixture.setdefault(fixturedef.argname, set()).update(own)
            recording.reached.update(before | own)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item):
        recording.restart()
        os.environ[recording.CHILDREN] = str(self.children)
        began = spent()
        try:
            return (yield)
        finally:
            seconds, called = spent() - began, recording.restart()
            # A process that reads foreign files serves many tests: at its end it says what this one reached.
            if (reader := sys.modules.get("torsionnet.signals.foreign.process")) is not None:
                reader.end_all()
            del os.environ[recording.CHILDREN]
            for file in self.children.glob("*.txt"):
                called.update(file.read_text(encoding="utf-8").splitlines())
                file.unlink()
            for fixture in getattr(item, "fixturenames", ()):
                called |= self.by_fixture.get(fixture, set())
            slow = any(item.get_closest_marker(mark) for mark in ("slow", "nightly"))
            self.by_test[item.nodeid] = (seconds, slow, sorted(called))

    @pytest.hookimpl(wrapper=True, trylast=True)
    def pytest_sessionfinish(self):
        result = yield  # here workers are ended
        (self.notes / f"{self.worker}.json").write_text(json.dumps(self.by_test), encoding="utf-8")
        if self.worker is None:
            noted = [json.loads(file.read_text(encoding="utf-8")) for file in sorted(self.notes.glob("*.json"))]
            ReachMap.of({name: note for notes in noted for name, note in notes.items()}).write(self.map)
            self.start.unlink()
            shutil.rmtree(self.notes)
        return result
