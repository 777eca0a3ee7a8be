"""Random numbers of elements: inertias, stiffnesses, dampings, ratios, dimensions."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

from oracle.description import Measure

SPANS = {  # decades of J, k, c
    "alike": ((-1, 0), (3, 4), (-1, 1)),
    "usual": ((-3, 1), (2, 6), (-2, 2)),
    "wide": ((-5, 5), (1, 11), (-4, 6)),
}
MEASURES = (("zeta", 1, 80), ("Q", 2000, 90000), ("eta", 1, 90), ("psi", 1, 300), ("log_decrement", 1, 500))
"""Name, and the range of its value in thousandths."""


class Numbers:
    """Numbers of one model, which is narrow or wide, lossless or damped throughout."""

    def __init__(self, chance: random.Random) -> None:
        self.chance = chance
        self.spans = SPANS[chance.choices(list(SPANS), (2, 5, 4))[0]]
        self.lossless = chance.random() < 0.25

    def sometimes(self, share: float) -> bool:
        return self.chance.random() < share

    def between(self, low: int, high: int) -> Fraction:
        """Three digits in these decades."""
        digits = Fraction(self.chance.randint(100, 999), 100)
        return digits * Fraction(10) ** self.chance.randint(low, max(low, high - 1))

    def share(self, low: int, high: int, of: int = 1000) -> Fraction:
        """A fraction with a fixed denominator."""
        return Fraction(self.chance.randint(low, high), of)

    @property
    def J(self) -> Fraction:
        return self.between(*self.spans[0])

    @property
    def k(self) -> Fraction:
        return self.between(*self.spans[1])

    @property
    def c(self) -> Fraction:
        return self.between(*self.spans[2])

    def ratio(self) -> dict[str, Any]:
        """Of a gear: teeth, a decimal, or a simple quotient, in both senses."""
        sign, style = self.chance.choice((1, -1)), self.chance.random()
        if style < 0.4:
            return {"teeth": (self.chance.randint(11, 60), sign * self.chance.randint(11, 120))}
        if style < 0.7:
            return {"ratio": sign * self.share(50, 9999)}
        return {"ratio": sign * Fraction(self.chance.randint(1, 12), self.chance.randint(1, 6))}

    def viscous(self, share: float, *, measures: bool = True) -> dict[str, Any]:
        """Damping beside a stiffness: none, a coefficient, or a measure."""
        if self.lossless or not self.sometimes(share):
            return {}
        if not (measures and self.sometimes(0.2)):
            return {"damping": self.c}
        name, low, high = self.chance.choice(MEASURES)
        return {"damping": Measure(name, self.share(low, high), self.between(-1, 3))}

    def mesh(self, share: float) -> dict[str, Any]:
        """Rigid, or a stiffness in this share of the meshes."""
        return {"stiffness": self.k, **self.viscous(0.5)} if self.sometimes(share) else {}

    def loss(self) -> Fraction | Measure:
        value = self.share(5, 600)
        return Measure(self.chance.choice(("zeta", "psi", "log_decrement")), value) if self.sometimes(0.2) else value

    def table(self) -> tuple[tuple[Fraction, ...], ...]:
        """One to four rows around one stiffness, some all alike, some that overdamp, some of films soft at rest."""
        frequencies, k = sorted({self.between(-2, 3) for _ in range(self.chance.randint(1, 4))}), self.k
        rows = tuple((f, k * self.share(50, 200, 100), self.c) for f in frequencies)
        kind = random.Random(repr(rows))  # what is drawn after a table does not depend on its kind
        if kind.random() < 0.2:
            rows = tuple((f, *rows[0][1:]) for f in frequencies)
        if kind.random() < 0.3:
            rows = tuple((f, k, 100 * c) for f, k, c in rows)
        if kind.random() < 0.2:
            rows = tuple((f, k * (place > 0), c) for place, (f, k, c) in enumerate(rows))
        return rows

    def shaft(self) -> dict[str, Any]:
        outer = self.share(10, 300)
        values: dict[str, Any] = {"outer_diameter": outer, "length": self.between(-2, 1)}
        if self.sometimes(0.4):
            values["inner_diameter"] = outer * self.share(1, 9, 10)
        if self.sometimes(0.6):
            values["segments"] = self.chance.randint(1, 4)
        if self.sometimes(0.6):
            values["inertia"] = self.chance.choice(("consistent", "lumped", "none"))
        if self.sometimes(0.3):
            values |= {"shear_modulus": self.between(9, 11), "density": self.between(2, 4)}
        return values | self.viscous(0.4)

    def planetary(self) -> dict[str, Any]:
        sun = self.chance.randint(11, 60)
        teeth = {"teeth": (sun, sun + self.chance.randint(2, 150))}
        values: dict[str, Any] = teeth if self.sometimes(0.5) else {"ratio": 1 + self.share(50, 6000)}
        values |= self.mesh(0.4)
        if self.sometimes(0.5):
            values["planet_inertia"] = self.J
        if self.sometimes(0.4):
            values |= {"planet_mass": self.between(-1, 2), "orbit_radius": self.between(-2, 0)}
        if self.sometimes(0.4):
            values["planets"] = self.chance.randint(1, 5)
        return values
