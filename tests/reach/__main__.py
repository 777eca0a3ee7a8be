"""python -m reach changed [COMMIT]: runs the tests that reach what differs from a commit, in half a minute where that can be."""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections import defaultdict
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from reach.importers import importing_files
from reach.reach_map import ReachMap, functions
from reach.recording import ROOT

SECONDS = 40.0
"""Processor seconds of the tests that are run, with those of collecting their files: half a minute of two cores."""
OF_FILE = 1.0
"""Processor seconds that one more file of tests costs before its first test runs."""


@dataclass(frozen=True)
class Change:
    """What differs: places of the map, and files of tests."""

    places: set[str]
    tests: set[str]
    others: set[str]
    """Changed files that the map does not know."""


@cache
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


def main() -> int:
    parser = argparse.ArgumentParser(prog="reach", description=__doc__)
    parser.add_argument("what", choices=["changed"])
    parser.add_argument("commit", nargs="?", default="HEAD", help="what the checkout is compared with (HEAD)")
    parser.add_argument("--seconds", type=float, default=SECONDS, help=f"processor time of the tests ({SECONDS:g})")
    given, further = parser.parse_known_args()
    change = change_since(given.commit)
    reach = ReachMap.read()
    chosen, number = chosen_tests(change, reach, given.seconds)
    print(
        f"{len(chosen)} of {number} quick tests that reach the change, and {len(change.tests)} changed files of tests"
    )
    if unknown := sorted(place for place in change.others if place not in reach.numbers):
        print(f"no test is known to read: {', '.join(unknown)}")
    if not chosen and not change.tests:
        return 0
    names = [name for name in chosen if name.partition("::")[0] not in change.tests]
    command = [sys.executable, "-m", "pytest", "-n", "2", "--dist", "worksteal", "-m", "not slow", *further]
    return subprocess.run([*command, *sorted(change.tests), *names], cwd=ROOT, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
