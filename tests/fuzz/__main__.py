"""``python -m fuzz``: broken files of every kind, and what came of them."""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fuzz import sources
from fuzz.campaign import trials
from fuzz.kinds import KINDS
from fuzz.trying import Trial
from fuzz.worker import content


@dataclass
class Count:
    """What came of the inputs of a kind."""

    outcomes: Counter[str] = field(default_factory=Counter)
    signatures: Counter[str] = field(default_factory=Counter)
    first: dict[str, int] = field(default_factory=dict)
    seconds: float = 0.0
    memory: float = 0.0

    def add(self, trial: Trial) -> None:
        self.outcomes[trial.outcome] += 1
        self.seconds, self.memory = max(self.seconds, trial.seconds), max(self.memory, trial.memory)
        if trial.outcome == "failure":
            self.signatures[trial.signature] += 1
            self.first.setdefault(trial.signature, trial.number)

    def row(self, name: str) -> str:
        numbers = [self.outcomes.total(), *(self.outcomes[key] for key in ("result", "error", "failure"))]
        return (
            f"{name:18s}"
            + "".join(f"{number:10d}" for number in numbers)
            + f"{self.seconds:10.2f}{self.memory / 1e6:10.0f}"
        )


def arguments(given: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m fuzz", description="Broken files of every kind.")
    parser.add_argument("--seconds", type=float, default=600.0, help="how long (600)")
    parser.add_argument("--seed", default="1", help="other inputs")
    parser.add_argument("--kind", action="append", choices=sorted(KINDS), help="only this one; repeatable")
    parser.add_argument(
        "--keep", type=Path, default=Path("out/fuzz"), help="folder for the first input of each failure"
    )
    return parser.parse_args(given)


def table(counts: dict[str, Count]) -> str:
    """Counts by kind, and one line for every signature."""
    heads = ("files", "results", "errors", "failures", "CPU s", "MB")
    lines = [f"{'kind':18s}" + "".join(f"{head:>10s}" for head in heads)]
    lines += [count.row(name) for name, count in counts.items()]
    whole = Count()
    for count in counts.values():
        whole.outcomes += count.outcomes
        whole.seconds, whole.memory = max(whole.seconds, count.seconds), max(whole.memory, count.memory)
    lines.append(whole.row("all"))
    for name, count in counts.items():
        lines += [f"{number:6d} {name} {count.first[what]}: {what}" for what, number in count.signatures.most_common()]
    return "\n".join(lines)


def main(given: Sequence[str] | None = None) -> int:
    asked = arguments(given)
    counts = {name: Count() for name in asked.kind or KINDS}
    began = reported = time.monotonic()
    with tempfile.TemporaryDirectory() as made:
        sources.furnish(Path(made))
        for name, trial in trials(list(counts), asked.seed, asked.seconds):
            counts[name].add(trial)
            if trial.outcome == "failure" and counts[name].signatures[trial.signature] == 1:
                asked.keep.mkdir(parents=True, exist_ok=True)
                kind = KINDS[name]
                path = asked.keep / f"{kind.name.replace('.', '_')}_{asked.seed}_{trial.number}{kind.ending}"
                path.write_bytes(content(kind, asked.seed, trial.number, Path(made)))
                print(f"{path}: {trial.signature}", flush=True)
            if time.monotonic() - reported > 300:
                reported = time.monotonic()
                print(f"-- {reported - began:.0f} s\n{table(counts)}", flush=True)
    print(f"-- {time.monotonic() - began:.0f} s, seed {asked.seed}\n{table(counts)}")
    return 1 if any(count.signatures for count in counts.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
