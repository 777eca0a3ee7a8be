"""Random chains of inertias under orders with phases, solved here from M, C and K on a grid of any step."""

from dataclasses import dataclass

import numpy as np

import torsionnet as tn

RPM = np.pi / 30
LOW, HIGH = 300.0, 800.0
ORDERS = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 4.5, 6.0)


@dataclass(frozen=True)
class Chain:
    """Inertias in a row that turn freely; harmonic torques on the first, and their phases."""

    inertias: np.ndarray
    stiffnesses: np.ndarray
    dampings: np.ndarray
    orders: tuple
    torques: np.ndarray
    at: int

    @classmethod
    def drawn(cls, seed):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(2, 6))
        inertias = 10 ** rng.uniform(-0.5, 1.5, n)
        natural = 2 * np.pi * 10 ** rng.uniform(0.7, 2.2, n - 1)
        stiffnesses = natural**2 * inertias[:-1]
        dampings = 2 * 10 ** rng.uniform(-4.5, -0.8, n - 1) * stiffnesses / natural
        orders = tuple(sorted(rng.choice(ORDERS, int(rng.integers(1, 6)), replace=False).tolist()))
        torques = 10 ** rng.uniform(1, 3, len(orders)) * np.exp(1j * rng.uniform(-np.pi, np.pi, len(orders)))
        return cls(inertias, stiffnesses, dampings, orders, torques, int(rng.integers(n - 1)))

    def model(self, step, value, more=None, stiffness=None, **entries):
        """The drivetrain, its speeds with a step in r/min, and a limit on the torque of one spring."""
        nodes = [f"n{place}" for place in range(len(self.inertias))]
        elements = [
            tn.Inertia(f"J{node}", node=node, inertia=one) for node, one in zip(nodes, self.inertias, strict=True)
        ]
        elements += [
            tn.Spring(
                f"k{place}",
                nodes=(nodes[place], nodes[place + 1]),
                stiffness=stiffness if stiffness and not place else k,
                damping=c,
            )
            for place, (k, c) in enumerate(zip(self.stiffnesses, self.dampings, strict=True))
        ]
        acting = {
            order: {"amplitude": abs(torque), "phase": f"{np.degrees(np.angle(torque))} deg"}
            for order, torque in zip(self.orders, self.torques, strict=True)
        }
        limit = {"rule": "curve", "output": f"torque(k{self.at})", "source": "drawn", **(more or {"value": value})}
        speeds = {"of": "n0", "range": f"{LOW}..{HIGH} rpm", "step": f"{step} rpm", "rated": f"{HIGH} rpm"}
        return tn.Drivetrain("chain", elements, speeds=speeds, limits={"shaft": limit},
                             excitations={"motor": {"type": "harmonic", "node": "n0", "orders": acting}}, **entries)  # fmt: skip

    def half_range(self, rpm):
        """Of the torque of that spring, N m, shape (n,): all orders summed over two revolutions."""
        n = len(self.inertias)
        rows = np.eye(n)[:-1] - np.eye(n)[1:]
        omega = rpm[:, None] * RPM * np.array(self.orders)
        s = 1j * omega
        laws = self.stiffnesses + s[..., None] * self.dampings
        dynamic = np.einsum("pi,...p,pj->...ij", rows, laws, rows) + (s**2)[..., None, None] * np.diag(self.inertias)
        angles = np.linalg.solve(dynamic, np.eye(n)[:, :1])[..., 0]
        torque = laws[..., self.at] * (angles @ rows[self.at]) * self.torques
        wave = (torque @ np.exp(1j * np.outer(self.orders, np.linspace(0, 4 * np.pi, 1201)))).real
        return np.ptp(wave, axis=1) / 2

    def dense(self, around, step=0.02):
        """Speeds in r/min over the whole range, and around some with a step that resolves the sharpest peak."""
        return np.concatenate(
            [np.arange(LOW, HIGH + step / 2, step), *(one + np.linspace(-0.05, 0.05, 801) for one in around)]
        )
