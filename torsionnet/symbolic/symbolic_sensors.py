"""Symbolic drivetrains, and the readings of sensors as rows on their networks.

The torque through a rigid connection is read where that connection is taken away: with a law kappa on its row a, the
torque is kappa a^T theta, and

    kappa a^T adj(D + kappa a a^T) b = kappa a^T adj(D) b

while det(D + kappa a a^T) tends to kappa times the determinant of the rigid drivetrain. So its numerator is the twist
of the connection in the drivetrain without it: no subtraction, and nothing upstream of it appears but as a factor.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.assembly.symbolic import law_parts
from torsionnet.assembly.twin import TWINS, twin, twin_parameters
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import Values
from torsionnet.model.elimination import substitute
from torsionnet.model.kinematics import Kinematics, kinematics_on
from torsionnet.model.readings import reading
from torsionnet.symbolic.algebra.adjugate import bilinear, determinant
from torsionnet.symbolic.algebra.network import ONE, Network, NetworkMember, Stiffness, SymbolRow
from torsionnet.symbolic.algebra.program import Program, ProgramNode

PURE_S = Stiffness(damping=ONE)


@dataclass(frozen=True)
class SymbolicPart:
    """Term of a sensor reading, factor * s^power * law * (row theta), or factor * torque of a constraint or action."""

    row: Mapping[str, Any]
    factor: Any = ONE
    power: int = 0
    law: Stiffness | None = None
    rigid: int | None = None
    action: int | None = None


@dataclass(frozen=True)
class ReducedNetwork:
    """Network with rigid rows kept at zero, rows over its coordinates, and the factor that its determinant lacks."""

    network: Network[Stiffness]
    rows: tuple[SymbolRow, ...]
    factor: Any


@dataclass(eq=False)
class Mechanism:
    """Symbolic drivetrain in which the torques of the rigid connections in ``loose`` can be read.

    Attributes
    ----------
    drivetrain : Drivetrain
    referred_to : tuple of str
        Nodes kept as coordinates.
    loose : tuple of int
        Constraints whose torque is wanted, by number.
    """

    has_actions: ClassVar[bool] = False
    """Whether torques of controllers are unknowns beside the coordinates, so that no continued fraction exists."""
    drivetrain: AssembledModel
    referred_to: tuple[str, ...] = ()
    loose: tuple[int, ...] = ()
    program: Program = field(default_factory=Program)

    @cached_property
    def values(self) -> Values:
        """Values of all parameters of the drivetrain as twins (an exact value with its symbol)."""
        drivetrain = self.drivetrain
        return Values(twin_parameters(drivetrain.definition.parameters, drivetrain.exact_values), TWINS)

    @cached_property
    def kinematics(self) -> Kinematics:
        """Kinematics of the drivetrain with all constraints solved except the rigid connections in ``loose``."""
        plain = self.drivetrain.assembly.kinematics
        return kinematics_on(self.values, plain, self.drivetrain.definition, self.referred_to, self.loose)

    def row(self, row: Mapping[str, Any]) -> SymbolRow:
        """Symbolic coefficients of a row over coordinates, from its coefficients over nodes."""
        reduced = substitute({node: twin(value) for node, value in row.items()}, self.kinematics.reduction.solved)
        return {name: value.symbol for name, value in reduced.items()}

    @cached_property
    def network(self) -> Network[Stiffness]:
        """Network of the drivetrain's laws over the coordinates, in which loose connections carry nothing."""
        laws = [(law_parts(owner, law), self.row(law.row)) for owner, law in self.kinematics.laws if law.acts]
        members = tuple(NetworkMember(row, Stiffness(*parts)) for parts, row in laws if row)
        return Network(self.kinematics.coordinates, members)

    def reduced(self, rows: Collection[SymbolRow], loose: int | None = None) -> ReducedNetwork:
        """Network with the mechanism's loose connections made rigid, except number ``loose``, and given rows in it."""
        rigid = {index: self.row(self.kinematics.constraints[index][1]) for index in self.loose}
        network, factor = self.network, ONE
        carried = [*rows, *([rigid[loose]] if loose is not None else [])]
        waiting = [row for index, row in rigid.items() if index != loose]
        while waiting:
            contraction = network.contracted(waiting.pop(0))
            network, factor = contraction.network, factor * contraction.factor
            waiting = [contraction.row(row) for row in waiting]
            carried = [contraction.row(row) for row in carried]
        return ReducedNetwork(network, tuple(carried), factor)

    def determinant(self, load: SymbolRow) -> ProgramNode:
        """Determinant det D of the drivetrain's dynamic stiffness, as a node of the program."""
        found = self.reduced([load])
        first = next(iter(found.rows[0]), "")
        return self.program.leaf(found.factor) * determinant(found.network, self.program, first)

    def numerator(self, parts: Collection[SymbolicPart], load: Mapping[str, int]) -> ProgramNode:
        """Numerator of a reading under torques on nodes, det D times the reading, a node of the program."""
        total = self.program.leaf(0)
        for part in parts:
            found = self.reduced([self.row(part.row), self.row(load)], part.rigid)
            row, loaded = found.rows[-1 if part.rigid is not None else 0], found.rows[1]
            number = self.program.leaf(part.factor * found.factor)
            for law in [PURE_S] * part.power + ([part.law] if part.law else []):
                number = number * self.program.leaf(law)
            total = total + bilinear(found.network, self.program, row, loaded) * number
        return total


def parts_of(mechanism: Mechanism, sensor: Sensor) -> list[SymbolicPart]:
    """Terms of the reading of a sensor in symbols, the sum of which is the reading."""
    kinematics = mechanism.kinematics
    rows = ((owner, law.row) for owner, law in kinematics.laws)
    driving = [(owner, action.row) for owner, action in kinematics.actions]
    elements = mechanism.drivetrain.elements
    read = reading(sensor, elements, mechanism.values, rows, kinematics.constraints, driving)
    if read.row is not None:
        return [SymbolicPart(read.row, power=read.power)]
    shares = [(*kinematics.laws[number], twin(factor).symbol) for number, factor in read.laws.items()]
    laws = [SymbolicPart(law.row, by, law=Stiffness(*law_parts(owner, law))) for owner, law, by in shares if law.acts]
    rigid = [SymbolicPart({}, twin(by).symbol, rigid=number) for number, by in read.constraints.items()]
    return laws + rigid + [SymbolicPart({}, twin(by).symbol, action=number) for number, by in read.actions.items()]


def loose_constraints(drivetrain: AssembledModel, sensors: Collection[Sensor]) -> tuple[int, ...]:
    """Numbers of the constraints (rigid connections) whose torque one of the sensors reads."""
    owners = {sensor.of for sensor in sensors if sensor.quantity == "torque"}
    return tuple(
        index for index, (owner, _) in enumerate(drivetrain.assembly.kinematics.constraints) if owner in owners
    )
