"""Random trees with controllers, and their matrices written out without assembly."""

import numpy as np

import torsionnet as tn

FREQUENCIES = np.array([0.05, 0.7, 1.3, 2.9, 8.0])


class Plant:
    """A random tree with controllers, and its dense M, C, K and laws.

    Every other one turns ``freely``: neither dragged nor sensed against the ground, so that zero is a double root. Every
    fourth consists of two trees ``apart``, between which a damper slips.
    """

    def __init__(self, seed, delay=False, forms=("gain", "pid", "polynomials", "roots", "matrices"), freely=None):
        rng = self.rng = np.random.default_rng(seed)
        self.freely = seed // 2 % 2 > 0 if freely is None else freely
        self.apart = self.freely and seed // 4 % 2 > 0
        self.n = n = int(rng.integers(3, 7))
        self.M, self.C, self.K = np.diag(rng.uniform(0.5, 3, n)), np.zeros((n, n)), np.zeros((n, n))
        self.elements = [tn.Inertia(f"J{i}", node=f"n{i}", inertia=float(self.M[i, i])) for i in range(n)]
        for i in range(1, n):
            row = np.zeros(n)
            row[i], row[int(rng.integers(0, i))] = 1, -1
            k, c = rng.uniform(50, 400), rng.uniform(0.5, 5)
            ends = (f"n{i}", f"n{int(np.argmin(row))}")
            self.C += c * np.outer(row, row)
            if self.apart and i == self.n - 1:
                self.elements.append(tn.Damper(f"k{i}", nodes=ends, damping=c))
                continue
            self.K += k * np.outer(row, row)
            self.elements.append(tn.Spring(f"k{i}", nodes=ends, stiffness=k, damping=c))
        if not self.freely:
            self.C[0, 0] += 3
            self.elements.append(tn.Damper("bearing", nodes=("n0", "ground"), damping=3))
        self.laws = [self._controller(number, forms, delay) for number in range(int(rng.integers(1, 4)))]
        self.rig = tn.Drivetrain("plant", self.elements)

    def _nodes(self, least=1):
        order = self.rng.permutation(self.n)
        nodes = order[: max(least, self.rng.integers(1, 3))]
        row = np.zeros(self.n)
        row[nodes[0]] = 1
        if len(nodes) > 1:
            row[nodes[1]] = -1
        names = [f"n{node}" for node in nodes]
        return row, names[0] if len(names) == 1 else names

    def _controller(self, number, forms, delay):
        rng = self.rng
        out, act = self._nodes()
        sensed, of = self._nodes(2 if self.freely else 1)
        power = int(rng.integers(0, 3))
        law, H = self.law(str(rng.choice(forms)), power)
        tau = float(rng.uniform(0.01, 0.2)) if delay else 0.0
        quantity = ("angle", "velocity", "acceleration")[power]
        element = tn.Controller(f"act{number}", sense={quantity: of}, act=act, law=law, delay=tau)
        self.elements.append(element)
        return out, sensed, lambda s: s**power * H(s) * np.exp(-s * tau)

    def law(self, form, power):
        rng = self.rng
        size = (30, 3, 0.3)[power]
        a, b, c, d = (float(value) for value in size * rng.uniform(-1, 1, 4))
        w = float(rng.uniform(2, 20))
        if form == "gain":
            return a, lambda s: a + 0 * s
        if form == "pid":
            d, T = d / 10, 0.1
            return {"p": a, "i": b, "d": d, "filter": T}, lambda s: a + b / s + d * s / (1 + T * s)
        if form == "polynomials":
            return {
                "numerator": [a, b],
                "denominator": [1 / w, 0.5, w],
            }, lambda s: (a * s + b) / (s * s / w + s / 2 + w)
        if form == "roots":

            def H(s):
                return c * (s + 3) * (s + 1) / ((s + w) * ((s + 1) ** 2 + w * w))

            return {"gain": c, "zeros": [-3, -1], "poles": [-w, [-1, w]]}, H
        A, B, C = [[-1, w], [-w, -2]], [[1], [2]], [[a, b]]

        def of_matrices(s):
            return (np.array(C) @ np.linalg.solve(s * np.eye(2) - np.array(A), np.array(B))).item() + c

        return {"A": A, "B": B, "C": C, "D": [[c]]}, of_matrices

    def dynamic_stiffness(self, s):
        D = self.M * s**2 + self.C * s + self.K
        for out, sensed, kappa in self.laws:
            D = D - kappa(s) * np.outer(out, sensed)
        return D

    def torque(self, number, motion, s):
        _, sensed, kappa = self.laws[number]
        return kappa(s) * (sensed @ motion)
