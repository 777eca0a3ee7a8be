"""python -m mutation [-n 120] [--seed 1] [PATH[:LINE] ...]: prints what no test noticed, and the score."""

from __future__ import annotations

import argparse
import random
import tempfile
from collections import Counter
from collections.abc import Iterator
from itertools import chain, zip_longest
from operator import itemgetter
from pathlib import Path

from mutation.chosen import PACKAGES
from mutation.mutants import Mutant, mutants
from mutation.trials import ROOT, Trials


def modules(paths: list[str]) -> dict[str, int | None]:
    """Modules below the paths, each with the one line that is asked for, or None."""
    found: dict[str, int | None] = {}
    for path in paths:
        name, _, line = path.partition(":")
        files = [ROOT / name] if name.endswith(".py") else sorted((ROOT / name).rglob("*.py"))
        found |= {str(file.relative_to(ROOT)): int(line) if line else None for file in files}
    return found


def sample(paths: list[str], number: int, seed: int) -> list[Mutant]:
    """Faults spread over the modules: one of each in turn, until there are enough."""
    by_module = []
    for module, line in modules(paths).items():
        found = mutants(module, (ROOT / module).read_text(encoding="utf-8"))
        found = [mutant for mutant in found if line in {None, mutant.line}]
        # A draw of its own: what one module has does not change the sample of another.
        draw = random.Random(f"{seed} {module}")
        by_module.append((draw.random(), draw.sample(found, len(found))))
    turns = chain.from_iterable(zip_longest(*(found for _, found in sorted(by_module, key=itemgetter(0)))))
    return sorted([mutant for mutant in turns if mutant][:number], key=lambda mutant: (mutant.module, mutant.start))


def tried(chosen: list[Mutant], most: float) -> Iterator[tuple[Mutant, bool]]:
    """Faults and whether they survive."""
    with tempfile.TemporaryDirectory() as folder:
        trials = Trials(Path(folder), most)
        for mutant in chosen:
            yield mutant, trials.survives(mutant)


def main() -> None:
    parser = argparse.ArgumentParser(prog="mutation", description=__doc__)
    parser.add_argument("paths", nargs="*", default=PACKAGES, help="packages, modules or MODULE:LINE")
    parser.add_argument("-n", "--number", type=int, default=120, help="how many faults (120)")
    parser.add_argument("--seed", type=int, default=1, help="another sample")
    parser.add_argument("--most", type=float, default=60.0, help="CPU seconds of tests for one fault (60)")
    given = parser.parse_args()
    alive, every = Counter(), Counter()
    for mutant, survives in tried(sample(list(given.paths), given.number, given.seed), given.most):
        package = "/".join(mutant.module.split("/")[:2])
        every[package] += 1
        alive[package] += survives
        print(f"{'SURVIVED' if survives else 'noticed '} {mutant}", flush=True)
    for package, number in every.items():
        print(f"{package}: {number - alive[package]} of {number} noticed")
    print(f"all: {every.total() - alive.total()} of {every.total()} noticed, {alive.total()} survived")


if __name__ == "__main__":
    main()
