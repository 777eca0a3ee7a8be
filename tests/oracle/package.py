"""A drivetrain of the package from a description."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import torsionnet as tn
from oracle.description import Measure, Model, Part

CLASSES = {
    "inertia": tn.Inertia,
    "spring": tn.Spring,
    "damper": tn.Damper,
    "hysteretic_spring": tn.HystereticSpring,
    "tabulated_spring": tn.TabulatedSpring,
    "gear": tn.Gear,
    "planetary": tn.Planetary,
    "differential": tn.Differential,
    "rigid_coupling": tn.RigidCoupling,
    "lock": tn.Lock,
    "shaft": tn.Shaft,
}
NUMBERS = (
    "inertia", "stiffness", "damping", "loss_factor", "ratio", "planet_inertia", "planet_mass", "orbit_radius",
    "outer_diameter", "inner_diameter", "length", "shear_modulus", "density",
)  # fmt: skip


def written(value: Fraction) -> float | str:
    """A float where its shortest decimal is exact, else a quotient."""
    number = float(value)
    return number if Fraction(repr(number)) == value else f"{value.numerator}/{value.denominator}"


def element(part: Part, names: Mapping[Fraction, str] | None = None) -> tn.Element:
    """The element; numbers that have a name are written by it."""

    def entry(name: str, value: Any) -> Any:
        if isinstance(value, Measure):
            at = {} if value.at is None else {"at": written(value.at)}
            return {value.name: written(value.value), **at}
        if name == "table":
            return [[written(cell) for cell in row] for row in value]
        if not isinstance(value, Fraction) or name not in NUMBERS:
            return value
        return names[value] if names and value in names else written(value)

    return CLASSES[part.kind](part.name, **{name: entry(name, value) for name, value in part.values.items()})


def inputs(model: Model) -> dict[str, dict[str, str]]:
    return {name: {quantity: node} for name, (quantity, node) in model.inputs.items()}


def drivetrain(model: Model) -> tn.Drivetrain:
    return tn.Drivetrain("drawn", [element(part) for part in model.parts], inputs=inputs(model))


def values_of(model: Model) -> list[Fraction]:
    """Every number an element is given, once."""
    found = (v for part in model.parts for name, v in part.values.items() if name in NUMBERS)
    return list(dict.fromkeys(value for value in found if isinstance(value, Fraction) and value))


def named(model: Model) -> tn.Drivetrain:
    """The same with a parameter for every number; equal numbers share it."""
    names = {value: f"p_{i}" for i, value in enumerate(values_of(model))}
    elements = [element(part, names) for part in model.parts]
    parameters = {name: written(value) for value, name in names.items()}
    return tn.Drivetrain("drawn", elements, parameters, inputs=inputs(model))


def configured(model: Model, factors: Sequence[float]) -> tn.Drivetrain:
    """The same as a changed copy of a drivetrain with other inertias, dampings and stiffnesses."""
    changing = {
        value
        for part in model.parts
        for field in ("inertia", "damping", "stiffness")
        if isinstance(value := part.values.get(field), Fraction) and value
    }
    fixed = {
        v
        for part in model.parts
        for field, v in part.values.items()
        if field not in ("inertia", "damping", "stiffness")
    }
    names = {value: f"p_{i}" for i, value in enumerate(sorted(changing - fixed))}
    elements = [element(part, names) for part in model.parts]
    right = {name: written(value) for value, name in names.items()}
    wrong = {name: float(value) * factors[i % len(factors)] for i, (value, name) in enumerate(names.items())}
    return tn.Drivetrain("drawn", elements, wrong, inputs=inputs(model)).configured(**right)


def source(model: Model) -> str:
    """Python text that makes the drivetrain."""
    elements = ",\n    ".join(f"tn.{element(part)!r}" for part in model.parts)
    return f"tn.Drivetrain('drawn', [\n    {elements},\n], inputs={inputs(model)})"
