"""python -m reach changed [COMMIT]: tests that reach what differs from a commit. python -m reach files: those without numbers."""

from __future__ import annotations

import argparse
import subprocess
import sys

from reach.changed import SECONDS, change_since, chosen_tests
from reach.numbers import write_without_numbers
from reach.reach_map import ReachMap
from reach.recording import ROOT


def main() -> int:
    parser = argparse.ArgumentParser(prog="reach", description=__doc__)
    parser.add_argument("what", choices=["changed", "files"])
    parser.add_argument("commit", nargs="?", default="HEAD", help="what the checkout is compared with (HEAD)")
    parser.add_argument("--seconds", type=float, default=SECONDS, help=f"processor time of the tests ({SECONDS:g})")
    given, further = parser.parse_known_args()
    reach = ReachMap.read()
    if given.what == "files":
        # A file may calculate in its slow tests alone, which a map of the quick ones does not know.
        if reach.slow.any():
            write_without_numbers(reach)
        return 0
    change = change_since(given.commit)
    chosen, number = chosen_tests(change, reach, given.seconds)
    names = [name for name in chosen if name.partition("::")[0] not in change.tests]
    print(
        f"{len(chosen)} of {number} quick tests that reach the change; all of {len(change.tests)} changed files of tests",
        flush=True,
    )
    if unread := sorted(place for place in change.others if place not in reach.numbers):
        print(f"no test is known to read {', '.join(unread)}", flush=True)
    if not names and not change.tests:
        return 0
    command = [sys.executable, "-m", "pytest", "-n", "auto", "--dist", "worksteal", "-m", "not slow", *further]
    return subprocess.run([*command, *sorted(change.tests), *names], cwd=ROOT, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
