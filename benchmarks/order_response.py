"""Times of the orders of a six-cylinder engine over speed, beside a dense numpy solve per order and speed."""

import json
import time

import numpy as np

import torsionnet as tn
from benchmarks._sizes import sized

SPEEDS = sized(241, 20)
ORDERS = np.arange(0.5, 12.1, 0.5)
OUTPUTS = ["twist(k1)", "twist(k3)", "twist(k5)", "twist(k7)", "m0"]


def plant(n=12):
    inertias = [tn.Inertia(f"J{i}", node=f"m{i}", inertia=0.1 + 0.3 * (i == 7)) for i in range(n)]
    springs = [tn.Spring(f"k{i}", nodes=(f"m{i}", f"m{i + 1}"), stiffness=2e6, damping=20) for i in range(n - 1)]
    phi = 4 * np.pi * np.arange(720) / 720
    pressure = 2e6 + 4e6 * np.exp(-8 * (1 - np.cos(phi / 2 - 0.1)))
    engine = {
        "type": "reciprocating_engine",
        "speed_of": "m1",
        "cycle": 4,
        "cylinders": {i: f"m{i}" for i in range(1, 7)},
        "firing_order": [1, 5, 3, 6, 2, 4],
        "bore": 0.13,
        "stroke": 0.16,
        "rod_length": 0.26,
        "reciprocating_mass": 4.6,
        "gas": {"fired": pressure.tolist()},
    }
    speeds = {"of": "m1", "list": (np.linspace(60, 240, SPEEDS)).tolist()}
    return tn.Drivetrain("inline six", [*inertias, *springs], excitations={"engine": engine}, speeds=speeds)


def dense(rig):
    """Amplitudes by a dense assembly and solve for every speed and order, shape (n_speeds, n_orders, 5)."""
    system = rig.assembly.system
    loads = rig.definition.excitations["engine"].torques(np.array(rig.definition.speeds.values))
    place = [rig.nodes.index(node) for node in loads.nodes]
    rows = np.zeros((5, len(rig.nodes)))
    for number, k in enumerate((1, 3, 5, 7)):
        rows[number, k], rows[number, k + 1] = 1, -1
    rows[4, 0] = 1
    found = np.zeros((SPEEDS, len(ORDERS), 5), dtype=complex)
    for i, speed in enumerate(rig.definition.speeds.values):
        for j, order in enumerate(ORDERS):
            w = order * speed
            load = np.zeros(len(rig.nodes), dtype=complex)
            load[place] = loads.amplitudes[i, j]
            found[i, j] = rows @ np.linalg.solve(system.K + 1j * w * system.C - w**2 * system.M, load)
    return found


CONDITIONS = {
    "normal": {},
    **{f"misfire_{number}": {"engine.misfire": [number]} for number in range(1, 7)},
    "gas_off": {"engine.gas_off": [3]},
}


def marine():
    """Print the CPU time of the marine plant of the library with eight conditions, which share the frequency responses.

    The propeller's damping is that of full power at all speeds; where it follows the speed nothing is shared.
    """
    data = tn.load("marine_medium_speed").definition.to_data()
    data["configurations"] = {"firing": CONDITIONS}
    del data["report"]  # whose normal condition names another axis
    speeds = (np.linspace(300, 788, SPEEDS) * np.pi / 30).tolist()
    data["speeds"] = {"of": "fly", "list": speeds, "rated": "750 rpm"}
    rig = tn.loads(json.dumps(data)).configured(Q_prop="188.7 kN*m", n_prop="151.8 rpm")
    outputs = ["T_crank", "T_cpl", "T_mesh", "T_int", "T_tail"]
    rig.configured("normal").order_response(outputs, speeds=[50.0])  # imports and plans
    start = time.process_time()
    for name in CONDITIONS:
        largest = rig.configured(name).order_response(outputs).half_range.max()
        assert largest > 0
    took = time.process_time() - start
    what = f"{SPEEDS} speeds x 26 orders x 5 outputs x {len(CONDITIONS)} conditions"
    print(f"\nmarine plant, {what}, half ranges included: {took:.3f} s of CPU")


def main():
    rig = plant()
    rig.order_response(OUTPUTS, speeds=[100.0])  # imports and plans
    start = time.process_time()
    run = rig.order_response(OUTPUTS)
    ours = time.process_time() - start
    start = time.process_time()
    reference = dense(rig)
    theirs = time.process_time() - start
    off = np.abs(run.values - reference).max() / np.abs(reference).max()
    print(f"{SPEEDS} speeds x {len(ORDERS)} orders x 6 cylinders x 5 outputs")
    print("| | CPU s |\n|---|---|")
    print(f"| `order_response` | {ours:.3f} |\n| numpy, solve by solve | {theirs:.3f} |")
    print(f"largest difference over the largest value: {off:.1e}")
    marine()


if __name__ == "__main__":
    main()
