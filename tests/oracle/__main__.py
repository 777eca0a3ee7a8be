"""``python -m oracle``: the whole comparison, as tables."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence

from oracle.campaign import compare
from oracle.drawing import draw
from oracle.package import source
from oracle.roles import EVERY
from oracle.tally import Tally


def arguments(given: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m oracle", description="Random drivetrains against exact mechanics.")
    parser.add_argument("--models", type=int, default=300, help="how many models are drawn")
    parser.add_argument("--seed", default="0", help="where chance begins; model i has the seed SEED-i")
    parser.add_argument("--first", type=int, default=0, help="number of the first model, to go on from there")
    parser.add_argument(
        "--findings", type=int, default=40, help="how many findings are printed, one per model and quantity"
    )
    parser.add_argument("--only", metavar="SEED-i", help="one model alone, with its source")
    return parser.parse_args(given)


def main(given: Sequence[str] | None = None) -> int:
    asked = arguments(given)
    tally, began = Tally(), time.perf_counter()
    if asked.only:
        print(source(draw(asked.only)))
    seeds = [asked.only] if asked.only else [f"{asked.seed}-{asked.first + i}" for i in range(asked.models)]
    for number, seed in enumerate(seeds, 1):
        compare(seed, tally)
        if number % 50 == 0:
            seconds = time.perf_counter() - began
            text = f"{number} models, {tally.values} values, {tally.beyond} beyond tolerance, {seconds:.0f} s"
            print(text, file=sys.stderr, flush=True)
    print(tally.table())
    if not asked.only:
        print(f"\n{tally.role_table()}")
        missing = sorted(EVERY - tally.roles.keys())
        print(f"\nroles never drawn: {', '.join(missing) or 'none'}; {time.perf_counter() - began:.0f} s")
    findings = tally.findings if asked.only else tally.distinct()
    for finding in findings[: asked.findings]:
        print(finding)
    if len(tally.findings) > asked.findings:
        print(f"{len(tally.findings)} findings in all; those of one model: --only SEED-i --findings 1000")
    return 1 if tally.beyond else 0


if __name__ == "__main__":
    sys.exit(main())
