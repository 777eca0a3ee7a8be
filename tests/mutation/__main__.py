"""python -m mutation [-n 200] [--seed 30 | --seed commit] [PATH[:LINE] ...]: prints what no test noticed, and the share by room."""

from __future__ import annotations

import argparse
import random
import subprocess
import sys
import tempfile
from collections import Counter
from itertools import chain, zip_longest
from operator import itemgetter
from pathlib import Path

from reach.reach_map import ReachMap
from reach.recording import ROOT

from mutation.equivalent import reason_of
from mutation.mutants import Mutant, mutants
from mutation.trials import Outcome, Trials

MOST_LIVING = 0.1
"""Share of the faults that change a result which tests may miss."""
COMMIT = "commit"
"""As a seed: the hash of the commit, which nobody chooses."""


def modules(paths: list[str]) -> dict[str, int | None]:
    """Modules below the paths, each with the one line that is asked for, or None."""
    lines: dict[str, int | None] = {}
    for path in paths:
        name, _, line = path.partition(":")
        files = [ROOT / name] if name.endswith(".py") else sorted((ROOT / name).rglob("*.py"))
        lines |= {file.relative_to(ROOT).as_posix(): int(line) if line else None for file in files}
    return lines


def sample(paths: list[str], number: int, seed: int | str) -> list[Mutant]:
    """Faults spread over the modules: one of each in turn, until there are enough."""
    by_module = []
    for module, line in modules(paths).items():
        faults = mutants(module, (ROOT / module).read_text(encoding="utf-8"))
        faults = [mutant for mutant in faults if line in {None, mutant.line}]
        # A draw of its own: what one module has does not change the sample of another.
        draw = random.Random(f"{seed} {module}")
        by_module.append((draw.random(), draw.sample(faults, len(faults))))
    turns = chain.from_iterable(zip_longest(*(faults for _, faults in sorted(by_module, key=itemgetter(0)))))
    return sorted([mutant for mutant in turns if mutant][:number], key=lambda mutant: (mutant.module, mutant.start))


def room(mutant: Mutant) -> str:
    """Folder of the package, or the package itself."""
    return "/".join(mutant.module.split("/")[:2]) if mutant.module.count("/") > 1 else "torsionnet"


def shares(outcomes: list[Outcome]) -> list[str]:
    """A line for each room, and one for all: how many of the faults that are not equivalent live."""
    drawn = Counter(room(outcome.mutant) for outcome in outcomes)
    equal = Counter(room(outcome.mutant) for outcome in outcomes if outcome.word == "equal")
    living = Counter(room(outcome.mutant) for outcome in outcomes if outcome.word in ("survived", "undecided"))
    rows = [(name, drawn[name], equal[name], living[name]) for name in sorted(drawn)]
    rows.append(("all", drawn.total(), equal.total(), living.total()))
    return [
        f"{name}: {alive} of {of - same} live ({100 * alive / max(of - same, 1):.0f} %), {same} equivalent ones set aside"
        for name, of, same, alive in rows
    ]


def main() -> int:
    """Exit code 1 where more than `MOST_LIVING` of the faults live."""
    parser = argparse.ArgumentParser(prog="mutation", description=__doc__)
    parser.add_argument("paths", nargs="*", default=["torsionnet"], help="rooms, modules or MODULE:LINE")
    parser.add_argument("-n", "--number", type=int, default=200, help="how many faults (200)")
    parser.add_argument(
        "--seed", default="30", help="another sample; the word commit for one that the commit's hash draws"
    )
    parser.add_argument("--most", type=float, default=120.0, help="CPU seconds of tests for one fault (120)")
    given = parser.parse_args()
    head = subprocess.run(
        ["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.strip()
    seed = head if given.seed == COMMIT else given.seed
    print(f"{given.number} faults drawn by seed {seed} at commit {head}", flush=True)
    drawn = sample(list(given.paths), given.number, seed)
    outcomes = [Outcome(mutant, "equal", reason) for mutant in drawn if (reason := reason_of(mutant))]
    equal = {outcome.mutant for outcome in outcomes}
    with tempfile.TemporaryDirectory() as folder:
        trials = Trials(Path(folder), ReachMap.read(), given.most)
        for outcome in trials.outcomes([mutant for mutant in drawn if mutant not in equal]):
            outcomes.append(outcome)
            print(outcome, flush=True)
    for outcome in outcomes[: len(equal)]:
        print(outcome)
    print("\n".join(shares(outcomes)))
    living = sum(outcome.word in ("survived", "undecided") for outcome in outcomes)
    return int(living > MOST_LIVING * (len(outcomes) - len(equal)))


if __name__ == "__main__":
    sys.exit(main())
