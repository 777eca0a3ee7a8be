"""Coverage of 95 % intervals: shares that hold the truth, in fits of the source paper's rigs to virtual tests.

python -m benchmarks.interval_coverage [SEEDS] [PATTERN]    # 60 seeds of all cases, or of those whose name has PATTERN
python -m benchmarks.interval_coverage [SEEDS] response     # 200 seeds of responses without coherence
python -m benchmarks.interval_coverage 200 "between samples"   # torques held, straight, band-limited
python -m benchmarks.interval_coverage [SEEDS] modes        # 200 draws; or of orders, patterns, run-ups

Of the AMT two gears are fitted together, II and IV. Fits are made from records, from responses estimated of them, and
from such responses as a file would give them back, without the record; with a noisy torque meter by Hr with the
set-point as reference, otherwise by H1. An interval that is withheld, because the model is called wrong, counts as one
that does not hold the truth.

Responses without coherence are those of one mass on a spring, with complex noise of equal size in all lines or in
proportion to the magnitude; intervals that are withheld are counted apart.

"Between samples" are two masses at 200 Hz whose torque is held, straight or band-limited between samples: the records
are those of scipy's own discretisation, not of `simulate`.

Identified modes, half orders of a wheel, orders of pitch patterns and damping of run-ups are drawn anew for each seed
(`benchmarks/_interval_draws.py`).
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one process per core

import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from typing import Any

import numpy as np

import torsionnet as tn
from benchmarks._interval_draws import DRAWS, covered, drawn_row
from benchmarks._sizes import ARGUMENTS, sized
from torsionnet.bench import Acquisition, Encoder, Plan, Transducer
from torsionnet.signals import LinearChirp, Welch, estimate

SEEDS, AT_ONCE = sized(60, 2), sized(5, 1)
RESPONSE_SEEDS = sized(200, 4)
TRUE = {"c_2": 4.0, "c_O": 170.0, "c_B": 1.5}
WRONG = {"c_2": 4.6, "c_O": 150.0, "c_B": 1.8}
RIGS: dict[str, tuple[str, tuple[str, ...], tuple[str, ...]]] = {
    "DMF": ("dmf_rig", ("",), ("c_2",)),
    "AMT": ("amt_rig", ("II", "IV"), ("c_O", "c_B")),
}
QUIET = Transducer(range="230 N*m", noise="0.23 N*m")
NOISY = Transducer(range="230 N*m", noise="3 N*m")
FINE = Encoder(lines=1024, quadrature=True)
SENSORS: dict[str, dict[str, Any]] = {
    "encoder, 4096 steps": {"T_T": QUIET, "theta_1": FINE},
    "encoder, 1024 steps": {"T_T": QUIET, "theta_1": Encoder(lines=1024)},
    "angle, 0.1 deg noise": {"T_T": QUIET, "theta_1": Transducer(range="20 deg", noise="0.1 deg")},
    "meter, 3 N m noise": {"T_T": NOISY, "theta_1": FINE},
}
REFERENCES = {"meter, 3 N m noise": "T_M_set"}
WINDOWS = {
    "Hamming 2 s": Welch("hamming", 2.0, 0.8, decimation=10),
    "Hann 8 s": Welch("hann", 8.0, 0.8, decimation=10),
}
ROUTES = ("record", "response", "file")
CHIRP = LinearChirp(start=0.2, stop=40, duration=60, amplitude=15)
EXCITER = {
    "bandwidth": "60 Hz",
    "harmonics": {2: "2 %", 3: "1.3 %"},
    "limit": "110 N*m",
    "bits": 13,
    "full_scale": "110 N*m",
}
ACQUISITION = Acquisition(rate="1 kHz", bits=16)
WAYS = tuple(product(WINDOWS, ROUTES))
ONE_MASS = {"k": 1000.0, "J": 0.1, "c": 0.4}
ONE_MASS_LINES = {"400 lines": np.linspace(1, 60, 400), "40 lines": np.linspace(1, 60, 40)}
NOISES, NOISE_LEVELS = ("constant", "relative"), (3e-4, 1e-3, 3e-3, 1e-2)


@dataclass(frozen=True)
class Case:
    """Test rig of the paper with the sensors of its fit."""

    rig: str
    sensors: str

    def __str__(self) -> str:
        return f"{self.rig}, {self.sensors}"

    @property
    def parameters(self) -> tuple[str, ...]:
        return RIGS[self.rig][2]


@cache
def benches(case: Case) -> dict[str, Any]:
    """Benches by configuration; each keeps its noise-free records for all seeds."""
    file, configurations, _ = RIGS[case.rig]
    plan = Plan(drive="T_M", excitation=CHIRP, exciter=EXCITER, channels=SENSORS[case.sensors], acquisition=ACQUISITION)
    return {name: tn.Bench(tn.load(file).configured(name), plan) for name in configurations}


def measured(record: Any, configuration: str, settings: Welch, route: str, reference: str = "") -> tn.Measurement:
    """Measurement of one test in the form given to the fit: a record, a response, or a file."""
    if route == "record":
        return tn.Measurement(record, "theta_1", "T_T", configuration, settings=settings)
    response = estimate(record, "theta_1", "T_T", settings=settings, reference=reference or ())
    if route == "file":
        response = replace(response, estimation=replace(response.estimation, record=None))
    return tn.Measurement(response, "theta_1", "T_T", configuration)


def fits(case: Case, seed: int) -> list[tuple[list[float], list[float], list[bool], bool]]:
    """Values, standard errors, whether intervals hold the truth, and whether the model is called wrong, in ``WAYS``."""
    records = {name: bench.run(seed) for name, bench in benches(case).items()}
    model, start, found = tn.load(RIGS[case.rig][0]), {name: WRONG[name] for name in case.parameters}, []
    for windows, route in WAYS:
        reference = REFERENCES.get(case.sensors, "")
        tests = [measured(record, name, WINDOWS[windows], route, reference) for name, record in records.items()]
        fit = tn.identify(model, tests, start)
        ends = fit.intervals()
        inside = [not fit.lack_of_fit.rejected and low <= TRUE[name] <= high for name, (low, high) in ends.items()]
        values = [fit.values[name] for name in case.parameters]
        errors = [fit.standard_errors[name] for name in case.parameters]
        found.append((values, errors, inside, fit.lack_of_fit.rejected))
    return found


COURSE_TRUE = {"c_1": 4.0, "k_2": 194.0, "c_2": 4.2}
COURSE_NOISE = 1e-3
COURSES = ("held", "straight", "band_limited")


def two_masses(**values: float) -> tn.Drivetrain:
    """Two masses on springs to ground and to each other, with the torque on the first."""
    return tn.Drivetrain(
        "two masses",
        [
            tn.Inertia("i1", node="n1", inertia=0.23),
            tn.Inertia("i2", node="n2", inertia=0.13),
            tn.Spring("s1", nodes=("n1", "n2"), stiffness=460, damping="c_1"),
            tn.Damper("d1", nodes=("n1", "ground"), damping=0.3),
            tn.Spring("s2", nodes=("n2", "ground"), stiffness="k_2", damping="c_2"),
        ],
        parameters=values,
        inputs={"T": {"torque": "n1"}},
        sensors={"a": {"angle": "n1"}},
    )


@cache
def course_truth(between: str) -> tuple[Any, Any]:
    """Torque and angle, each (n,), of a swept sine at 200 Hz with that course between samples, by scipy."""
    from scipy.signal import chirp, cont2discrete

    c_1, k_2, c_2 = COURSE_TRUE.values()
    M, K = np.diag([0.23, 0.13]), np.array([[460, -460], [-460, 460 + k_2]])
    C = np.array([[0.3 + c_1, -c_1], [-c_1, c_1 + c_2]])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    B, reading = np.array([[0], [0], [1 / 0.23], [0]]), np.array([[1.0, 0, 0, 0]])
    finer = 32 if between == "band_limited" else 1
    time_ = np.arange(30 * 200 * finer) / (200 * finer)
    u = 5 * chirp(time_, 0.3, 30, 30, phi=-90) * np.sin(np.pi * np.minimum(1, (30 - time_) * 2) / 2) ** 2
    way = "zoh" if between == "held" else "foh"
    Ad, Bd, Cd, Dd, _ = cont2discrete((A, B, reading, np.zeros((1, 1))), 1 / (200 * finer), way)
    x, angle = np.zeros(4), np.empty(len(u))
    for place, torque in enumerate(u):
        angle[place] = (Cd @ x + Dd[:, 0] * torque)[0]
        x = Ad @ x + Bd[:, 0] * torque
    return u[::finer], angle[::finer]


def course_fit(between: str, seed: int) -> tuple[list[float], list[float], list[bool], bool]:
    """Values, standard errors, whether intervals hold the truth, and whether the model is called wrong, of a record."""
    u, angle = course_truth(between)
    noise = COURSE_NOISE * np.abs(angle).max() * np.random.default_rng(seed).standard_normal(len(angle))
    signals = (tn.signals.Signal("T", "torque", u, between=between), tn.signals.Signal("a", "angle", angle + noise))
    test = tn.Measurement(tn.signals.Recording(signals, 200.0), "a", "T", band=(0.5, 28))
    fit = tn.identify(two_masses(c_1=3.0, k_2=180.0, c_2=5.0), test, list(COURSE_TRUE))
    wrong, ends = fit.lack_of_fit.rejected, fit.intervals()
    inside = [not wrong and ends[name][0] <= value <= ends[name][1] for name, value in COURSE_TRUE.items()]
    return list(fit.values.values()), list(fit.standard_errors.values()), inside, wrong


def several_courses(between: str, seeds: range) -> list[Any]:
    return [course_fit(between, seed) for seed in seeds]


def course_rows(between: str, runs: list[Any]) -> list[str]:
    """Table rows of a course, one per parameter: coverage, bias over standard error, fits called wrong."""
    values, errors, inside, wrong = (np.array([run[part] for run in runs]) for part in range(4))
    return [
        f"| {between} | {name} | {100 * inside[:, n].mean():.1f} % | "
        f"{(values[:, n].mean() - true) / np.median(errors[:, n]):+.2f} | {wrong.sum()} |"
        for n, (name, true) in enumerate(COURSE_TRUE.items())
    ]


def several(case: Case, seeds: range) -> list[Any]:
    return [fits(case, seed) for seed in seeds]


def rows(case: Case, runs: list[Any]) -> list[tuple[str, str]]:
    """Table rows, one per parameter: shares of intervals that hold the truth, and scatter of values and errors."""
    found = []
    for column, name in enumerate(case.parameters):
        shares, details = [], []
        for way, (windows, route) in enumerate(WAYS):
            values, errors, inside = (np.array([run[way][part][column] for run in runs]) for part in range(3))
            scatter, wrong = values.std(ddof=1), sum(run[way][3] for run in runs)
            shares.append(f"{100 * inside.mean():.1f} %")
            details.append(
                f"  {windows:11s} {route:8s} bias {100 * (values.mean() / TRUE[name] - 1):+.4f} %, scatter "
                f"{100 * scatter / TRUE[name]:.4f} %, error over scatter {np.median(errors) / scatter:.2f}, "
                f"called wrong {wrong}"
            )
        first = f"| {case.rig} | {name} | {case.sensors} | " + " | ".join(shares) + " |"
        found.append((first, "\n".join([f"{case}, {name}", *details])))
    return found


def one_mass(**values: float) -> tn.Drivetrain:
    """Disc on a spring and a damper."""
    elements = [
        tn.Inertia("disc", node="a", inertia="J"),
        tn.Spring("shaft", nodes=("a", "ground"), stiffness="k"),
        tn.Damper("drag", nodes=("a", "ground"), damping="c"),
    ]
    sensors = {"theta": {"angle": "a"}}
    return tn.Drivetrain("one mass", elements, {**ONE_MASS, **values}, inputs={"T": {"torque": "a"}}, sensors=sensors)


def noisy_response(noise: str, level: float, seed: int, f: Any) -> Any:
    """Response of the mass in closed form, with complex noise of ``level`` times the peak, or times the magnitude."""
    s = 2j * np.pi * f
    exact = 1 / (ONE_MASS["J"] * s**2 + ONE_MASS["c"] * s + ONE_MASS["k"])
    own = NOISES.index(noise), round(1e4 * level), len(f), seed
    scatter = np.random.default_rng(own).standard_normal((2, len(f))) / np.sqrt(2)
    size = np.abs(exact).max() if noise == "constant" else np.abs(exact)
    values = exact + level * size * (scatter[0] + 1j * scatter[1])
    channels = tn.Channel("theta", "rad"), tn.Channel("T", "N*m")
    return tn.FrequencyResponse(f, values[:, None, None], channels[:1], channels[1:])


def response_fits(lines: str, noise: str, level: float, seeds: range) -> list[tuple[Any, Any, Any]]:
    """Values, standard errors, and whether intervals hold the truth, from starts up to 5 % off."""
    found = []
    for seed in seeds:
        test = tn.Measurement(noisy_response(noise, level, seed, ONE_MASS_LINES[lines]), "theta", "T")
        off = np.exp(np.random.default_rng([seed, 1]).uniform(-0.05, 0.05, len(ONE_MASS)))
        fit = tn.identify(one_mass(), test, dict(zip(ONE_MASS, off * list(ONE_MASS.values()), strict=True)))
        inside = [low <= ONE_MASS[name] <= high for name, (low, high) in fit.intervals().items()]
        found.append(([*fit.values.values()], [*fit.standard_errors.values()], inside))
    return found


def responses(seeds: int) -> None:
    """Print a row for each noise: coverage of each parameter, and the largest bias over the standard error."""
    cases = list(product(ONE_MASS_LINES, NOISES, NOISE_LEVELS))
    print(f"| lines | noise | {' | '.join(ONE_MASS)} | withheld | bias over standard error | error over scatter |")
    print("|" + "---|" * (5 + len(ONE_MASS)))
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        every = pool.map(response_fits, *zip(*cases, strict=True), [range(seeds)] * len(cases))
        for case, runs in zip(cases, every, strict=True):
            values, errors, inside = (np.array([run[part] for run in runs]) for part in range(3))
            given = np.isfinite(errors).all(axis=1)
            size = np.median(errors[given], axis=0)
            shares = " | ".join(f"{100 * share:.1f} %" for share in inside[given].mean(axis=0))
            bias = float(np.max(np.abs(values[given].mean(axis=0) - list(ONE_MASS.values())) / size))
            ratios = ", ".join(f"{ratio:.2f}" for ratio in size / values[given].std(axis=0, ddof=1))
            lines, noise, level = case
            row = f"| {lines} | {noise} {100 * level:g} % | {shares} | {100 * (1 - given.mean()):.1f} % | {bias:.2f} |"
            print(row, ratios, "|", flush=True)


def drawn(seeds: int, names: list[str]) -> None:
    """Print the coverage of intervals of machines that are drawn anew for each seed."""
    print("| drawn | draws | intervals | withheld | hold the truth | error over its scale |")
    print("|---|---|---|---|---|---|")
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        parts = [range(first, min(first + AT_ONCE, seeds)) for first in range(0, seeds, AT_ONCE)]
        for name in names:
            shares = pool.map(covered, [name] * len(parts), parts)
            print(drawn_row(name, [one for share in shares for one in share]), flush=True)


def main(seeds: int, pattern: str) -> None:
    began = time.perf_counter()
    chosen = [Case(*both) for both in product(RIGS, SENSORS) if pattern in f"{both[0]}, {both[1]}"]
    parts = [range(first, min(first + AT_ONCE, seeds)) for first in range(0, seeds, AT_ONCE)]
    details = []
    print("| rig | parameter | sensors | " + " | ".join(f"{windows}, {route}" for windows, route in WAYS) + " |")
    print("|" + "---|" * (3 + len(WAYS)))
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        waiting = [(case, [pool.submit(several, case, part) for part in parts]) for case in chosen]
        for case, futures in waiting:
            for first, second in rows(case, [run for future in futures for run in future.result()]):
                print(first, flush=True)
                details.append(second)
        asked = [one for one in COURSES if pattern in f"between samples, {one}"]
        if asked:
            print(
                "\n| between samples | parameter | coverage | bias over standard error | called wrong |\n"
                + "|---" * 5
                + "|"
            )
        for one in asked:
            found = [pool.submit(several_courses, one, part) for part in parts]
            print(*course_rows(one, [run for future in found for run in future.result()]), sep="\n", flush=True)
    print("", *details, f"{seeds} seeds, {time.perf_counter() - began:.0f} s", sep="\n")


if __name__ == "__main__":
    PATTERN = ARGUMENTS[1] if len(ARGUMENTS) > 1 else sized("", "DMF, meter")
    if PATTERN in ("", "response"):
        responses(int(ARGUMENTS[0]) if ARGUMENTS else RESPONSE_SEEDS)
    if PATTERN in ("", *DRAWS):
        drawn(int(ARGUMENTS[0]) if ARGUMENTS else RESPONSE_SEEDS, [name for name in DRAWS if PATTERN in ("", name)])
    if PATTERN not in ("response", *DRAWS):
        main(int(ARGUMENTS[0]) if ARGUMENTS else SEEDS, PATTERN)
