"""Shares of fits rejected as wrong: right models (false alarms), wrong models, and noise on the torque.

python -m benchmarks.lack_of_fit [RUNS]    # 60 runs take about an hour
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

import torsionnet as tn
from benchmarks._sizes import ARGUMENTS, sized
from torsionnet.bench import Acquisition, Encoder, Plan, Transducer
from torsionnet.signals import LinearChirp, Welch, estimate

FINE = Encoder(lines=1024, quadrature=True)
SENSORS: dict[str, dict[str, Any]] = {
    "quadrature": {"theta_1": FINE},
    "1024 steps": {"theta_1": Encoder(lines=1024)},
    "analogue 0.1 deg": {"theta_1": Transducer(noise="0.1 deg")},
    "meter noise 3 N m": {"theta_1": FINE, "T_T": Transducer(noise="3 N*m")},
}
WINDOWS = {"Hamming 2 s": Welch("hamming", 2.0, 0.8, decimation=5), "Hann 8 s": Welch("hann", 8.0, 0.8, decimation=5)}
BAND = (0.5, 15.0)
RIGS: dict[str, tuple[tuple[str, ...], dict[str, float]]] = {
    "dmf_rig": (("",), {"c_2": 8.0, "k_2": 400.0}),
    "amt_rig": (("II", "III", "IV"), {"c_O": 80.0, "c_B": 4.0}),
}


def bench(rig: Any, channels: dict[str, Any], duration: float = 60.0) -> tn.Bench:
    """Virtual bench with a sweep from rest at 1 kHz."""
    plan = Plan(
        excitation=LinearChirp(start=0.2, stop=30, duration=duration, amplitude=15),
        channels={"T_T": Transducer(noise="0.23 N*m"), **channels},
        acquisition=Acquisition(rate="1 kHz"),
    )
    return tn.Bench(rig, plan)


def fitted(rig: Any, benches: dict[str, tn.Bench], start: Any, settings: Welch, route: str, seed: int) -> Any:
    """Fit to records, or to responses estimated from them."""
    tests = []
    for gear, one in benches.items():
        record = one.run(seed)
        response = estimate(record, "theta_1", "T_T", settings=settings, reference="T_M_set")
        band = (BAND[0], min(BAND[1], response.usable_up_to or BAND[1]))
        more: dict[str, Any] = {"settings": settings} if route == "records" else {}
        data: Any = record if route == "records" else response
        tests.append(tn.Measurement(data, "theta_1", "T_T", gear, band=band, **more))
    return tn.identify(rig, tests, start)


def right(runs: int) -> Iterator[tuple[str, float, float]]:
    """Case, share of right models called wrong, and median of residuals over noise, of each rig and sensor."""
    for name, (gears, start) in list(RIGS.items())[: sized(None, 1)]:
        rig = tn.load(name)
        for sensor, channels in list(SENSORS.items())[: sized(None, 1)]:
            benches = {gear: bench(rig.configured(gear), channels) for gear in gears}
            for window, settings in WINDOWS.items():
                for route in ("records", "responses"):
                    fits = [fitted(rig, benches, start, settings, route, seed) for seed in range(runs)]
                    lacks = [fit.lack_of_fit for fit in fits]
                    ratio = np.median([max(one.ratio for one in lack.measurements) for lack in lacks])
                    share = np.mean([lack.rejected for lack in lacks])
                    yield f"{name}, {sensor}, {window}, {route}", float(share), float(ratio)


def wrong() -> Iterator[tuple[str, Any, tn.Bench, dict[str, float], str]]:
    """Label, model fitted, bench, start values, and the freedom that would explain the misfit, of each wrong model."""
    rig = tn.load("dmf_rig")
    late = {"theta_1": replace(FINE, delay=1.1e-3)}
    for noise in (0.23, 3.0):
        meter = {"theta_1": FINE, "T_T": Transducer(noise=f"{noise} N*m")}
        yield f"I_2 = 0.2, {noise} N m", rig, bench(rig.configured(I_2=0.2), meter), {"k_2": 400}, "I_2"
        yield f"hysteretic, {noise} N m", rig, bench(hysteretic(0.4), meter), {"c_2": 3, "k_2": 400}, "dmf.loss_factor"
        soft = rig.configured(c_2=0.8)
        yield f"delay 1.1 ms, {noise} N m", soft, bench(soft, {**meter, **late}), {"c_2": 1, "k_2": 400}, "delay"


def hysteretic(eta: float) -> Any:
    """DMF rig with a hysteretic spring in its flywheel."""
    rig = tn.load("dmf_rig")
    spring = tn.HystereticSpring("dmf", nodes=("primary", "secondary"), stiffness="k_2", loss_factor=eta)
    elements = [spring if name == "dmf" else element for name, element in rig.definition.elements.items()]
    return tn.Drivetrain(
        "hysteretic DMF rig",
        elements,
        parameters={name: float(value) for name, value in rig.parameters.items()},
        inputs={"T_M": {"torque": "motor"}},
        sensors={"theta_1": {"angle": "motor"}, "T_T": {"torque": "torque_meter"}},
    )


def noisy_meter(runs: int) -> None:
    """Print bias and coverage of fits under noise on the torque, by noise in N m and estimator."""
    rig, true = tn.load("dmf_rig"), {"c_2": 4.0, "k_2": 460.0}
    for noise in (3, 10):
        one = bench(rig, {"theta_1": FINE, "T_T": Transducer(noise=f"{noise} N*m")}, duration=30.0)
        records = [one.run(seed) for seed in range(runs)]
        for estimator in ("Hr", "H1", "H2"):
            settings = replace(WINDOWS["Hamming 2 s"], estimator=estimator)
            tests = [tn.Measurement(record, "theta_1", "T_T", band=BAND, settings=settings) for record in records]
            fits = [tn.identify(rig, test, {"c_2": 8.0, "k_2": 400.0}) for test in tests]
            for name, value in true.items():
                found = np.array([fit.values[name] for fit in fits])
                ends = [fit.intervals()[name] for fit in fits]
                inside = np.mean([low <= value <= high for low, high in ends])
                bias, scatter = 100 * (found.mean() / value - 1), 100 * found.std() / value
                print(
                    f"{noise:2d} N m, {estimator}, {name}: bias {bias:+.2f} %, scatter {scatter:.2f} %, "
                    f"inside {100 * inside:.0f} %, called wrong {sum(fit.lack_of_fit.rejected for fit in fits)}",
                    flush=True,
                )


def main(runs: int) -> None:
    noisy_meter(runs)
    for name, rig, one, start, expected in wrong():
        fits = [fitted(rig, {"": one}, start, WINDOWS["Hamming 2 s"], "records", seed) for seed in range(min(runs, 10))]
        named = [fit.lack_of_fit.explanations[0].unknown for fit in fits if fit.lack_of_fit.explanations]
        print(
            f"{name}: {sum(fit.lack_of_fit.rejected for fit in fits)} of {len(fits)} called wrong, "
            f"{named.count(expected)} by {expected}",
            flush=True,
        )
    for name, share, ratio in right(runs):
        print(f"{name}: {100 * share:.1f} % false alarms, residuals over noise {ratio:.2f}", flush=True)


if __name__ == "__main__":
    main(int(ARGUMENTS[0]) if ARGUMENTS else sized(10, 1))
