"""Processor time of a run and of each test, with all processes that they start: shown at the end, and judged if asked."""

import os

import pytest

from support import fixed_work

MOST_OF_ONE = "--most-of-one"
DEAREST = "--dearest"


def spent():
    """Processor seconds of this process and of its children that have ended, with theirs."""
    return sum(os.times()[:4])


def add_options(parser):
    group = parser.getgroup("processor time")
    group.addoption(
        MOST_OF_ONE,
        type=float,
        metavar="SECONDS",
        help="fail if the call of a test without the mark slow takes more of the processor, as on a quiet machine",
    )
    group.addoption(DEAREST, type=int, default=0, metavar="N", help="list the N tests that took most of the processor")


class ProcessorTime:
    """Plugin: notes what each test takes, and judges the sum once all workers have ended."""

    def __init__(self, config):
        self.most, self.shown = config.getoption(MOST_OF_ONE), config.getoption(DEAREST)
        self.of_test, self.faults = {}, []
        self.total = 0.0

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item):
        began = spent()
        try:
            return (yield)
        finally:
            slow = item.get_closest_marker("slow") is not None
            item.user_properties.append(("processor time", (spent() - began, slow)))

    def pytest_runtest_logreport(self, report):
        if report.when == "call":
            self.of_test[report.nodeid] = dict(report.user_properties).get("processor time", (0.0, False))

    @pytest.hookimpl(wrapper=True, trylast=True)
    def pytest_sessionfinish(self, session):
        result = yield  # here workers are ended
        self.total = spent()
        self.faults = self.judged()
        if self.faults and session.exitstatus == pytest.ExitCode.OK:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED
        return result

    def judged(self):
        """A line for each quick test above the limit; the machine is timed only where there may be one."""
        quick = sorted((name, taken) for name, (taken, slow) in self.of_test.items() if not slow)
        if self.most is None or all(taken <= self.most for _, taken in quick):
            return []
        most = self.most * max(1.0, fixed_work.slowness())
        return [
            f"{name} took {taken:.1f} s, a quick test at most {most:.3g} s" for name, taken in quick if taken > most
        ]

    def pytest_terminal_summary(self, terminalreporter):
        if not self.of_test:
            return
        write = terminalreporter.write_line
        dearest = sorted(self.of_test.items(), key=lambda each: -each[1][0])
        for name, (taken, slow) in dearest[: self.shown]:
            write(f"{taken:7.2f} s {'slow  ' if slow else '      '}{name}")
        name, (taken, _) = dearest[0]
        write(f"processor time with all processes: {self.total:.0f} s; most for one test: {taken:.1f} s, {name}")
        for line in self.faults:
            write(f"processor time: {line}", red=True)
