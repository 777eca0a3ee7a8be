"""Variables of an FMU in the order of their value references."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from torsionnet.base.units import DIMENSIONS, Dimension
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.fmu.traced_matrices import System
from torsionnet.io.fmu.traced_numbers import Traced
from torsionnet.io.modelica_syntax import export_unit
from torsionnet.linear.dynamic_stiffness.state_space import active_channels
from torsionnet.model.channels import UNITS
from torsionnet.model.parameters import dimensions

FMI_UNITS = {
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "rad/s2": {"rad": 1, "s": -2},
    "N.m": {"kg": 1, "m": 2, "s": -2},
    "N.m/rad": {"kg": 1, "m": 2, "s": -2, "rad": -1},
    "N.m.s/rad": {"kg": 1, "m": 2, "s": -1, "rad": -1},
    "kg.m2": {"kg": 1, "m": 2},
    "kg": {"kg": 1},
    "kg/m3": {"kg": 1, "m": -3},
    "m": {"m": 1},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "s": {"s": 1},
}
"""Units of FMI by name, with their powers of base units (kg, m, s, rad)."""
DIMENSION_UNITS = {
    "inertia": "kg.m2",
    "stiffness": "N.m/rad",
    "damping": "N.m.s/rad",
    "length": "m",
    "mass": "kg",
    "density": "kg/m3",
    "shear modulus": "Pa",
}
"""Unit that FMI gives to a parameter, by its dimension."""
SETTLED = "cannot be changed here: the structure of the model rests on its value"
"""Description of parameters that an FMU holds constant."""


@dataclass(frozen=True)
class Variable:
    """Variable of an FMU with name, unit, start value in SI, and ``role`` (time, input, output, state, flag, ...)."""

    name: str
    role: str
    unit: str = ""
    description: str = ""
    start: float | None = None
    of: int | None = None
    """Reference of the state that a rate of the FMU belongs to."""
    reference: int = 0


@dataclass(frozen=True)
class Variables:
    """All variables of an FMU, values in SI of its open and settled parameters, and the derived ones on the tape."""

    all: tuple[Variable, ...]
    open: dict[str, float]
    derived: dict[str, Traced]
    settled: dict[str, float]

    def of(self, *roles: str) -> tuple[Variable, ...]:
        return tuple(variable for variable in self.all if variable.role in roles)

    @property
    def units(self) -> tuple[str, ...]:
        """Units of all variables of the FMU, each once."""
        return tuple(dict.fromkeys(variable.unit for variable in self.all if variable.unit))


def list_variables(drivetrain: Drivetrain, system: System) -> Variables:
    """Variables of a drivetrain's FMU in the order in which its C code numbers them."""
    traced, values = system.motion.parameters, drivetrain.parameters
    written = drivetrain.parameter_definitions
    open_ = {
        name: values[name]
        for name, number in traced.items()
        if not number.is_constant and not written[name].value.names
    }
    derived = {name: number for name, number in traced.items() if not number.is_constant and name not in open_}
    settled = {name: values[name] for name, number in traced.items() if number.is_constant}
    named = _Namer()
    listed = (
        replace(variable, name=named(variable.name, variable.role), reference=reference)
        for reference, variable in enumerate(_unnumbered(drivetrain, system, open_, derived, settled))
    )
    return Variables(tuple(listed), open_, derived, settled)


def _unnumbered(
    drivetrain: Drivetrain, system: System, open_: dict[str, float], derived: dict[str, Traced],
    settled: dict[str, float],
) -> Iterator[Variable]:  # fmt: skip
    channels, found = active_channels(drivetrain), dimensions(drivetrain.parameter_definitions)[0]
    yield Variable("time", "time", "s")
    for name, source in channels.inputs.items():
        yield Variable(name, "input", "N.m", str(source), start=0.0)
    for name, sensor in channels.sensors.items():
        yield Variable(name, "output", export_unit(UNITS[sensor.quantity]), str(sensor))
    first = 1 + len(channels.inputs) + len(channels.sensors)
    for state in system.states:
        node = state[state.index("(") + 1 : -1]
        text = "relative to the motion of the nodes it follows" if node in system.motion.relative else ""
        yield Variable(state, "state", _unit(state), text, start=0.0)
    for reference, state in enumerate(system.states, first):
        unit = f"{_unit(state)}/s".replace("/s/s", "/s2")
        yield Variable(f"der({state})", "rate", unit, of=reference)
    for role, table in (("parameter", open_), ("derived", derived)):
        for name in table:
            yield _parameter(drivetrain, name, role, found.get(name))
    text = "in co-simulation: inputs run on from step to step in straight lines; if false, they are held"
    yield Variable("extrapolate_inputs", "flag", description=text)
    for name in settled:
        yield _parameter(drivetrain, name, "settled", found.get(name))


def _unit(state: str) -> str:
    return "rad/s" if state.startswith("speed") else "rad"


def _parameter(drivetrain: Drivetrain, name: str, role: str, dimension: Dimension | None) -> Variable:
    unit = next((unit for known, unit in DIMENSION_UNITS.items() if dimension == DIMENSIONS[known]), "")
    definition = drivetrain.parameter_definitions[name]
    notes = {"derived": str(definition.value), "settled": SETTLED}
    text = "; ".join(part for part in (definition.description, notes.get(role, "")) if part)
    return Variable(name, role, unit, text, None if role == "derived" else drivetrain.parameters[name])


class _Namer:
    """Giver of unique names to an FMU's variables, as tables of a model may share names."""

    def __init__(self) -> None:
        self.taken: set[str] = set()

    def __call__(self, wish: str, role: str) -> str:
        name = wish if wish not in self.taken else f"{role}({wish})"
        self.taken.add(name)
        return name
