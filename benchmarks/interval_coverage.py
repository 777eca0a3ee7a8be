"""How often confidence intervals hold the truth: fits of the paper's rigs from virtual tests with other seeds.

python -m benchmarks.interval_coverage [RUNS]    # 200 runs take about 20 minutes
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

import torsionnet as tn
from benchmarks._sizes import ARGUMENTS, sized
from torsionnet.bench import Encoder
from torsionnet.signals import PAPER, estimate

TRUE = {"c_2": 4.0, "c_O": 170.0, "c_B": 1.5}
WRONG = {"c_2": 8.0, "c_O": 80.0, "c_B": 4.0}
FINE = Encoder(lines=1024, quadrature=True)


def cases() -> Iterator[tuple[str, Any, dict[str, Any], list[str]]]:
    """Name, model to begin from, benches by configuration, parameters."""
    dmf, amt = tn.load_bench("dmf_bench"), tn.load_bench("amt_bench")
    yield "DMF", tn.load("dmf_rig").configured(c_2=WRONG["c_2"]), {"": fine(dmf)}, ["c_2"]
    start = tn.load("amt_rig").configured(c_O=WRONG["c_O"], c_B=WRONG["c_B"])
    gears = {gear: fine(amt).configured(gear) for gear in ("II", "III", "IV")}
    yield "AMT II-IV", start, gears, ["c_O", "c_B"]


def fine(bench: Any) -> Any:
    """With the encoder in quadrature."""
    return replace(bench, plan=replace(bench.plan, channels={**bench.plan.channels, "theta_1": FINE}))


def fits(model: Any, benches: dict[str, Any], parameters: list[str], seed: int) -> tuple[Any, Any]:
    """By the same-estimator route, and plainly to the estimated responses."""
    records = {name: bench.run(seed) for name, bench in benches.items()}
    same = [tn.Measurement(record, "theta_1", "T_T", name, settings=PAPER) for name, record in records.items()]
    plain = [
        tn.Measurement(estimate(record, "theta_1", "T_T", settings=PAPER), "theta_1", "T_T", name)
        for name, record in records.items()
    ]
    return tn.identify(model, same, parameters), tn.identify(model, plain, parameters)


def main(runs: int) -> None:
    for name, model, benches, parameters in cases():
        began, inside, found = time.perf_counter(), np.zeros((2, len(parameters))), []
        for seed in range(runs):
            pair = fits(model, benches, parameters, seed)
            found.append([[fit.values[p] for p in parameters] for fit in pair])
            for number, fit in enumerate(pair):
                ends = fit.intervals()
                inside[number] += [ends[p][0] <= TRUE[p] <= ends[p][1] for p in parameters]
        values = np.array(found)
        print(f"{name}: {runs} runs, {time.perf_counter() - began:.0f} s")
        for number, route in enumerate(("same estimator", "plain")):
            for column, parameter in enumerate(parameters):
                spread = values[:, number, column]
                bias = 100 * (spread.mean() / TRUE[parameter] - 1)
                print(
                    f"  {route:15s} {parameter}: true {TRUE[parameter]:g}, mean {spread.mean():.5g} ({bias:+.2f} %), "
                    f"scatter {spread.std():.2g}, inside {100 * inside[number, column] / runs:.1f} %"
                )


if __name__ == "__main__":
    main(int(ARGUMENTS[0]) if ARGUMENTS else sized(20, 1))
