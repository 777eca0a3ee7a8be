"""Which tests reach what differs from a commit, and which of them run in half a minute."""

from __future__ import annotations

import ast
import subprocess
from collections import defaultdict
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from reach.reach_map import ReachMap, functions
from reach.recording import ROOT

SECONDS = 50.0
"""Processor seconds of the tests that are run, with those of collecting their files: half a minute of two cores."""
OF_FILE = 0.5
"""Processor seconds that one more file of tests costs before its first test runs."""


@dataclass(frozen=True)
class Change:
    """What differs: places of the map, and files of tests."""

    places: set[str]
    tests: set[str]
    others: set[str]
    """Changed files that the map does not know."""


def git(*words: str) -> str:
    return subprocess.run(
        ["git", *words], cwd=ROOT, capture_output=True, text=True, check=True, encoding="utf-8"
    ).stdout


def changed_lines(file: str, commit: str) -> tuple[set[int], set[int]]:
    """Lines that are gone from a file of the commit, and those that are new in it."""
    gone, new = set[int](), set[int]()
    for line in git("diff", "-U0", commit, "--", file).splitlines():
        if line.startswith("@@"):
            _, old, now, *_ = line.split()
            for lines, stretch in ((gone, old[1:]), (new, now[1:])):
                begin, _, count = stretch.partition(",")
                lines.update(range(int(begin), int(begin) + int(count or 1)))
    return gone, new


def places_of(file: str, commit: str) -> set[str]:
    """Functions of a module with changed lines; what stands outside of functions counts for the whole module."""
    gone, new = changed_lines(file, commit)
    texts = [(git("show", f"{commit}:{file}"), gone)] if gone else []
    if (ROOT / file).exists():
        texts.append(((ROOT / file).read_text(encoding="utf-8"), new))
    places = set()
    for text, lines in texts:
        names, written = functions(text), text.splitlines()
        places |= {names.get(line, "") for line in lines if written[line - 1].strip()}
    return {f"{file}:{name}" for name in places}


def change_since(commit: str) -> Change:
    """Everything that differs from a commit, files that git does not know yet included."""
    files = (
        git("diff", "--name-only", commit).splitlines() + git("ls-files", "--others", "--exclude-standard").splitlines()
    )
    known = set(git("ls-tree", "-r", "--name-only", commit).splitlines())
    places, tests, others = set[str](), set[str](), set[str]()
    for file in files:
        name = Path(file).name
        if file.startswith("tests/") and name.endswith(".py"):
            tests |= importing_files(file)
        elif file.startswith("torsionnet/") and name.endswith(".py"):
            places |= places_of(file, commit) if file in known else {f"{file}:"}
        else:
            others.add(file)
    return Change(places, tests, others)


@cache
def imported(file: Path) -> frozenset[str]:
    """Modules below `tests` that a file imports, with dots, wherever the import stands."""
    names = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return frozenset(names)


def importing_files(file: str) -> set[str]:
    """Files of tests in which a file below `tests` has a part: itself, or those that import it, also by way of others."""
    found, waiting = set(), [file]
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        found.add(name)
        module = name.removeprefix("tests/").removesuffix(".py").removesuffix("/__init__").replace("/", ".")
        waiting += [
            path.relative_to(ROOT).as_posix()
            for path in (ROOT / "tests").rglob("*.py")
            if module in imported(path) and path.relative_to(ROOT).as_posix() not in found
        ]
    return {name for name in found if Path(name).name.startswith("test_") and (ROOT / name).exists()}


def chosen_tests(change: Change, reach: ReachMap, seconds: float) -> tuple[list[str], int]:
    """Tests to run, from every file its cheapest first, within the time; and how many reach the change at all."""
    numbers = {number for place in change.places | change.others for number in reach.reaching(place).tolist()}
    by_file: dict[str, list[int]] = defaultdict(list)
    for number in sorted(numbers, key=lambda number: reach.seconds[number]):
        if not reach.slow[number]:
            by_file[reach.tests[number].partition("::")[0]].append(number)
    turns = sorted(
        (turn, reach.seconds[number], number) for numbers in by_file.values() for turn, number in enumerate(numbers)
    )
    chosen, files, spent = [], set(), 0.0
    for _, taken, number in turns:
        file = reach.tests[number].partition("::")[0]
        spent += taken + (OF_FILE if file not in files else 0.0)
        if spent > seconds:
            break
        files.add(file)
        chosen.append(reach.tests[number])
    return chosen, sum(map(len, by_file.values()))
