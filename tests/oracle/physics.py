"""Laws and rigid conditions of every element, from its mechanics alone."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import acb, arb

from oracle.description import Measure, Part
from oracle.exact import Row, Scalar, ball, combination, imaginary

ZERO = Fraction(0)


@dataclass(frozen=True)
class Law:
    """Torque (J s^2 + c s + k (1 + j eta) + table) gamma on the row gamma."""

    owner: str
    row: Row
    J: Scalar = ZERO
    c: Scalar = ZERO
    k: Scalar = ZERO
    eta: Scalar = ZERO
    table: tuple[tuple[Fraction, Fraction, Fraction], ...] = ()

    @property
    def depends_on_frequency(self) -> bool:
        return bool(self.table) or self.eta != 0

    def acts(self, laws: str) -> bool:
        """Whether one of the named laws is there; a table acts at rest as its first row does."""
        at_rest = dict(zip("kc", self.table[0][1:], strict=True)) if self.table else {}
        return any(getattr(self, law) != 0 or at_rest.get(law, 0) != 0 for law in laws)

    def kappa(self, s: acb, omega: arb | None = None) -> acb:
        """Dynamic stiffness at s; what depends on frequency is taken at ``omega`` in rad/s (default Im s)."""
        value = ball(self.J) * s * s + ball(self.c) * s + ball(self.k)
        if not self.depends_on_frequency:
            return value
        omega = s.imag if omega is None else omega
        if self.eta != 0 and not omega == 0:  # noqa: SIM201  (balls)
            value += imaginary(ball(self.k) * ball(self.eta))
        if self.table:
            k, c = interpolated(self.table, omega / (2 * arb.pi()))
            value += k + s * c
        return value


@dataclass(frozen=True)
class Condition:
    """The row stays at zero; ``label`` tells the conditions of one owner apart."""

    owner: str
    row: Row
    label: str


def interpolated(table: Iterable[tuple[Fraction, Fraction, Fraction]], frequency: arb) -> tuple[arb, arb]:
    """k and c of a table at a frequency in Hz: linear between the rows, constant beyond them."""
    rows = [tuple(ball(cell) for cell in row) for row in table]
    if not frequency > rows[0][0]:
        return rows[0][1], rows[0][2]
    for (f0, k0, c0), (f1, k1, c1) in pairwise(rows):
        if not frequency > f1:
            share = (frequency - f0) / (f1 - f0)
            return k0 + share * (k1 - k0), c0 + share * (c1 - c0)
    return rows[-1][1], rows[-1][2]


# --- damping --------------------------------------------------------------------------------------------------------


def loss_factor(measure: Measure) -> Scalar:
    """eta = 2 zeta = 1/Q = psi / 2 pi, and zeta = delta / sqrt(4 pi^2 + delta^2)."""
    value = measure.value
    if measure.name == "psi":
        return lambda: ball(value) / (2 * arb.pi())
    if measure.name == "log_decrement":
        return lambda: 2 * ball(value) / ((2 * arb.pi()) ** 2 + ball(value) ** 2).sqrt()
    return {"zeta": lambda: 2 * value, "Q": lambda: 1 / value, "magnifier": lambda: 1 / value, "eta": lambda: value}[
        measure.name
    ]()


def viscous(damping: Any, k: Scalar) -> Scalar:
    """c itself, or that which loses eta at the stated frequency: c = eta k / 2 pi f."""
    if not isinstance(damping, Measure):
        return Fraction(damping or 0)
    eta, at = loss_factor(damping), damping.at
    return lambda: ball(eta) * ball(k) / (2 * arb.pi() * ball(at))


# --- elements -------------------------------------------------------------------------------------------------------


def twist_row(part: Part) -> dict[str, Fraction]:
    """The motion an element resists; its ground end is kept, as the node of no angle."""
    at = part.ports
    match part.kind:
        case "inertia" | "lock":
            return combination((at["node"], 1))
        case "differential":
            return combination((at["cage"], 2), (at["left"], -1), (at["right"], -1))
        case "planetary":
            # seen from the carrier the sun turns -z times as fast as the ring
            z = part.ratio
            return combination((at["sun"], 1), (at["carrier"], -1), (at["ring"], z), (at["carrier"], -z))
        case "gear":
            # seen from the housing the first shaft turns tau times as fast as the second
            tau, housing = part.ratio, at.get("housing", "ground")
            return combination((at["first"], 1), (housing, -1), (at["second"], -tau), (housing, tau))
        case _:
            return combination((at["first"], 1), (at["second"], -1))


def planets(part: Part) -> list[Law]:
    """The planets roll on the sun: each turns with the carrier less the sun's relative speed over the teeth."""
    v, at = part.values, part.ports
    share = 2 / (part.ratio - 1)  # teeth of the sun over those of a planet, (ring - sun) / 2
    spin = combination((at["carrier"], 1), (at["sun"], -share), (at["carrier"], share))
    number = v.get("planets", 3)
    orbit = number * v.get("planet_mass", ZERO) * v.get("orbit_radius", ZERO) ** 2
    return [
        Law(part.name, spin, J=number * v.get("planet_inertia", ZERO)),
        Law(part.name, combination((at["carrier"], 1)), J=orbit),
    ]


def shaft(part: Part) -> list[Law]:
    """Segments in series; a linear twist stores 1/2 J/6 (a^2 + b^2 + (a + b)^2), J being that of the segment."""
    v = part.values
    number = v.get("segments", 1)
    fourth = v["outer_diameter"] ** 4 - v.get("inner_diameter", ZERO) ** 4
    polar = fourth / 32  # times pi
    k_over_pi = v.get("shear_modulus", Fraction("79.3e9")) * polar / v["length"]
    J_over_pi = v.get("density", Fraction(7850)) * polar * v["length"]
    segment_c = _times(number, viscous(v.get("damping"), _pi_times(k_over_pi)))
    segment_k, segment_J = k_over_pi * number, J_over_pi / number
    laws: list[Law] = []
    for left, right in pairwise((part.ports["first"], *part.internal, part.ports["second"])):
        laws.append(Law(part.name, combination((left, 1), (right, -1)), c=segment_c, k=_pi_times(segment_k)))
        ends = [combination((left, 1)), combination((right, 1))]
        if v.get("inertia") == "lumped":
            laws += [Law(part.name, end, J=_pi_times(segment_J / 2)) for end in ends]
        elif v.get("inertia") != "none":
            rows = (*ends, combination((left, 1), (right, 1)))
            laws += [Law(part.name, row, J=_pi_times(segment_J / 6)) for row in rows]
    return laws


def _pi_times(value: Fraction) -> Scalar:
    return (lambda: ball(value) * arb.pi()) if value else ZERO


def _times(number: int, value: Scalar) -> Scalar:
    return (lambda: number * value()) if callable(value) else number * value


def laws_of(part: Part) -> list[Law]:
    v, row = part.values, twist_row(part)
    match part.kind:
        case "shaft":
            return shaft(part)
        case "inertia":
            return [Law(part.name, row, J=v["inertia"])]
        case "damper":
            return [Law(part.name, row, c=v["damping"])]
        case "tabulated_spring":
            return [Law(part.name, row, table=tuple(tuple(cells) for cells in v["table"]))]
    laws = [] if part.is_rigid else [elastic(part, row)]
    return [*laws, *planets(part)] if part.kind == "planetary" else laws


def elastic(part: Part, row: Row) -> Law:
    """A spring or a compliant mesh."""
    v = part.values
    eta = v.get("loss_factor", ZERO)
    c = viscous(v.get("damping"), v["stiffness"])
    return Law(part.name, row, c=c, k=v["stiffness"], eta=loss_factor(eta) if isinstance(eta, Measure) else eta)


def conditions_of(part: Part) -> list[Condition]:
    if not part.is_rigid:
        return []
    if part.kind == "differential" and part.values.get("locked"):
        cage = part.ports["cage"]
        rows = [combination((cage, 1), (part.ports[side], -1)) for side in ("left", "right")]
        return [Condition(part.name, row, f"{part.name}#{i}") for i, row in enumerate(rows)]
    return [Condition(part.name, twist_row(part), part.name)]
