"""Entries of all matrices behind the state space of a drivetrain's FMU, as numbers on a tape.

    M h'' + C (h', b') + K (h, b, d) = L u
    y = R_0 c + R_1 c' + R_2 c'' + F u,     c = (h, b, d)

with heavy coordinates h, damped b and static d. What runs inside an FMU makes A, B, C and D of these.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from torsionnet.base.errors import UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.fmu.fmu_coordinates import Motion, trace_motion
from torsionnet.io.fmu.traced_numbers import Traced
from torsionnet.io.unlinear_laws import refuse_laws_of_motion
from torsionnet.linear.dynamic_stiffness.state_space import active_channels, state_space
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import Law
from torsionnet.model.readings import balance, reading

MOST_COORDINATES = 400
"""Most coordinates of a drivetrain in an FMU, up to which dense matrices are no burden on a host."""


@dataclass(eq=False)
class Entries:
    """Sparse matrix of traced numbers, with the entries that are not zero for all values of the parameters."""

    of: dict[tuple[int, int], Traced] = field(default_factory=dict)

    def add(self, row: int, column: int, value: Traced) -> None:
        place = row, column
        self.of[place] = self.of[place] + value if place in self.of else value

    def __iter__(self) -> Iterator[tuple[int, int, Traced]]:
        return ((i, j, value) for (i, j), value in sorted(self.of.items()) if not value.vanishes)


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
        raise UsageError("an FMU needs at least one input and one sensor in the model")
    _refuse(drivetrain)
    motion = trace_motion(drivetrain)
    coordinates = (*motion.heavy, *motion.damped, *motion.static)
    place = {name: number for number, name in enumerate(coordinates)}
    matrices = {letter: Entries() for letter in ("M", "C", "K", "L", "R0", "R1", "R2", "F")}
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
            f"{', '.join(imposed)}: an FMU is driven by torques, not by imposed angles; leave out such inputs"
        )
    n = assembly.system.n_coordinates
    if n > MOST_COORDINATES:
        raise UsageError(
            f"the drivetrain has {n} coordinates; an FMU with its dense matrices takes up to {MOST_COORDINATES}"
        )
    state_space(drivetrain)


def _add_law(
    matrices: Mapping[str, Entries], law: Law, row: Mapping[str, Traced], place: Mapping[str, int], motion: Motion
) -> None:
    for letter, coefficient in (("M", law.inertia), ("C", law.damping), ("K", law.stiffness)):
        weight = motion.tape.number(coefficient)
        if weight.vanishes:
            continue
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
    balanced = balance(read, motion.kinematics, [row for _, row in rows], tape.number)
    parts = [] if read.row is None else [(read.row, [tape.number(read.power == power) for power in range(3)])]
    for index, factor in balanced.laws:
        _, law = laws[index]
        if law.acts and not factor.vanishes:
            sizes = (law.stiffness, law.damping, law.inertia)
            parts.append((law.row, [tape.number(size) * factor for size in sizes]))
    for row, factors in parts:
        over_coordinates = motion.over_coordinates(row)
        for power, weight in enumerate(factors):
            if not weight.vanishes:
                for name, angle in over_coordinates.items():
                    matrices[f"R{power}"].add(number, place[name], weight * angle)
    for column, load in enumerate(loads):
        for node, share in load.items():
            matrices["F"].add(number, column, tape.number(share) * tape.number(balanced.applied.get(node, 0)))
