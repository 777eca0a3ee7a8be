"""Times of symbolic transfer functions against the times aimed at, medians of one run, as a Markdown table.

Chains are damped and free at both ends, every inertia, stiffness and damping a symbol of its own. Times are those of
calls on an existing `drivetrain.symbolic()`; a fresh one is made for every run, so that nothing is remembered.
"""

import platform
import random
import statistics
import time

import torsionnet as tn
from benchmarks._sizes import sized

RUNS = sized(7, 1)


def chain(size):
    elements, parameters = [], {}
    for i in range(size):
        elements.append(tn.Inertia(f"j{i}", node=f"n{i}", inertia=f"J_{i}"))
        parameters[f"J_{i}"] = 0.1 * (i + 1)
        if i:
            nodes = (f"n{i - 1}", f"n{i}")
            elements.append(tn.Spring(f"k{i}", nodes=nodes, stiffness=f"k_{i}", damping=f"c_{i}"))
            parameters |= {f"k_{i}": 100.0 * i, f"c_{i}": 0.5 * i}
    return tn.Drivetrain(f"chain of {size}", elements, parameters, inputs={"T": {"torque": "n0"}})


def geared_tree(size, seed=1):
    draw = random.Random(seed)
    elements, parameters = [tn.Inertia("j0", node="n0", inertia="J_0")], {"J_0": 1.0}
    for i in range(1, size):
        above = f"n{draw.randrange(max(0, i - 12), i)}"
        elements.append(tn.Inertia(f"j{i}", node=f"n{i}", inertia=f"J_{i}"))
        parameters |= {f"J_{i}": 0.1 + draw.random(), f"k_{i}": 1e3 * (1 + draw.random()), f"c_{i}": draw.random()}
        end = f"n{i}"
        if i % 5 == 0:
            elements.append(tn.Gear(f"g{i}", nodes=(f"m{i}", end), ratio=f"t_{i}"))
            parameters[f"t_{i}"], end = 1 + draw.random(), f"m{i}"
        elements.append(tn.Spring(f"k{i}", nodes=(above, end), stiffness=f"k_{i}", damping=f"c_{i}"))
    return tn.Drivetrain(f"tree of {size}", elements, parameters, inputs={"T": {"torque": "n0"}})


def shafts(count):
    elements, parameters = [tn.Inertia("first", node="n0", inertia="J")], {"J": 0.3, "D": 0.05}
    for i in range(count):
        ends, parameters[f"L_{i}"] = (f"n{i}", f"n{i + 1}"), 0.3 + 0.01 * i
        elements.append(tn.Shaft(f"s{i}", nodes=ends, outer_diameter="D", length=f"L_{i}"))
    return tn.Drivetrain(f"{count} shafts", elements, parameters, inputs={"T": {"torque": "n0"}})


def median_seconds(prepare, work):
    times = []
    for _ in range(RUNS):
        prepared = prepare()
        start = time.perf_counter()
        work(prepared)
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def both_ends(system, size):
    return [system.transfer_function(node, "T").program for node in ("n0", f"n{size - 1}")]


def rows():
    twenty, eight, tree = chain(20), chain(8), geared_tree(200)
    seconds = median_seconds(twenty.symbolic, lambda system: both_ends(system, 20))
    operations = max(table.operations for table in both_ends(twenty.symbolic(), 20))
    yield f"G_11 and G_1N, 20 DOF, straight-line program ({operations} operations, aim 240)", seconds, 0.020

    def function(drivetrain):
        return lambda: drivetrain.symbolic().transfer_function("n0", "T")

    seconds = median_seconds(function(chain(6)), lambda found: found.polynomial.denominator)
    yield "polynomial in s, symbolic coefficients as sympy expressions, 6 DOF", seconds, 0.25
    terms = function(eight)().predicted_terms()
    yield f"fully expanded, 8 DOF ({terms} terms)", median_seconds(function(eight), lambda found: found.expanded()), 0.3
    kept = ["k_1", "c_2"]
    seconds = median_seconds(function(twenty), lambda found: found.keep(kept).polynomial)
    yield "semi-symbolic, 20 DOF, 2 symbols, exact polynomials in s and the symbols", seconds, 0.030
    seconds = median_seconds(tree.symbolic, lambda system: system.transfer_function("n199", "T").program)
    yield "200-node branched geared tree, straight-line program", seconds, 0.5
    seconds = median_seconds(shafts(20).symbolic, lambda system: system.transfer_function("n20", "T").program)
    yield "20 shafts with consistent inertia, straight-line program", seconds, 0.2


def main():
    print(f"{platform.machine()}, Python {platform.python_version()}\n")
    print("| work | median | aim | |")
    print("|---|---|---|---|")
    for work, seconds, aim in rows():
        print(f"| {work} | {1e3 * seconds:.1f} ms | {1e3 * aim:.0f} ms | {'' if seconds < aim else 'over'} |")


if __name__ == "__main__":
    main()
