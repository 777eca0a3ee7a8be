"""Random plants with clearances, stages and friction, for motions over time that are compared with those of CVODE."""

from dataclasses import dataclass

import numpy as np

import torsionnet as tn


@dataclass
class MovingPlant:
    """A plant, torques a + b t in N m by node as pairs (a, b), and speeds in rad/s at the start."""

    drivetrain: tn.Drivetrain
    torques: dict[str, tuple[float, float]]
    speeds: dict[str, float]

    def functions(self):
        return {node: (lambda t, a=a, b=b: a + b * t) for node, (a, b) in self.torques.items()}

    def samples(self, times):
        return {node: a + b * times for node, (a, b) in self.torques.items()}


def moving_plant(seed, most=20):
    """Tree of 2 to ``most`` inertias joined by springs, stages, clearances, backlash and pairs that rub."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, most + 1))
    elements = []
    for node in range(n):
        elements.append(tn.Inertia(f"J{node}", node=f"n{node}", inertia=10 ** rng.uniform(-1, 0.5)))
        if rng.random() < 0.5:
            damping = rng.uniform(0.05, 1)
            elements.append(tn.Damper(f"d{node}", nodes=(f"n{node}", "ground"), damping=damping))
    kinds = ["spring"] * (n - 1)
    for place in rng.permutation(n - 1)[: int(rng.integers(1, 5))]:
        kinds[place] = str(rng.choice(["clearance", "stages", "backlash", "table", "cogged"]))
    for node, kind in enumerate(kinds, start=1):
        nodes = (f"n{int(rng.integers(max(node - 2, 0), node))}", f"n{node}")
        elements += joined(rng, f"e{node}", nodes, kind)
    rubbing = rng.random()
    if rubbing < 0.5:
        torque = rng.uniform(2, 10)
        elements.append(
            tn.Friction("rub", nodes=(f"n{int(rng.integers(n))}", "ground"), torque=torque, stick=1.2 * torque)
        )
    if rubbing > 0.3:
        torque, stiffness = rng.uniform(2, 10), rng.uniform(2e3, 2e4)
        rubs = (f"n{int(rng.integers(n))}", "ground")
        elements.append(tn.Friction("ring", nodes=rubs, torque=torque, stiffness=stiffness))
    elements.append(
        tn.Spring("foot", nodes=("n0", "ground"), stiffness=rng.uniform(500, 5000), damping=rng.uniform(0, 5))
    )
    torques = {f"n{node}": tuple(rng.uniform(-60, 60, 2)) for node in rng.permutation(n)[:2]}
    speeds = {f"n{node}": rng.uniform(-5, 5) for node in range(n)}
    return MovingPlant(tn.Drivetrain(f"plant {seed}", elements), torques, speeds)


def joined(rng, name, nodes, kind):
    """Elements of one kind between two nodes."""
    k, c = 10 ** rng.uniform(3, 4.7), float(rng.choice([0, rng.uniform(0.1, 10)]))
    if kind == "clearance":
        return [tn.Clearance(name, nodes=nodes, gap=rng.uniform(1e-3, 2e-2), stiffness=k, damping=c)]
    if kind == "cogged":
        gap = tn.Clearance(name, nodes=nodes, gap=rng.uniform(1e-3, 2e-2), stiffness=k, damping=c)
        return [gap, tn.Spring(f"{name}s", nodes=nodes, stiffness=k / 20, damping=0.5)]
    if kind == "backlash":
        ratio = float(rng.choice([-2, 1.5, 2, -1]))
        return [tn.Gear(name, nodes=nodes, ratio=ratio, backlash=rng.uniform(1e-3, 1e-2), stiffness=k, damping=c)]
    if kind == "stages":
        ends = np.cumsum(rng.uniform(2e-3, 1e-2, 2))
        stages = [{"stiffness": k / 4, "to": f"{ends[0]} rad"}, {"stiffness": k / 2, "to": f"{ends[1]} rad"}]
        return [tn.Spring(name, nodes=nodes, stages=[*stages, {"stiffness": k}], damping=c)]
    if kind == "table":
        rows = [[-1.0, -k], [-5e-3, -5e-3 * k], [4e-3, 2e-3 * k], [1.0, 2.5 * k]]
        return [tn.Spring(name, nodes=nodes, torque_over_twist=rows, damping=c)]
    return [tn.Spring(name, nodes=nodes, stiffness=k, damping=c)]
