"""Modes of many variants at once against a loop over ``modes()``, in one run, as Markdown.

The loop is measured on a few hundred variants, with and without what it takes to make each of them; both sides have to
agree to 1e-9 on these.
"""

import os
import platform
import time
import warnings
from pathlib import Path

import numpy as np

import torsionnet as tn
from benchmarks._sizes import ARGUMENTS, sized
from torsionnet.linear.batch.batch_plan import batch_plan
from torsionnet.linear.batch.batched_modes import batched_modes
from torsionnet.linear.batch.mode_tracking import track_modes

COUNT, LOOP = sized((100_000, 300), (400, 20))
CHUNK = 5000  # variants of a batch
RIG = "rig with 6 DOF"
GOAL = 30
"""Least ratio of times of that rig, ``modes()`` alone over the batch."""
TOLERANCE = 1e-9
"""Largest relative difference of both ways, more than which is no rounding error."""


def rig():
    """Drivetrain of six discs, five shafts with damping, and a bearing."""
    elements, parameters = [tn.Damper("bearing", nodes=("n0", "ground"), damping="c_b")], {"c_b": 0.3}
    for i in range(6):
        elements.append(tn.Inertia(f"disc_{i}", node=f"n{i}", inertia=f"J_{i}"))
        parameters[f"J_{i}"] = 0.2 + 0.1 * i
    for i in range(5):
        elements.append(tn.Spring(f"shaft_{i}", nodes=(f"n{i}", f"n{i + 1}"), stiffness=f"k_{i}", damping=f"c_{i}"))
        parameters |= {f"k_{i}": 1e4 * (1 + 0.3 * i), f"c_{i}": 1 + 0.2 * i}
    return tn.Drivetrain(RIG, elements, parameters)


def models():
    yield rig()
    yield tn.load("amt_rig").configured("II")
    yield tn.load("turbine_generator_ssr")
    yield tn.load("two_stroke_ship").configured("normal")


def scattered(model, count):
    """Random values by parameter, with a standard deviation of 10 % about those of the model."""
    source = np.random.default_rng(1)
    basic = [name for name, one in model.parameter_definitions.items() if not one.value.names]
    names = [name for name in basic if model.parameters[name] and batch_plan(model, [name]) is not None]
    return {name: model.parameters[name] * np.exp(0.1 * source.standard_normal(count)) for name in names}


def chunks(values):
    for start in range(0, COUNT, CHUNK):
        yield {name: column[start : start + CHUNK] for name, column in values.items()}


def in_batches(plan, values, then=lambda found: found):
    """Seconds per variant for batches and their modes, the modes of the first batch, and the number solved singly."""
    start, first, doubtful = time.perf_counter(), None, 0
    for some in chunks(values):
        found = batched_modes(plan.batch(some))
        then(found)
        first, doubtful = first or found, doubtful + int(found.uncertain.sum())
    return (time.perf_counter() - start) / COUNT, first, doubtful


def in_a_loop(model, values):
    """Seconds per variant for making it, and for its modes, and the modes."""
    making, solving, found = 0.0, 0.0, []
    for place in range(LOOP):
        start = time.perf_counter()
        one = model.configured(**{name: float(column[place]) for name, column in values.items()})
        made = time.perf_counter()
        found.append(one.modes())
        making, solving = making + made - start, solving + time.perf_counter() - made
    return making / LOOP, solving / LOOP, found


def largest_difference(found, singles):
    """Largest differences of natural frequencies (relative) and of damping ratios."""
    worst = 0.0
    for place, single in enumerate(singles):
        own = ~np.isnan(found.eigenvalues[place])
        f, z = single.natural_frequencies, single.damping_ratios
        worst = max(worst, *(np.abs(found.natural_frequencies[place, own] - f) / np.where(f > 0, f, 1)))
        worst = max(worst, *np.nan_to_num(np.abs(found.damping_ratios[place, own] - z)))
    return worst


def table():
    heads = ("batch", "with tracking", "`modes()`", "with `configured`", "ratio", "doubtful", "equal to", "")
    yield f"| {COUNT} variants; us each | {' | '.join(heads)} |"
    yield f"|---{'|---' * len(heads)}|"
    for model in models():
        values = scattered(model, COUNT)
        plan = batch_plan(model, list(values))
        making, solving, singles = in_a_loop(model, values)
        batch, found, doubtful = in_batches(plan, values)
        followed, *_ = in_batches(plan, values, then=lambda one: track_modes(one).natural_frequencies)
        worst, ratio = largest_difference(found, singles), solving / batch
        times = (batch, followed, solving, solving + making)
        reached = "" if model.name != RIG else "reached" if ratio >= GOAL and worst <= TOLERANCE else "missed"
        cells = [*(f"{1e6 * value:.0f}" for value in times), f"{ratio:.0f}", str(doubtful), f"{worst:.1e}", reached]
        yield f"| {model.title} | {' | '.join(cells)} |"


def main():
    warnings.simplefilter("ignore")
    lines = [
        f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}, numpy {np.__version__}",
        "",
    ]
    print(*lines, sep="\n")
    for line in table():
        print(line, flush=True)
        lines.append(line)
    if ARGUMENTS:
        Path(ARGUMENTS[0]).write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
