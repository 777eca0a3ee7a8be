"""Lines of the verification manual on closed forms of the literature that no case of tests/validation holds."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from verification_lines import Line

import torsionnet as tn

INERTIA, STIFFNESS = 2.0, 8e4
"""Mass in kg m^2 on a spring in N m/rad; the results do not depend on either."""
UNTUNED, TUNED = (0.2, 0.5, 1.0), 0.2
"""Inertia of the ring over that of the mass: those that Den Hartog's chapter tabulates, and one for the tuned ring."""
FOUND_WITHIN, FLAT_WITHIN = 1e-6, 1e-4
"""Relative deviations allowed: of a largest response, and of the damping at which it is reached, where the curve is
flat."""


def damper_lines() -> Iterator[Line]:
    """Lines of the best untuned and tuned damper on a mass on a spring."""
    own = math.sqrt(STIFFNESS / INERTIA)
    for mu in UNTUNED:
        found = _plant(mu, 100.0, 0.0).damper_design("a", "c", input="a")
        zeta = 1 / math.sqrt(2 * (1 + mu) * (2 + mu))
        reached = found.values["c"] / (2 * mu * INERTIA * own)
        source = "Den Hartog"
        yield Line(
            f"untuned, $\\mu = {mu:g}$: peak", "", 1 + 2 / mu, found.after.level * STIFFNESS, FOUND_WITHIN, source
        )
        yield Line(f"untuned, $\\mu = {mu:g}$: $\\zeta$", "", zeta, reached, FLAT_WITHIN, source)
    mu = TUNED
    plant = _plant(mu, 0.4 * mu * INERTIA * own, 1.3 * mu * STIFFNESS)
    found = plant.damper_design("a", {"c": None, "k_film": None}, input="a")
    ring = math.sqrt(found.values["k_film"] / (mu * INERTIA))
    root = math.sqrt(4 + 3 * mu)
    square = 2 * (16 + 23 * mu + 9 * mu**2 + 2 * (2 + mu) * root) / (3 * (64 + 80 * mu + 27 * mu**2))
    tuning, zeta = 2 / (1 + mu) * math.sqrt(square), math.sqrt((8 + 9 * mu - 4 * root) / (1 + mu)) / 4
    source = "Nishihara, Asami"
    yield Line(f"tuned, $\\mu = {mu:g}$: frequency ratio", "", tuning, ring / own, FLAT_WITHIN, source)
    reached = found.values["c"] / (2 * mu * INERTIA * ring)
    yield Line(f"tuned, $\\mu = {mu:g}$: $\\zeta$", "", zeta, reached, FLAT_WITHIN, source)


def _plant(mu: float, damping: float, stiffness: float) -> tn.Drivetrain:
    """Mass on a spring with a ring in a film."""
    return tn.Drivetrain(
        "mass with a ring",
        [
            tn.Inertia("mass", node="a", inertia=INERTIA),
            tn.Spring("shaft", nodes=("a", "ground"), stiffness=STIFFNESS),
            tn.ViscousDamper("damper", node="a", ring_inertia=mu * INERTIA, damping="c", stiffness="k_film"),
        ],
        parameters={"c": f"{damping} N*m*s/rad", "k_film": f"{stiffness} N*m/rad"},
    )


SHAFT = {"outer_diameter": 0.1, "length": 2.0, "shear_modulus": 79.3e9, "density": 7850.0}
"""Uniform shaft of steel in SI units; the quotients of its natural frequencies do not depend on them."""
SHAFT_MODES = 4


def shaft_lines() -> Iterator[Line]:
    """Lines of a continuous shaft with one end held: odd quarter waves, f_n = (2 n - 1)/(4 L) sqrt(G/rho)."""
    held = tn.Drivetrain("held", [tn.ContinuousShaft("s", nodes=("a", "b"), **SHAFT), tn.Lock("l", node="a")])
    found = held.modes(lowest=SHAFT_MODES).undamped_natural_frequencies
    unit = math.sqrt(SHAFT["shear_modulus"] / SHAFT["density"]) / (4 * SHAFT["length"])
    for number, value in enumerate(found.tolist(), 1):
        yield Line(f"held shaft $f_{{{number}}}$", "Hz", (2 * number - 1) * unit, value, 1e-12, "wave equation")


def passing_lines() -> Iterator[Line]:
    """Lines of one mass on a spring: peak of its receptance and where it lies, by the closed form."""
    zeta, own = 0.1, math.sqrt(STIFFNESS / INERTIA)
    damping = 2 * zeta * math.sqrt(STIFFNESS * INERTIA)
    one = tn.Drivetrain(
        "one mass",
        [
            tn.Inertia("mass", node="a", inertia=INERTIA),
            tn.Spring("shaft", nodes=("a", "ground"), stiffness=STIFFNESS, damping=damping),
        ],
    )
    at = own * math.sqrt(1 - 2 * zeta**2) / (2 * np.pi)
    found = one.frequency_response("a", "a", [at]).magnitude.item() * STIFFNESS
    exact = 1 / (2 * zeta * math.sqrt(1 - zeta**2))
    yield Line("peak of one mass, $\\zeta = 0.1$", "", exact, found, 1e-12, "closed form")
