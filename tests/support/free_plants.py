"""Random controlled drivetrains that turn freely, alone or several at once, and their poles in fifty digits.

The determinant is written down here from the numbers drawn, dense and in mpmath; how many roots it has in a circle is
what the argument principle says, from phases that are followed until no step turns by more than a third of a half turn.
"""

from itertools import pairwise

import mpmath
import numpy as np

import torsionnet as tn

DIGITS = 50
HOLDS = ("nothing", "drag", "spring", "slip", "servo")


class FreePlant:
    """Shafts in a tree, held by nothing, a drag of 1e-4 N m s/rad, a spring, or in two by a slipping damper.

    ``servo`` is one whose speed a controller with an integral holds. Other controllers sense differences of angles, so
    that nothing of them is felt where all turns as one; some of them integrate. Every other plant has delays.
    """

    def __init__(self, seed):
        rng = self.rng = np.random.default_rng(seed)
        self.hold, self.delayed = HOLDS[seed % len(HOLDS)], seed // len(HOLDS) % 2 == 0
        self.n = n = int(rng.integers(2, 6))
        self.laws, self.inertias = [], [self.rounded(10 ** rng.uniform(-1, 2)) for _ in range(n)]
        self.links = []
        self.elements = [tn.Inertia(f"J{i}", node=f"n{i}", inertia=J) for i, J in enumerate(self.inertias)]
        for i in range(1, n):
            other, k, c = (
                int(rng.integers(0, i)),
                self.rounded(10 ** rng.uniform(2, 5)),
                self.rounded(rng.uniform(0, 4)),
            )
            k = 0.0 if self.hold == "slip" and i == n - 1 else k
            self.link(i, other, k, c or 0.5)
        if self.hold == "drag":
            self.link(0, None, 0.0, 1e-4)
        if self.hold == "spring":
            self.link(n - 1, None, self.rounded(10 ** rng.uniform(0, 4)), 0.0)
        for _ in range(int(rng.integers(1, 3))):
            self.control()
        if self.hold == "servo":
            self.act([0], [0], 1, [-30.0, -70.0], [1.0, 0.0], 0.0)
        self.rig = tn.Drivetrain("plant", self.elements)

    def rounded(self, value):
        return float(f"{value:.3g}")

    def link(self, i, j, k, c):
        self.links.append((i, j, k, c))
        ends = (f"n{i}", "ground" if j is None else f"n{j}")
        name = f"link{len(self.links)}"
        self.elements.append(
            tn.Spring(name, nodes=ends, stiffness=k, damping=c) if k else tn.Damper(name, nodes=ends, damping=c)
        )

    def control(self):
        rng = self.rng
        sensed = rng.permutation(self.n)[:2].tolist()
        out = rng.permutation(self.n)[: rng.integers(1, 3)].tolist()
        power = int(rng.integers(0, 2))
        size = (200.0, 3.0)[power]
        above = [self.rounded(size * value) for value in rng.uniform(-1, 1, rng.integers(1, 3))]
        below = ([1.0], [0.02, 1.0], [1.0, 0.0], [0.05, 1.0, 0.0])[int(rng.integers(0, 4))]
        above = above[-len(below) :]
        self.act(out, sensed, power, above, below, self.rounded(rng.uniform(1e-3, 0.1)) if self.delayed else 0.0)

    def act(self, out, sensed, power, above, below, delay):
        """A controller: torque out of nodes, motion sensed, coefficients descending in s."""
        self.laws.append((out, sensed, power, above, below, delay))
        named = [[f"n{i}" for i in nodes] for nodes in (sensed, out)]
        of, act = (one[0] if len(one) == 1 else one for one in named)
        self.elements.append(
            tn.Controller(
                f"act{len(self.laws)}",
                sense={("angle", "velocity")[power]: of},
                act=act,
                law={"numerator": above, "denominator": below},
                delay=delay,
            )
        )

    def determinant(self, s):
        """Of angles and torques; a factor s in a denominator against that of a sensed velocity is no state."""
        n = self.n
        P = mpmath.zeros(n + len(self.laws))
        for i, J in enumerate(self.inertias):
            P[i, i] = mpmath.mpf(repr(J)) * s * s
        for i, j, k, c in self.links:
            value = mpmath.mpf(repr(k)) + s * mpmath.mpf(repr(c))
            ends = [(i, 1)] + ([] if j is None else [(j, -1)])
            for a, x in ends:
                for b, y in ends:
                    P[a, b] += x * y * value
        for place, (out, sensed, power, above, below, delay) in enumerate(self.laws, n):
            cancels = power > 0 and below[-1] == 0
            N, E = (
                mpmath.polyval([mpmath.mpf(repr(x)) for x in part], s)
                for part in (above, below[:-1] if cancels else below)
            )
            P[place, place] = E
            for b, y in zip(sensed, (1, -1), strict=False):
                P[place, b] -= y * N * s ** (power - cancels) * mpmath.exp(-s * mpmath.mpf(repr(delay)))
            for a, x in zip(out, (1, -1), strict=False):
                P[a, place] -= x
        return mpmath.det(P)

    def within(self, radius, points=240):
        """Roots in a circle around zero."""

        def phase(angle):
            value = self.determinant(mpmath.mpf(radius) * mpmath.expj(angle))
            return complex(value / abs(value))

        with mpmath.workdps(DIGITS):
            angles = [mpmath.pi * k / points for k in range(points + 1)]
            ends = [(angle, phase(angle)) for angle in angles]
            stack, turned = list(pairwise(ends)), 0.0
            while stack:
                (a, p), (b, q) = stack.pop()
                middle = ((a + b) / 2, phase((a + b) / 2))
                one, two = np.angle(middle[1] / p), np.angle(q / middle[1])
                if abs(one) < 0.5 and abs(two) < 0.5:
                    turned += one + two
                else:
                    stack += [((a, p), middle), (middle, (b, q))]
        return round(turned / np.pi)

    def moved(self, pole):
        """How far a pole is from the root of the determinant next to it, relative, by one step of the secant method."""
        with mpmath.workdps(DIGITS):
            step, s = mpmath.mpf(10) ** -15, mpmath.mpmathify(complex(pole))
            here, beside = self.determinant(s), self.determinant(s * (1 + step))
            return float(abs(here * step / (beside - here)))
