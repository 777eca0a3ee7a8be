"""``python -m plain``: the whole comparison, as tables."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from plain.campaign import run
from plain.trains import plant


def main(given: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m plain", description="Plants of components against plain equations."
    )
    parser.add_argument("--models", type=int, default=300, help="how many models are drawn")
    parser.add_argument("--seed", default="0", help="where chance begins; model i has the seed SEED-i")
    parser.add_argument("--first", type=int, default=0, help="number of the first model")
    parser.add_argument("--only", metavar="SEED-i", help="one model alone, with its file")
    asked = parser.parse_args(given)
    if asked.only:
        print(plant(asked.only).text)
    seeds = [asked.only] if asked.only else [f"{asked.seed}-{asked.first + i}" for i in range(asked.models)]
    findings = run(seeds, lambda text: print(text, flush=True))
    for what, number in sorted(findings.compared.items()):
        print(f"{what:28s}{number:8d}   agreed to {findings.worst.get(what, 0.0):.1e}")
    print(", ".join(f"{kind} {number}" for kind, number in sorted(findings.drawn.items())))
    return 1 if findings.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
