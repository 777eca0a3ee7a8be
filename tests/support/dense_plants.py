"""Random running plants with dense matrices written down here: no assembly, reduction or solver of the package."""

import math
from fractions import Fraction

import numpy as np

import torsionnet as tn

STEPS = 96


class Dense:
    """Matrices, ideal gears as conditions, and mean speeds of a plant drawn at random."""

    def __init__(self, rng):
        self.rng = rng
        self.n = int(rng.integers(6, 10))
        self.M, self.C = np.zeros((self.n, self.n)), np.zeros((self.n, self.n))
        self.K = np.zeros((self.n, self.n), dtype=complex)
        self.rigid, self.elements, self.rows = [], [], {}
        self.turning = np.ones(self.n)
        self.crank = int(rng.integers(2, 5))
        for node in range(self.n):
            inertia = rng.uniform(0.5, 4)
            self.M[node, node] = inertia
            self.elements.append(tn.Inertia(f"J{node}", node=f"n{node}", inertia=inertia))
            if rng.random() < 0.6 or node == self.n - 1:
                c = rng.uniform(0.5, 5)
                self.C[node, node] += c
                self.elements.append(tn.Damper(f"d{node}", nodes=(f"n{node}", "ground"), damping=c))
        for node in range(1, self.n):
            self._join(node - 1 if node <= self.crank else int(rng.integers(self.crank - 1, node)), node)

    def _join(self, first, second):
        name, ends, row = f"e{second}", (f"n{first}", f"n{second}"), np.zeros(self.n)
        k, c = self.rng.uniform(2e4, 3e5), self.rng.uniform(1, 30)
        ratio = float(self.rng.choice([-2.5, -1.5, -2, 1.5, 0.5, 2, -1, -0.5]))
        kinds = ["spring", "spring", "rubber", "shaft", "gear", "mesh"]
        kind = "spring" if second < self.crank else str(self.rng.choice(kinds))
        row[first], row[second] = 1, -ratio if kind in ("gear", "mesh") else -1
        self.turning[second] = self.turning[first] / -row[second]
        loss = 0.0
        if kind == "spring":
            self.elements.append(tn.Spring(name, nodes=ends, stiffness=k, damping=c))
        elif kind == "rubber":
            loss, c = self.rng.uniform(0.05, 0.3), 0.0
            self.elements.append(tn.HystereticSpring(name, nodes=ends, stiffness=k, loss_factor=loss))
        elif kind == "shaft":
            d = self.rng.uniform(0.03, 0.06)
            k = 8e10 * math.pi * (d**4 - (d / 2) ** 4) / 32 / 0.4
            self.elements.append(tn.Shaft(name, nodes=ends, outer_diameter=d, inner_diameter=d / 2, length=0.4,
                                          shear_modulus=8e10, inertia="none", damping=c))  # fmt: skip
            self.modulus = (name, math.pi * (d**4 - (d / 2) ** 4) / (16 * d))
        else:
            mesh = {"stiffness": k, "damping": c} if kind == "mesh" else {}
            self.elements.append(tn.Gear(name, nodes=ends, ratio=ratio, **mesh))
        if kind == "gear":
            self.rigid.append(row)
            return
        self.rows[name] = (kind, row, k * (1 + 1j * loss), c)
        self.K += k * (1 + 1j * loss) * np.outer(row, row)
        self.C += c * np.outer(row, row)

    def angles(self, omega, torque, held=(), twists=()):
        """Angles at omega (rad/s) by torque (n,), imposed angles [(node, angle)] and twists [(name, angle)]."""
        load = np.array(torque, dtype=complex)
        for name, error in twists:
            _, row, k, c = self.rows[name]
            load += row * (k + 1j * omega * c) * error
        matrix = -(omega**2) * self.M + 1j * omega * self.C + self.K
        conditions = [*self.rigid, *(np.eye(self.n)[node] for node, _ in held)]
        size = self.n + len(conditions)
        whole, right = np.zeros((size, size), dtype=complex), np.zeros(size, dtype=complex)
        whole[: self.n, : self.n], right[: self.n] = matrix, load
        for place, row in enumerate(conditions, start=self.n):
            whole[place, : self.n] = whole[: self.n, place] = row * 1e5
        right[self.n + len(self.rigid) :] = [1e5 * angle for _, angle in held]
        return np.linalg.solve(whole, right)[: self.n]

    def torque_in(self, name, omega, angles, error=0.0):
        _, row, k, c = self.rows[name]
        return (k + 1j * omega * c) * (row @ angles - error)


def cylinder(bore, stroke, rod, mass, cycle, pressure, speed):
    """Amplitudes by order of one cylinder firing at angle 0, from samples over its cycle."""
    r, ratio, turns = stroke / 2, stroke / 2 / rod, cycle // 2
    orders = np.arange(1, 13 * turns) / turns

    def rate(phi):
        return np.sin(phi) + ratio * np.sin(2 * phi) / 2 / np.sqrt(1 - (ratio * np.sin(phi)) ** 2)

    def by_order(samples, phi):
        return np.array([2 * np.mean(samples * np.exp(-1j * h * phi)) for h in orders])

    phi = 2 * np.pi * turns * np.arange(len(pressure)) / len(pressure)
    gas = by_order((pressure - 1e5) * math.pi * bore**2 / 4 * r * rate(phi), phi)
    phi, step = 2 * np.pi * turns * np.arange(4096) / 4096, 1e-5
    second = (8 * (rate(phi + step) - rate(phi - step)) - rate(phi + 2 * step) + rate(phi - 2 * step)) / (12 * step)
    return orders, gas, by_order(-mass * r**2 * speed**2 * rate(phi) * second, phi)


def half_range(orders, amplitudes):
    """Of the sum of orders (fractions) of the first shaft over a time that holds the periods of all."""
    cycle = math.lcm(*(order.denominator for order in orders))
    counts = [int(order * cycle) for order in orders]
    spectrum = np.zeros(max(counts) + 1, dtype=complex)
    np.add.at(spectrum, counts, amplitudes)
    wave = np.fft.irfft(spectrum, STEPS * max(counts)) * STEPS * max(counts) / 2
    return (wave.max() - wave.min()) / 2


class Running:
    """A dense plant with an engine, a propeller, an order of a torque and of a mesh; perhaps an imposed angle."""

    def __init__(self, seed):
        self.rng = rng = np.random.default_rng(seed)
        self.dense = d = Dense(rng)
        self.speeds = rng.uniform(20, 60, 3)
        self.cycle = int(rng.choice([2, 4]))
        turns = self.cycle // 2
        phi = 2 * np.pi * turns * np.arange(72 * turns) / (72 * turns)
        away = np.minimum(phi, 2 * np.pi * turns - phi)
        self.motored = 1e5 + 3e6 * np.exp(-((away / 0.6) ** 2))
        self.fired = self.motored + 5e6 * np.exp(-(((phi - 0.3) / 0.4) ** 2))
        self.sizes = (0.1, 0.12, 0.2, rng.uniform(0.5, 3))
        self.order = rng.permutation(d.crank).tolist()
        self.base = int(rng.integers(0, d.n))  # the node that speeds are of
        self.prop, self.shaken = (int(one) for one in rng.integers(0, d.n, 2))
        self.fault = str(rng.choice(["none", "misfire", "gas_off", "each", "spread"]))
        self.held = self._node_to_hold() if rng.random() < 0.4 else None
        self.meshes = [name for name, one in d.rows.items() if one[0] == "mesh"]
        self.relative = d.turning / d.turning[self.base]  # revolutions per revolution of the reference

    def _node_to_hold(self):
        """On no rigid gear, and without a torque of its own."""
        geared = {int(node) for row in self.dense.rigid for node in np.flatnonzero(row)}
        free = set(range(self.dense.crank, self.dense.n)) - geared - {self.prop, self.shaken}
        return min(free, default=None)

    def excitations(self):
        bore, stroke, rod, mass = self.sizes
        engine = {"type": "reciprocating_engine", "speed_of": "n0", "cycle": self.cycle, "bore": bore,
                  "cylinders": {i + 1: f"n{i}" for i in range(self.dense.crank)}, "stroke": stroke, "rod_length": rod,
                  "firing_order": [i + 1 for i in self.order], "reciprocating_mass": mass,
                  "orders": (np.arange(1, 13 * (self.cycle // 2)) / (self.cycle // 2)).tolist(),
                  "gas": {"fired": self.fired.tolist(), "motored": self.motored.tolist()}}  # fmt: skip
        engine |= {"misfire": {"misfire": [1]}, "gas_off": {"gas_off": [1]}, "each": {"misfire": "each"},
                   "spread": {"spread": 0.1}}.get(self.fault, {})  # fmt: skip
        screw = {"type": "propeller", "node": f"n{self.prop}", "blades": 3, "torque": 500, "rated": 30,
                 "blade_orders": {1: {"share": 0.3, "phase": 0.4}, 2: {"share": 0.1, "phase": -1}}}  # fmt: skip
        sources = {"engine": engine, "screw": screw}
        sources["shaker"] = {"type": "harmonic", "node": f"n{self.shaken}", "speed_of": "n0",
                           "orders": {2: {"amplitude": 70, "phase": 1}}}  # fmt: skip
        if self.held is not None:
            sources["held"] = {"type": "harmonic", "node": f"n{self.held}", "orders": {1: {"angle": 1e-3, "phase": 2}}}
        for name in self.meshes[:1]:
            node = f"n{int(np.flatnonzero(self.dense.rows[name][1])[1])}"  # the second wheel of the gear
            sources["teeth"] = {"type": "gear_mesh", "mesh": name, "speed_of": node, "teeth": 5,
                              "transmission_error": {1: {"angle": 2e-4, "phase": 0.5}}}  # fmt: skip
        return sources

    def plant(self):
        dense = self.dense
        return tn.Drivetrain("random", dense.elements, excitations=self.excitations(),
                             speeds={"of": f"n{self.base}", "list": sorted(self.speeds.tolist()), "rated": 30},
                             load={"absorbed_at": f"n{self.prop}", "power": "9 kW", "torque_exponent": 2})  # fmt: skip

    def lines(self, speed, factors=None, out=None):
        """Every line: (excitation, relative order, torques by node, imposed angles, twists)."""
        d, entries = self.dense, self.excitations()
        sense, relative = np.sign(self.relative), [Fraction(one).limit_denominator(10**5) for one in self.relative]
        lines = []

        def line(name, order, shaft, torque=None, held=(), twists=()):
            load = np.zeros(d.n, dtype=complex) if torque is None else torque
            lines.append((name, Fraction(order) * abs(relative[shaft]), load, held, twists))

        own = speed * abs(self.relative[0])
        orders, fired, inertia = cylinder(*self.sizes, self.cycle, self.fired, own)
        motored = cylinder(*self.sizes, self.cycle, self.motored, own)[1]
        angle = {node: place * self.cycle * np.pi / d.crank for place, node in enumerate(self.order)}
        for h, burnt, compressed, moved in zip(orders, fired, motored, inertia, strict=True):
            torque = np.zeros(d.n, dtype=complex)
            for node in range(d.crank):
                gas = burnt * (factors or [1.0] * d.crank)[node]
                if node == 0 and self.fault == "gas_off":
                    gas = 0
                if node == out or (node == 0 and self.fault == "misfire"):
                    gas = compressed
                torque[node] += sense[node] * (gas + moved) * np.exp(-1j * h * angle[node])
            line("engine", h, 0, torque)
        mean = 500 * (speed * abs(self.relative[self.prop]) / 30) ** 2
        unit = np.eye(d.n)
        for order, share, phase in ((3, 0.3, 0.4), (6, 0.1, -1.0)):
            line("screw", order, self.prop, -sense[self.prop] * unit[self.prop] * share * mean * np.exp(1j * phase))
        line("shaker", 2, 0, sense[self.shaken] * unit[self.shaken] * 70 * np.exp(1j))
        if "held" in entries:
            line("held", 1, self.held, held=((self.held, sense[self.held] * 1e-3 * np.exp(2j)),))
        if "teeth" in entries:
            row = d.rows[self.meshes[0]][1]
            wheel = int(np.flatnonzero(row)[1])
            error = 2e-4 * np.exp(0.5j) * row[wheel] * sense[wheel]
            line("teeth", 5, wheel, twists=((self.meshes[0], error),))
        return lines

    def responses(self, speed, **case):
        """Relative orders, names, angles (n_lines, n) and torques by element (n_lines,)."""
        d, lines = self.dense, self.lines(speed, **case)
        angles, torques = [], {name: [] for name in d.rows}
        for _, order, torque, held, twists in lines:
            omega = float(order) * speed
            still = ((self.held, 0.0),) if self.held is not None and not held else ()
            angles.append(d.angles(omega, torque, (*held, *still), twists))
            for name, those in torques.items():
                those.append(d.torque_in(name, omega, angles[-1], dict(twists).get(name, 0.0)))
        return lines, np.array(angles), {name: np.array(those) for name, those in torques.items()}
