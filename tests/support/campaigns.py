"""How many examples and cases a run takes: few, but many in the campaigns of the night, ``pytest --campaigns``."""

import ast
import re
from collections import defaultdict
from functools import cache
from pathlib import Path

import pytest

_IMPORTED = re.compile(r"^from support\.(\w+) import", re.MULTILINE)

OPTION = "--campaigns"

many = False
"""Whether this run takes all examples; set by conftest.py before tests are collected."""


def add_option(parser):
    parser.addoption(OPTION, action="store_true", help="take all seeds and examples where `make test` takes few")


def examples(few, all_of_them):
    """The number for this run: few in `make test` and `make test-slow`, all of them in `make nightly-campaigns`."""
    return all_of_them if many else few


def by_day(cases, *chosen):
    """All cases for ``parametrize``, of which only the chosen run outside ``make nightly-campaigns``."""
    assert set(chosen) <= set(cases)
    return [case if case in chosen else pytest.param(case, marks=pytest.mark.nightly) for case in cases]


def leave_to_the_night(items):
    """Mark as slow what is marked ``nightly``: a run without slow tests leaves it out, too."""
    for item in items:
        if item.get_closest_marker("nightly") is not None:
            item.add_marker("slow")


def leave_cases_out(items):
    """Mark as slow all cases of a test but as many, evenly spread, as its mark ``few`` says; slow ones do not count.

    Of those, a second number says how many are not for the night.
    """
    families = defaultdict(list)
    for item in items:
        if (mark := item.get_closest_marker("few")) is not None and item.get_closest_marker("slow") is None:
            families[item.nodeid.split("[")[0], tuple(mark.args)].append(item)
    for (_, counts), cases in families.items():
        slow = spread(cases, counts[0])[1]
        nightly = spread(slow, counts[1])[1] if counts[1:] else []
        for name, left_out in (("slow", slow), ("nightly", nightly)):
            for item in left_out:
                item.add_marker(name)


def spread(cases, count):
    """As many of some cases, evenly spread, and the others."""
    taken = [index * count // len(cases) > (index - 1) * count // len(cases) for index in range(len(cases))]
    return [[case for case, one in zip(cases, taken, strict=True) if one is wanted] for wanted in (True, False)]


def most_of_each(items, count):
    """Tests with at most so many cases of each, evenly spread, and what is left out."""
    families = defaultdict(list)
    for item in items:
        families[item.nodeid.partition("[")[0]].append(item)
    left_out = [item for cases in families.values() for item in spread(cases, count)[1]]
    gone = set(map(id, left_out))
    return [item for item in items if id(item) not in gone], left_out


def mark_sized(items):
    """Mark as ``campaign`` what tries few examples in most runs."""
    for item in items:
        name = item.nodeid.split("::")[1].split("[")[0]
        if isinstance(item, pytest.Function) and name in sized(item.path):
            item.add_marker("campaign")


@cache
def sized(path):
    """Names at the top of a file of tests, of functions, classes and values, that ask here how many examples to try."""
    text = Path(path).read_text(encoding="utf-8")
    helpers = [Path(__file__).with_name(f"{name}.py") for name in _IMPORTED.findall(text)]
    asked = {"campaigns", "examples"} if "campaigns" in text else set()
    names = {name for name in asked.union(*map(sized, helpers)) if name in text}
    if not names:  # reading all files as syntax would take a second
        return frozenset()
    words = {name: used for node in ast.parse(text).body for name, used in _words(node)}
    while more := {name for name, used in words.items() if used & names} - names:
        names |= more
    return frozenset(names)


def _words(node):
    """Each name that a statement defines, with the names and the arguments, which may be fixtures, that it uses."""
    used = {one.id for one in ast.walk(node) if isinstance(one, ast.Name)}
    used |= {one.arg for one in ast.walk(node) if isinstance(one, ast.arg)}
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        yield node.name, used
    elif isinstance(node, ast.Assign):
        yield from (
            (one.id, used) for one in ast.walk(node) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)
        )
