"""Lines of the verification manual: a reference beside what the package calculates, from the data of the tests."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torsionnet as tn

TESTS = Path(__file__).parents[1] / "tests"
if str(TESTS) not in sys.path:
    sys.path.insert(0, str(TESTS))

from validation.build import build  # noqa: E402

PER_HZ = {
    "natural_frequencies_hz": ("Hz", 1.0),
    "natural_frequencies_cpm": ("1/min", 60.0),
    "natural_frequencies_rad_s": ("rad/s", 2 * math.pi),
}
"""Keys of published natural frequencies, with the unit of the source and the factor from Hz."""
MOST_LINES = 8
"""Lines of one quantity that an entry shows one by one; of the others the largest deviation stands in one line."""

SMALL = 1e-3
"""Size below which numbers are shown with six digits, so that receptances fit into a column."""


@dataclass(frozen=True)
class Line:
    """One value of a reference beside the calculated one, with the deviation that the test allows.

    Attributes
    ----------
    allowed : float
        Largest deviation that the test accepts, relative, or in ``unit`` where ``absolute``.
    """

    quantity: str
    unit: str
    reference: complex
    found: complex
    allowed: float
    source: str
    absolute: bool = False

    @property
    def deviation(self) -> float:
        """Deviation of the calculated value: in the unit where the reference is printed, else relative to it."""
        off = abs(self.found - self.reference)
        return off if self.absolute else off / abs(self.reference)

    @property
    def holds(self) -> bool:
        return self.deviation <= self.allowed

    @property
    def cells(self) -> list[str]:
        """Cells of a table: quantity, source, reference, calculated, deviation, allowed."""
        quantity = f"{self.quantity} [{self.unit}]" if self.unit else self.quantity
        unit = f" {self.unit}".rstrip() if self.absolute else ""
        off, allowed = f"{self.deviation:.1e}{unit}", f"{self.allowed:g}{unit}"
        return [quantity, self.source, number(self.reference), number(self.found), off, allowed]


def number(value: complex) -> str:
    """Text of a real number with ten digits, of a small or complex one with six or five."""
    if isinstance(value, complex) and value.imag:
        return f"{value.real:.5g} {'+' if value.imag >= 0 else '-'} {abs(value.imag):.5g}j"
    real = complex(value).real
    return f"{real:.10g}" if real == 0 or abs(real) >= SMALL else f"{real:.6g}"


def lines_of(case: dict[str, Any]) -> list[Line]:
    """All lines of a case with modes: published values first, then those of the reference solution."""
    drivetrain = build(case)
    modes = drivetrain.modes()
    return [*published(case, modes), *solved(case, modes), *receptances(case, drivetrain), *continuum(case)]


def published(case: dict[str, Any], modes: tn.Modes) -> Iterator[Line]:
    """Lines of values that the source prints; the test allows half a unit of the last digit, or what the case says."""
    given = case.get("published") or {}
    for key, (unit, scale) in PER_HZ.items():
        for index, value in enumerate(given.get(key, ())):
            if value not in (None, 0):
                found = modes.undamped_natural_frequencies[index] * scale
                name = f"$f_{{{index + 1}}}$"
                yield Line(name, unit, float(value), float(found), given["tolerance"], "print", absolute=True)
    for index, value in enumerate(given.get("damping_ratios", ())):
        found = oscillatory(modes, modes.damping_ratios)[index]
        yield Line(f"$\\zeta_{{{index + 1}}}$", "", value, found, given["tolerance"], "print", absolute=True)


def solved(case: dict[str, Any], modes: tn.Modes) -> Iterator[Line]:
    """Lines of the reference solution in 40 digits or in closed form."""
    expected, relative = case["expected"], case["tolerance"]["computed_rel"]
    source = re.sub("mpmath 40-digit", "40 digits", expected.get("method", "closed form"))
    damped = "damping_ratios" in expected
    frequencies = modes.natural_frequencies.tolist()
    if damped:
        frequencies = oscillatory(modes, modes.natural_frequencies)
    wanted = {
        "$|\\lambda_{%d}|/2\\pi$" if damped else "$f_{%d}$": ("Hz", expected["natural_frequencies_hz"], frequencies)
    }
    if damped:
        wanted["$\\zeta_{%d}$"] = ("", expected["damping_ratios"], oscillatory(modes, modes.damping_ratios))
        real = [pole.real for pole, kind in zip(modes.eigenvalues, modes.kinds, strict=True) if kind == "real pole"]
        wanted["real pole %d"] = ("rad/s", expected["real_eigenvalues_rad_s"], real)
    for name, (unit, references, found) in wanted.items():
        for index, (reference, value) in enumerate(zip(references, found, strict=True)):
            if reference:
                yield Line(name % (index + 1), unit, reference, float(value), relative, source)


def receptances(case: dict[str, Any], drivetrain: tn.Drivetrain) -> Iterator[Line]:
    """Lines of the receptances that a case samples."""
    for sample in case["expected"].get("frf", ()):
        found = drivetrain.frequency_response(sample["output"], sample["input"], [sample["freq_hz"]]).values.item()
        name = f"{sample['output']}/{sample['input']} at {sample['freq_hz']:g} Hz"
        reference = complex(sample["re"], sample["im"])
        yield Line(name, "rad/(N m)", reference, found, case["tolerance"]["computed_rel"], "40 digits")


CONTINUUM_TOLERANCE = 1e-12
"""Relative deviation of the continuous shaft from the exact frequencies: they are bisected to the last digits."""


def continuum(case: dict[str, Any]) -> Iterator[Line]:
    """Lines of the continuous shaft in place of the five elements of the drill string."""
    exact = case.get("continuum_exact_frequencies_hz")
    if not exact:
        return
    from validation.build import STEEL_PIPE

    ends = [node for node in case["nodes"] if node["inertia"]]
    discs = [tn.Inertia(f"J_{node['name']}", node=node["name"], inertia=node["inertia"]) for node in ends]
    pipe = tn.ContinuousShaft("pipe", nodes=tuple(node["name"] for node in ends), length=800, **STEEL_PIPE)
    found = tn.Drivetrain("continuum", [*discs, pipe]).modes(lowest=len(exact) + 1).undamped_natural_frequencies[1:]
    for index, (reference, value) in enumerate(zip(exact, found, strict=False)):
        yield Line(f"continuum $f_{{{index + 2}}}$", "Hz", reference, float(value), CONTINUUM_TOLERANCE, "closed form")


def oscillatory(modes: tn.Modes, values: Any) -> list[float]:
    return [float(value) for value, kind in zip(values, modes.kinds, strict=True) if kind == "oscillatory"]
