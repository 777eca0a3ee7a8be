"""For pytest: notes which functions every test calls; with a fault in one of them, those that call it come first."""

import json
import os
import sys
import time
from pathlib import Path

import pytest
from hypothesis import Phase, settings

NOTES = Path(os.environ["MUTATION_NOTES"])
"""Per test its CPU seconds and the functions that it calls, each as path and line."""
FAULTY = os.environ.get("MUTATION_FAULTY")
"""The function with the fault; None where there is none, and notes are taken."""
MOST = float(os.environ["MUTATION_MOST"])
"""CPU seconds that the tests of one fault may take together."""

# The same examples every time, and no search for the simplest that fails.
settings.register_profile(
    "hasty", phases=(Phase.explicit, Phase.generate), derandomize=True, database=None, deadline=None
)
settings.load_profile("hasty")

taken = {}


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    if FAULTY is None:
        return
    notes, sums = json.loads(NOTES.read_text()), 0.0

    def rank(item):
        seconds, functions = notes.get(item.nodeid, (0.0, [FAULTY]))
        return FAULTY not in functions, seconds

    ordered = sorted(items, key=rank)
    items.clear()
    for item in ordered:
        sums += rank(item)[1]
        if sums <= MOST:
            items.append(item)


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_protocol(item):
    if FAULTY is not None:
        yield
        return
    called, package, began = set(), f"{Path.cwd()}{os.sep}torsionnet", time.process_time()

    def note(frame, _event, _argument):
        if frame.f_code.co_filename.startswith(package):
            called.add((frame.f_code.co_filename, frame.f_code.co_firstlineno))

    sys.settrace(note)
    yield
    sys.settrace(None)
    names = sorted(f"{Path(path).relative_to(Path.cwd())}:{line}" for path, line in called)
    taken[item.nodeid] = time.process_time() - began, names


def pytest_sessionfinish():
    if FAULTY is None:
        NOTES.write_text(json.dumps({**json.loads(NOTES.read_text()), **taken}))
