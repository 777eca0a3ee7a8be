"""Entries of all matrices behind the state space of a drivetrain's FMU, as numbers on a tape.

    M h'' + C (h', b') + K (h, b, d) = L u
    y = R_0 c + R_1 c' + R_2 c'' + F u,     c = (h, b, d)

with heavy coordinates h, damped b and static d. What runs inside an FMU makes A, B, C and D of these.

States and inputs that each output and state derivative of an FMU depends on, from the pattern of its matrices. Hosts
look here for direct ways from inputs to outputs. The pattern holds for any values of the parameters; it may name one
more than needed where numbers would cancel.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.program import ProgramNode
from torsionnet.base.units import DIMENSIONS, Dimension
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.export_losses import refuse_laws_of_motion
from torsionnet.io.fmu.traced_numbers import Motion, NumberTape, trace_motion
from torsionnet.io.modelica_parts import export_unit
from torsionnet.linear.dynamic_stiffness.state_space import active_channels, state_space
from torsionnet.model.channels import UNITS, Sensor
from torsionnet.model.elements import Law
from torsionnet.model.parameters import dimensions
from torsionnet.model.readings import balance, reading

MOST_COORDINATES = 400
"""Most coordinates of a drivetrain in an FMU, up to which dense matrices are no burden on a host."""


@dataclass(eq=False)
class Entries:
    """Sparse matrix of traced numbers, with the entries that are not zero for all values of the parameters."""

    tape: NumberTape
    of: dict[tuple[int, int], ProgramNode] = field(default_factory=dict)

    def add(self, row: int, column: int, value: ProgramNode) -> None:
        place = row, column
        self.of[place] = self.of[place] + value if place in self.of else value

    def __iter__(self) -> Iterator[tuple[int, int, ProgramNode]]:
        return ((i, j, value) for (i, j), value in sorted(self.of.items()) if not self.tape.vanishes(value))


@dataclass(frozen=True)
class System:
    """Matrices in SI, inputs and outputs of a drivetrain as its FMU calculates with them.

    Attributes
    ----------
    motion : Motion
    coordinates : tuple of str
        Heavy, damped, static.
    inputs, outputs : tuple of str
    matrices : dict
        Letter -> entries: ``M``, ``C``, ``K`` over coordinates; loads ``L``; readings ``R0``, ``R1``, ``R2``; ``F``.
    """

    motion: Motion
    coordinates: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    matrices: dict[str, Entries]

    @property
    def states(self) -> tuple[str, ...]:
        """Names of an FMU's states, angles (rad) of heavy coordinates, their speeds (rad/s), angles of damped ones."""
        motion = self.motion
        return (
            *(f"angle({name})" for name in motion.heavy),
            *(f"speed({name})" for name in motion.heavy),
            *(f"angle({name})" for name in motion.damped),
        )


def trace_system(drivetrain: Drivetrain) -> System:
    """Matrices in SI of the state space of a drivetrain, traced over its parameters.

    Raises
    ------
    UsageError
        No inputs or sensors, frequency-dependent laws, an imposed angle, a reading with the rate of an input in it, or
        more coordinates than dense matrices are good for.
    """
    channels = active_channels(drivetrain)
    if not channels.inputs or not channels.sensors:
        raise UsageError("an FMU needs at least one input and one sensor in the model", kind="missing-entry")
    _refuse(drivetrain)
    motion = trace_motion(drivetrain)
    coordinates = (*motion.heavy, *motion.damped, *motion.static)
    place = {name: number for number, name in enumerate(coordinates)}
    matrices = {letter: Entries(motion.tape) for letter in ("M", "C", "K", "L", "R0", "R1", "R2", "F")}
    for _, law in motion.kinematics.laws:
        if law.acts:
            _add_law(matrices, law, motion.over_coordinates(law.row), place, motion)
    loads = [channel.row for channel in channels.inputs.values()]
    for number, load in enumerate(loads):
        for name, share in motion.over_coordinates(load).items():
            matrices["L"].add(place[name], number, share)
    for number, sensor in enumerate(channels.sensors.values()):
        _add_reading(matrices, number, sensor, drivetrain, motion, place, loads)
    return System(motion, coordinates, tuple(channels.inputs), tuple(channels.sensors), matrices)


def _refuse(drivetrain: Drivetrain) -> None:
    """Refuse a drivetrain that an FMU cannot hold, with imposed angles, too many coordinates, or no state space."""
    refuse_laws_of_motion(drivetrain, "an FMU")
    channels, assembly = active_channels(drivetrain), drivetrain.assembly
    imposed = [name for name, channel in channels.inputs.items() if channel.quantity != "torque"]
    if imposed:
        raise UsageError(
            f"{', '.join(imposed)}: an FMU is driven by torques, not by imposed angles; leave out such inputs",
            kind="no-counterpart",
        )
    n = assembly.system.n_coordinates
    if n > MOST_COORDINATES:
        raise UsageError(
            f"the drivetrain has {n} coordinates; an FMU with its dense matrices takes up to {MOST_COORDINATES}",
            kind="too-large",
        )
    state_space(drivetrain)


def _add_law(
    matrices: Mapping[str, Entries], law: Law, row: Mapping[str, ProgramNode], place: Mapping[str, int], motion: Motion
) -> None:
    for letter, coefficient in (("M", law.inertia), ("C", law.damping), ("K", law.stiffness)):
        weight = motion.tape.node(coefficient)
        if motion.tape.vanishes(weight):
            continue
        # M = sum J a a^T over the rows a of the laws, and so C and K.
        for first, a in row.items():
            for second, b in row.items():
                matrices[letter].add(place[first], place[second], weight * (a * b))


def _add_reading(
    matrices: Mapping[str, Entries], number: int, sensor: Sensor, drivetrain: Drivetrain, motion: Motion,
    place: Mapping[str, int], loads: Sequence[Mapping[str, int]],
) -> None:  # fmt: skip
    """Add the coefficients of a sensor's reading over the FMU's coordinates and over the applied torques."""
    tape, laws = motion.tape, motion.kinematics.laws
    rows = [(owner, law.row) for owner, law in laws]
    read = reading(sensor, drivetrain.elements, motion.values, rows, motion.kinematics.constraints)
    balanced = balance(read, motion.kinematics, [row for _, row in rows], tape.node)
    parts = [] if read.row is None else [(read.row, [tape.node(read.power == power) for power in range(3)])]
    # A law gives (k + c s + J s^2) times its row.
    for index, factor in balanced.laws:
        _, law = laws[index]
        if law.acts and not tape.vanishes(factor):
            sizes = (law.stiffness, law.damping, law.inertia)
            parts.append((law.row, [tape.node(size) * factor for size in sizes]))
    for row, factors in parts:
        over_coordinates = motion.over_coordinates(row)
        for power, weight in enumerate(factors):
            if not tape.vanishes(weight):
                for name, angle in over_coordinates.items():
                    matrices[f"R{power}"].add(number, place[name], weight * angle)
    for column, load in enumerate(loads):
        for node, share in load.items():
            matrices["F"].add(number, column, tape.node(share) * tape.node(balanced.applied.get(node, 0)))


# Variables of an FMU in the order of their value references.

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
    derived: dict[str, ProgramNode]
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
    settled = {name: values[name] for name, number in traced.items() if system.motion.tape.constant(number) is not None}
    open_ = {name: values[name] for name in traced if name not in settled and not written[name].value.names}
    derived = {name: number for name, number in traced.items() if name not in {**settled, **open_}}
    named = _Namer()
    listed = (
        replace(variable, name=named(variable.name, variable.role), reference=reference)
        for reference, variable in enumerate(_unnumbered(drivetrain, system, open_, derived, settled))
    )
    return Variables(tuple(listed), open_, derived, settled)


def _unnumbered(
    drivetrain: Drivetrain, system: System, open_: dict[str, float], derived: dict[str, ProgramNode],
    settled: dict[str, float],
) -> Iterator[Variable]:  # fmt: skip
    channels, dimension_of = active_channels(drivetrain), dimensions(drivetrain.parameter_definitions)[0]
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
            yield _parameter(drivetrain, name, role, dimension_of.get(name))
    text = "in co-simulation: inputs run on from step to step in straight lines; if false, they are held"
    yield Variable("extrapolate_inputs", "flag", description=text)
    for name in settled:
        yield _parameter(drivetrain, name, "settled", dimension_of.get(name))


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


# States and inputs that each output and state derivative of an FMU depends on, from the pattern of its matrices.

Pattern: TypeAlias = NDArray[np.bool_]


def dependencies(system: System) -> dict[int, tuple[int, ...]]:
    """References of the states and inputs that an output or state derivative depends on, by the reference of it."""
    rates, outputs = _patterns(system)
    n_u, n_y, n_x = len(system.inputs), len(outputs), len(rates)
    first = 1 + n_u + n_y
    columns = np.array([*range(first, first + n_x), *range(1, 1 + n_u)])
    rows = {1 + n_u + row: taken for row, taken in enumerate(outputs)}
    rows |= {first + n_x + row: taken for row, taken in enumerate(rates)}
    return {reference: tuple(sorted(columns[taken].tolist())) for reference, taken in rows.items()}


def _patterns(system: System) -> tuple[Pattern, Pattern]:
    """Patterns (n_x, n_x + n_u) of (A, B) and (n_y, n_x + n_u) of (C, D), true where an entry is not always 0."""
    motion, n_u = system.motion, len(system.inputs)
    n_h, n_b, n = len(motion.heavy), len(motion.damped), len(system.coordinates)
    n_x = 2 * n_h + n_b
    M, C, K = (_pattern(system, letter, n, n) for letter in "MCK")
    loads = np.hstack([np.zeros((n, n_x), dtype=bool), _pattern(system, "L", n, n_u)])
    place, rate = np.zeros((n, n_x + n_u), dtype=bool), np.zeros((n, n_x + n_u), dtype=bool)
    place[:n_h, :n_h] = rate[:n_h, n_h : 2 * n_h] = np.eye(n_h, dtype=bool)
    place[n_h : n_h + n_b, 2 * n_h : n_x] = np.eye(n_b, dtype=bool)
    heavy, damped, static = slice(0, n_h), slice(n_h, n_h + n_b), slice(n_h + n_b, n)
    # Statics first, K d from loads and the other angles; with d the rates of b by C, and last those of h' by M.
    place[static] = _inverse_pattern(K[static, static], (loads | K @ place)[static])
    rate[damped] = _inverse_pattern(C[damped, damped], (loads | K @ place | C @ rate)[damped])
    faster = _inverse_pattern(M[heavy, heavy], (loads | K @ place | C @ rate)[heavy])
    states = np.vstack([rate[:n_h], faster, rate[damped]])
    outputs = np.hstack(
        [np.zeros((len(system.outputs), n_x), dtype=bool), _pattern(system, "F", len(system.outputs), n_u)]
    )
    # y is made of c, c' and c'': with the rates of the states each row gives the next one.
    row = place
    for power in range(3):
        outputs |= _pattern(system, f"R{power}", len(system.outputs), n) @ row
        row = row[:, :n_x] @ states
    return states, outputs


def _pattern(system: System, letter: str, rows: int, columns: int) -> Pattern:
    pattern = np.zeros((rows, columns), dtype=bool)
    for i, j, _ in system.matrices[letter]:
        pattern[i, j] = True
    return pattern


def _inverse_pattern(matrix: Pattern, right: Pattern) -> Pattern:
    """Pattern of the inverse of a symmetric matrix times ``right``, the inverse being full within connected parts."""
    from scipy.sparse.csgraph import connected_components

    if not len(matrix):
        return right
    _, label = connected_components(matrix, directed=False)
    together: Pattern = label[:, None] == label[None, :]
    return together @ right
