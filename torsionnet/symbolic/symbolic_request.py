"""Request for a symbolic transfer function, names resolved to sensors, excitations and a cut at a torque meter.

Here as well: continued fraction of a transfer function on a tree, as a sympy expression or in another algebra; transfer
function of one output over one input in symbols, numerator and denominator as one program.

Symbolic transfer functions of drivetrains with imposed angles, by way of drivetrains without these.

What an imposed angle does to a reading is what any torque there does to it, over the angle that torque makes: y/phi is
a transfer function against a measured angle. Whatever hangs on the driven node alone drops out of the ratio. Imposed
angles that are not the excitation stand still.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import sympy

from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import phrase
from torsionnet.base.program import Program, ProgramNode
from torsionnet.base.registers import Memo
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.dynamic_stiffness.transfer_request import (
    TransferRequest,
    cut_definition,
    elements_beyond_cut,
    resolve_request,
)
from torsionnet.linear.frequency_response import Channel
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.elements import Element, Lock, RigidCoupling
from torsionnet.model.operating_values import symbol_notes
from torsionnet.model.readings import port_of
from torsionnet.symbolic.algebra.algebras import Expressions, Lengths, SympyForm, in_s, vanishes
from torsionnet.symbolic.algebra.network import Stiffness
from torsionnet.symbolic.mechanism import (
    Mechanism,
    NoContinuedFractionError,
    SymbolicPart,
    loose_constraints,
    parts_of,
    response,
)


@dataclass(frozen=True)
class SymbolicRequest:
    """Request for a transfer function in terms of one symbolic drivetrain, with its readings and load.

    Attributes
    ----------
    mechanism : Mechanism
        The drivetrain, or what is left of it downstream of a cut.
    output, measured : list of SymbolicPart
        What is read; ``measured`` is None where the input is a torque.
    load : mapping
        Torques on nodes per unit of the excitation.
    sign : int
        Of that torque, for a cut on whose far side a positive reading drives backwards.
    channels : tuple of Channel
        Output and input.
    notes : tuple of str
    change : callable
        What values do to expressions of parameters.
    """

    mechanism: Mechanism
    output: list[SymbolicPart]
    measured: list[SymbolicPart] | None
    load: Mapping[str, int]
    sign: int
    channels: tuple[Channel, Channel]
    notes: tuple[str, ...]
    change: Callable[[Any], Any] = lambda expression: expression

    def changed(self, change: Callable[[Any], Any]) -> SymbolicRequest:
        """Copy of the request with one more substitution applied to all expressions of parameters in it."""
        before = self.change
        return replace(self, change=lambda expression: change(before(expression)))


def resolve(
    drivetrain: AssembledModel,
    output: str | Sensor,
    input: str | Sensor | Input,
    excitation: str | Input | None,
    referred_to: Sequence[str] = (),
    memo: Memo | None = None,
) -> SymbolicRequest:
    """Request for a symbolic transfer function from the names of output, input and excitation.

    See :meth:`torsionnet.symbolic.symbolic_system.SymbolicSystem.transfer_function`.

    Raises
    ------
    UsageError
        As for a frequency response; also where the excitation does not reach the measured input.
    """
    request = resolve_request(drivetrain, output, input, excitation)
    sensors, load = request.sensors, request.excitations[0].row
    seen = _mechanism(drivetrain, sensors, referred_to, memo)
    # Sensors are that of the output, then those of the inputs, of which an excitation has none.
    reading, *inputs_read = (parts_of(seen, sensor) for sensor in sensors)
    channels = (request.outputs[0].channel, request.inputs[0].channel)
    notes = (*request.notes, *symbol_notes(drivetrain.definition))
    whole = SymbolicRequest(seen, reading, None, load, 1, channels, notes)
    if not request.is_measured:
        return whole
    (measured,) = inputs_read
    if vanishes(seen.numerator(measured, load)):
        felt = f"{request.names} does not feel the {request.excitations[0]}"
        raise UsageError(
            f"{felt}: the transfer function against it does not exist; choose another excitation",
            kind="wrong-count",
        )
    whole = replace(whole, measured=measured)
    kept = elements_beyond_cut(drivetrain, request)
    return whole if kept is None else _of_cut(drivetrain, kept, request, whole, referred_to)


def _mechanism(
    drivetrain: AssembledModel,
    sensors: Sequence[Sensor],
    referred_to: Sequence[str],
    memo: Memo | None = None,
) -> Mechanism:
    """Symbolic drivetrain in which the sensors can be read, from ``memo`` where it was made before."""
    loose = loose_constraints(drivetrain, sensors)
    kept = tuple(node for node in referred_to if node in drivetrain.nodes)
    return (memo or Memo()).once(Mechanism, loose, lambda: mechanism(drivetrain, kept, loose))


def _of_cut(
    drivetrain: AssembledModel,
    kept: Sequence[str],
    request: TransferRequest,
    whole: SymbolicRequest,
    referred_to: Sequence[str],
) -> SymbolicRequest:
    """Request on the drivetrain downstream of a cut, where the measured torque is the excitation."""
    output, sensor = request.sensors
    if sensor.referred_to is not None:  # the torque at the cut is another one
        return whole
    node, sign = port_of(drivetrain.elements[sensor.of], sensor.at)
    rest = drivetrain.with_definition(cut_definition(drivetrain.definition, kept))
    nodes = set(rest.nodes)
    is_left = output.of in rest.elements if output.is_on_element else nodes.issuperset(output.nodes)
    if not is_left or (output.referred_to is not None and output.referred_to not in nodes):
        return whole
    rested = _mechanism(rest, [output], referred_to)
    removed = ", ".join(name for name in drivetrain.elements if name not in kept)
    said = phrase("cut at {sensor}: independent of {removed}", sensor=whole.channels[1].name, removed=removed)
    notes = (*whole.notes, said) if removed else whole.notes
    into = sign if sensor.of in kept else -sign
    return SymbolicRequest(rested, parts_of(rested, output), None, {node: 1}, into, whole.channels, notes)


def mechanism(
    drivetrain: AssembledModel,
    referred_to: tuple[str, ...] = (),
    loose: tuple[int, ...] = (),
    program: Program | None = None,
) -> Mechanism:
    """Symbolic drivetrain from which transfer functions are made, an :class:`ActiveMechanism` if it has actions."""
    kind = Mechanism
    if drivetrain.assembly.system.actions:
        from torsionnet.symbolic.active_mechanism import ActiveMechanism

        kind = ActiveMechanism
    return kind(drivetrain, referred_to, loose, program or Program())


def continued_fraction(asked: SymbolicRequest, leaf: Callable[[Any], Any]) -> Any:
    """Continued fraction of a transfer function in the algebra of ``leaf``, None if the drivetrain is no tree."""

    def element(payload: Any) -> Any:
        if isinstance(payload, str):  # s itself
            return leaf(Stiffness(damping=sympy.Integer(1)))
        if isinstance(payload, Stiffness):
            return leaf(Stiffness(*(asked.change(part) for part in payload.parts)))
        return leaf(asked.change(sympy.Integer(payload) if isinstance(payload, int) else payload))

    if asked.mechanism.has_actions:
        return None
    try:
        alone = asked.measured is None
        above, receptance = response(asked.mechanism, asked.output, asked.load, element, shift=alone)
        if asked.measured is None:
            return above * receptance * element(asked.sign)
        return above / response(asked.mechanism, asked.measured, asked.load, element)[0]
    except NoContinuedFractionError:
        return None


def continued_fraction_expression(asked: SymbolicRequest) -> Any:
    """Continued fraction of a transfer function as a sympy expression, or None if the drivetrain is no tree."""
    return continued_fraction(asked, _expression)


def _expression(payload: Any) -> Any:
    if isinstance(payload, Stiffness):
        return in_s(payload.parts)
    return sympy.Rational(payload.numerator, payload.denominator) if isinstance(payload, Fraction) else payload


@dataclass(frozen=True, eq=False)
class SymbolicFraction(SympyForm):
    """Numerator and denominator of a transfer function, exact, in the model's own symbols.

    Attributes
    ----------
    channels : tuple of Channel
        Output and input, with their units.
    outputs : (ProgramNode, ProgramNode)
        Numerator and denominator as results of one program, common factors left out.
    values : dict
        Symbol -> exact rational value in the model.
    request : SymbolicRequest or None
        The mechanism behind, for the continued fraction.
    tables : dict
        What depends on frequency by the symbolic function that stands for it, kappa(omega).
    notes : tuple of str
    model, configuration : str
        Names of the model and of its configuration.
    """

    channels: tuple[Channel, Channel]
    outputs: tuple[ProgramNode, ProgramNode]
    values: Mapping[Any, Any]
    request: SymbolicRequest | None = None
    tables: Mapping[Any, Any] = field(default_factory=dict)
    title: str = ""
    notes: tuple[str, ...] = ()
    conditions: tuple[Any, ...] = ()
    model: str = ""
    configuration: str = ""

    @property
    def steps(self) -> Program:
        """Straight-line program whose steps calculate numerator and denominator."""
        return self.outputs[0].program

    @cached_property
    def free_symbols(self) -> frozenset[Any]:
        """Parameters that appear in the transfer function, as sympy symbols."""
        symbols = {symbol for leaf in self._leaves for symbol in leaf.free_symbols} - {sympy.Symbol("omega")}
        coefficients = (coefficient for table in self.used_tables.values() for coefficient in table.coefficients)
        return frozenset(symbols.union(*(coefficient.free_symbols for coefficient in coefficients)))

    @cached_property
    def used_tables(self) -> Mapping[Any, Any]:
        """Frequency-dependent stiffnesses in the transfer function, by their symbol kappa(omega)."""
        functions = {function for leaf in self._leaves for function in leaf.atoms(sympy.core.function.AppliedUndef)}
        return {name: table for name, table in self.tables.items() if name in functions}

    @property
    def formulas(self) -> Mapping[Any, Any]:
        """Formula of each continuous shaft's kappa(omega) in omega and parameters, a sympy expression in N m/rad."""
        omega = sympy.Symbol("omega")
        formulas = {name: table.formula(omega) for name, table in self.used_tables.items()}
        return {name: formula for name, formula in formulas.items() if formula is not None}

    @cached_property
    def _leaves(self) -> tuple[Any, ...]:
        """Sympy expressions in the leaves of the transfer function's program."""
        needed = (self.steps.steps[index] for index in self.steps.needed(self.outputs))
        payloads = [step[1] for step in needed if step[0] == "leaf"]
        parts = [part for leaf in payloads for part in (leaf.parts if isinstance(leaf, Stiffness) else (leaf,))]
        return tuple(dict.fromkeys(part for part in parts if isinstance(part, sympy.Basic)))

    @cached_property
    def _parts(self) -> tuple[Any, Any]:
        above, below = self.steps.values_in(Expressions(), self.outputs)
        return above, below

    @property
    def numerator(self) -> Any:
        """Numerator of the transfer function as a sympy expression in s and the parameters, nested as calculated."""
        return self._parts[0]

    @property
    def denominator(self) -> Any:
        """Denominator of the transfer function as a sympy expression in s and the parameters, nested as calculated."""
        return self._parts[1]

    @property
    def nested(self) -> Any:
        """Transfer function as a nested sympy expression, numerator over denominator as calculated."""
        return self.numerator / self.denominator

    def _sympy_(self) -> Any:
        return self.nested

    @cached_property
    def nested_leaves(self) -> int:
        """Number of leaves (stiffnesses, ratios, numbers) of the nested form, repeated ones counted again."""
        above, below = self.steps.values_in(Lengths(), self.outputs)
        return int(above + below)

    @cached_property
    def continued_fraction(self) -> Any:
        """Transfer function as a continued fraction in sympy, or None where there are closed loops."""
        return None if self.request is None else continued_fraction_expression(self.request)

    @property
    def mechanical(self) -> Any:
        """Transfer function as a continued fraction in sympy, nested instead where there are closed loops."""
        return self.nested if self.continued_fraction is None else self.continued_fraction


@dataclass(frozen=True)
class ImposedRequest:
    """Request for a transfer function restated without imposed angles, with drivetrain, input and excitation.

    ``channel`` is the input as the user knows it, where that is an imposed angle.
    """

    drivetrain: AssembledModel
    input: str | Sensor | Input
    excitation: str | Input | None
    channel: Channel | None = None


def is_imposed(drivetrain: AssembledModel) -> bool:
    """Whether any input of the drivetrain imposes an angle."""
    return any(channel.quantity == "angle" for channel in drivetrain.inputs.values())


def hold_imposed_angles(drivetrain: AssembledModel, driven: Input | None = None) -> AssembledModel:
    """Drivetrain with its imposed angles held at zero, except that of ``driven``, where the node turns freely."""
    definition, nodes = drivetrain.definition, set(drivetrain.nodes)
    angles = [channel for channel in definition.inputs.values() if channel.quantity == "angle"]
    imposed = [channel for channel in angles if nodes.issuperset(channel.nodes)]
    held = [_holder(channel, definition.elements) for channel in imposed if channel != driven]
    elements = {**definition.elements, **{holder.name: holder for holder in held}}
    inputs = {name: channel for name, channel in definition.inputs.items() if channel.quantity != "angle"}
    return drivetrain.with_definition(replace(definition, elements=elements, inputs=inputs))


def _holder(channel: Input, known: Mapping[str, Element]) -> Element:
    """Element that holds an imposed angle at zero, a clamp, or between two nodes a rigid coupling."""
    name = _unused(f"rest_{'_'.join(channel.nodes)}", known)
    if channel.against is None:
        return Lock(name, node=channel.of)
    return RigidCoupling(name, nodes=(channel.of, channel.against))


def _unused(name: str, elements: Mapping[str, Element]) -> str:
    while name in elements:
        name += "_"
    return name


def without_imposed_angles(
    drivetrain: AssembledModel, output: str | Sensor, input: str | Sensor | Input, excitation: str | Input | None
) -> ImposedRequest:
    """Request for a transfer function restated without imposed angles, as a measured angle under a torque.

    Raises
    ------
    UsageError
        As for a frequency response.
    """
    if not is_imposed(drivetrain):
        return ImposedRequest(drivetrain, input, excitation)
    request = resolve_request(drivetrain, output, input, excitation)
    source: Input = request.excitations[0]
    if source.quantity == "torque":
        return ImposedRequest(hold_imposed_angles(drivetrain), input, source if request.is_measured else None)
    free, torque = hold_imposed_angles(drivetrain, source), replace(source, quantity="torque")
    if request.is_measured:
        return ImposedRequest(free, input, torque)
    measured = Sensor("angle", source.of, against=source.against)
    return ImposedRequest(free, measured, torque, request.inputs[0].channel)


def require_one_channel_each(output: object, input: object) -> None:
    """Raise an error if several outputs or inputs are given for a symbolic transfer function, which has one of each."""
    if not isinstance(output, str | Sensor) or not isinstance(input, str | Sensor | Input):
        raise UsageError(
            "a transfer function in symbols has one output and one input; transfer_matrix takes several",
            kind="wrong-count",
        )
