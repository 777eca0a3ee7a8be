"""Order response as a function of parameters of drivetrain and excitations, also at the toothed wheels of a test.

A measured order is compared with the sum of all order lines of that order, X = sum_l G(f_l) T_l with the receptances G
per unit torque and the torques T of the excitations. G depends on parameters of the drivetrain, with exact derivatives;
T on numbers of the excitations, with differences that are exact where T is linear in them, as it is in shares, factors
and amplitudes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.errors import UsageError, comma_list
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.sensitivity.parametric import Evaluation, ParametricResponse, parametric_response
from torsionnet.machinery.excitations.engine_entries import EACH
from torsionnet.machinery.excitations.excitation_numbers import ExcitationNumber, excitation_number, with_number
from torsionnet.machinery.excitations.order_excitation import OrderExcitation
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.machinery.orders.operating_groups import drivetrains_at_speeds
from torsionnet.machinery.orders.order_comparison import SAME_ORDER_DIFFERENCE
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.order_solution import OrderRequest, settled_values
from torsionnet.model.channels import Sensor
from torsionnet.model.model import Model
from torsionnet.signals.rotation.pitch_order import CalculatedOrders

# Order response of a drivetrain as a function of parameters of the drivetrain and of its excitations.

DIFFERENCE_STEP = 1e-4
"""Step of a central difference over the number, or over its usual size: the error of a phase is then 2e-9 of its
derivative, and rounding 1e-12 of the torque."""
T = TypeVar("T")
USUAL_SIZES = {"pressure": 1e5, "torque": 100.0, "speed": 10.0, "acceleration": 100.0}
"""Usual size of a number in SI by dimension, for the step where the number is 0; 1 of all others."""


def numbers_of_excitations(model: Model, names: Sequence[str]) -> dict[str, ExcitationNumber]:
    """Numbers of excitations (SI) among the names of unknowns, by name; all other names are parameters or fields.

    Raises
    ------
    UsageError
        An excitation has no such number.
    """
    definition, numbers = model.definition, {}
    for name in names:
        element, _, field = name.rpartition(".")
        of_element = element in definition.elements and field in definition.elements[element].scalars()
        if name not in definition.parameters and not of_element:
            number = excitation_number(definition.excitations, name)
            if number is not None:
                numbers[name] = number
    return numbers


def parameters_of_drivetrain(model: Model, names: Sequence[str]) -> tuple[str, ...]:
    """Names of the unknowns of a fit that are parameters or fields of the drivetrain, not numbers of excitations."""
    numbers = numbers_of_excitations(model, names)
    return tuple(name for name in names if name not in numbers)


class _Last(Generic[T]):
    """Last result of a calculation with its values, kept as many searches move either the drivetrain or its loads."""

    def __init__(self) -> None:
        self._known: tuple[tuple[float, ...], T] | None = None

    def once(self, values: tuple[float, ...], calculate: Callable[[], T]) -> T:
        """Result at these values, the last one where they are the same."""
        if self._known is None or self._known[0] != values:
            self._known = values, calculate()
        return self._known[1]


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Pairs of a measured line and an order line of the model that is part of it.

    Attributes
    ----------
    measured : (n,) int array
        Index of the measured line.
    speed, line : (n,) int arrays
        Indices of its speed and of the model's line.
    hertz : (n,) array
        Frequency in Hz, below 0 for a vibration that runs backwards in phase.
    """

    measured: NDArray[np.intp]
    speed: NDArray[np.intp]
    line: NDArray[np.intp]
    hertz: FloatArray


@dataclass(frozen=True, eq=False)
class ParametricOrders:
    """Complex order amplitudes at measured orders and speeds, as functions of unknowns, in SI units.

    Attributes
    ----------
    drivetrain : AssembledModel
        In one configuration, with excitations.
    names : tuple of str
        Unknowns: parameters, fields of elements, numbers of excitations.
    outputs : tuple of str or Sensor
    orders, speeds : (n_lines,) arrays
        Vibrations per revolution of the reference shaft, and its speed in rad/s.
    output_of : (n_lines,) int array
        Index of the output of each line.
    speed_of : str
        Node of the reference shaft, empty for that of the model.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("engine_generator_set").configured("normal")
    >>> orders = ParametricOrders.of(rig, "T_cpl", np.array([3.0]), np.array([90.0]), ["engine.misfire_share.4"])
    >>> evaluation = orders.evaluation(orders.start)
    >>> bool(abs(evaluation.values[0, 0, 0] - rig.order_response("T_cpl", speeds=[90.0]).values[0, 5, 0]) < 1e-6)
    True
    """

    drivetrain: AssembledModel
    names: tuple[str, ...]
    outputs: tuple[str | Sensor, ...]
    orders: FloatArray
    speeds: FloatArray
    output_of: NDArray[np.intp]
    speed_of: str = ""
    _last: _Last[Evaluation] = field(default_factory=_Last)
    _last_loads: _Last[tuple[ComplexArray, dict[str, ComplexArray]]] = field(default_factory=_Last)
    _last_gains: _Last[tuple[ComplexArray, ComplexArray]] = field(default_factory=_Last)

    @classmethod
    def of(
        cls,
        drivetrain: AssembledModel,
        output: str | Sensor,
        orders: FloatArray,
        speeds: FloatArray,
        names: Sequence[str],
        speed_of: str = "",
    ) -> ParametricOrders:
        """Orders of one output at pairs of order and speed, whose faults come out when they are first asked for."""
        return cls(drivetrain, tuple(names), (output,), orders, speeds, np.zeros(len(orders), dtype=np.intp), speed_of)

    @property
    def frequencies(self) -> FloatArray:
        """Frequency in Hz of each measured line, order times speed, shape (n_lines,)."""
        return np.asarray(self.orders * self.speeds / (2 * np.pi))

    @property
    def unit(self) -> str:
        """SI unit of the amplitudes of the first output."""
        return self.units[0]

    @cached_property
    def units(self) -> tuple[str, ...]:
        """SI unit of the amplitudes of each output."""
        return tuple(output.unit for output in self._responses[0][0].request.outputs)

    @cached_property
    def start(self) -> FloatArray:
        """Values (n,) of the unknowns in the model as given, in SI units."""
        of_model = dict(zip(self._structural, self._responses[0][0].start.tolist(), strict=True))
        return np.array([of_model[name] if name in of_model else self._numbers[name].value for name in self.names])

    @cached_property
    def _numbers(self) -> dict[str, ExcitationNumber]:
        return numbers_of_excitations(self.drivetrain, self.names)

    @cached_property
    def _structural(self) -> tuple[str, ...]:
        return tuple(name for name in self.names if name not in self._numbers)

    @cached_property
    def _request(self) -> OrderRequest:
        request = OrderRequest.of(self.drivetrain, np.unique(self.speeds), self.speed_of or None)
        idle = [number.excitation for number in self._numbers.values() if number.excitation not in request.excitations]
        if idle:
            raise UsageError(
                f"{comma_list(dict.fromkeys(idle))} is switched off in this configuration; leave it out",
                kind="switched-off",
            )
        return request

    @cached_property
    def _pairs(self) -> _Pairs:
        return _pairs_of(self._request, self.orders, np.searchsorted(self._request.speeds, self.speeds))

    @cached_property
    def _responses(self) -> tuple[tuple[ParametricResponse, NDArray[np.intp], NDArray[np.intp]], ...]:
        """Receptances, the pairs that they belong to, and the frequency of each of these."""
        return tuple(_responses(self._request, self.outputs, self._pairs, self._structural))

    def evaluation(self, values: Sequence[float] | FloatArray) -> Evaluation:
        """Amplitudes (n_lines, 1, 1) and derivatives (n_lines, 1, 1, n), in SI units, at values (n,) of the unknowns.

        Raises
        ------
        SolveError
            They are not finite there.
        """
        numbers = tuple(map(float, values))
        return self._last.once(numbers, lambda: self._evaluated(dict(zip(self.names, numbers, strict=True))))

    def _evaluated(self, given: Mapping[str, float]) -> Evaluation:
        gains, slopes = self._gains([given[name] for name in self._structural])
        loads, load_slopes = self._loads_and_slopes({name: given[name] for name in self._numbers})
        amplitudes = np.zeros(len(self.orders), dtype=complex)
        jacobian = np.zeros((len(self.orders), len(self.names)), dtype=complex)
        # Sum of G T over the inputs; several lines of the model may be one measured order.
        np.add.at(amplitudes, self._pairs.measured, (gains * loads).sum(axis=1))
        # G dT/dp for a number of an excitation, dG/dp T for a value of the shafts.
        for place, name in enumerate(self.names):
            if name in self._numbers:
                moved = gains * load_slopes[name]
            else:
                moved = slopes[:, :, self._structural.index(name)] * loads
            np.add.at(jacobian[:, place], self._pairs.measured, moved.sum(axis=1))
        return Evaluation(amplitudes[:, None, None], jacobian[:, None, None])

    def _gains(self, values: Sequence[float]) -> tuple[ComplexArray, ComplexArray]:
        """Receptances (n_pairs, n_inputs) and their derivatives (n_pairs, n_inputs, n_structural)."""
        return self._last_gains.once(tuple(values), lambda: self._solved(values))

    def _solved(self, values: Sequence[float]) -> tuple[ComplexArray, ComplexArray]:
        count = len(self._pairs.measured)
        first = self._responses[0][0]
        gains = np.zeros((count, len(first.loads)), dtype=complex)
        slopes = np.zeros((count, len(first.loads), len(values)), dtype=complex)
        for response, pairs, frequency in self._responses:
            evaluation = response.evaluation(values)
            output = self.output_of[self._pairs.measured[pairs]]
            gains[pairs], slopes[pairs] = evaluation.values[frequency, output], evaluation.jacobian[frequency, output]
        # At negative frequencies G is the conjugate.
        backward = self._pairs.hertz < 0
        gains[backward], slopes[backward] = gains[backward].conj(), slopes[backward].conj()
        return gains, slopes

    def _loads_and_slopes(self, numbers: Mapping[str, float]) -> tuple[ComplexArray, dict[str, ComplexArray]]:
        """Complex torques or motions (n_pairs, n_inputs) and their derivatives by each number of an excitation."""

        def loads_and_slopes() -> tuple[ComplexArray, dict[str, ComplexArray]]:
            return self._loads(numbers), {name: self._load_slopes(name, numbers) for name in numbers}

        return self._last_loads.once(tuple(numbers.values()), loads_and_slopes)

    def _loads(self, numbers: Mapping[str, float]) -> ComplexArray:
        """Complex torques or motions (n_pairs, n_inputs) with these numbers of the excitations."""
        changed = dict(self._request.excitations)
        for name, value in numbers.items():
            number = self._numbers[name]
            changed[number.excitation] = with_number(changed[number.excitation], number, value)
        phasors = replace(self._request, excitations=changed).loads(self._request.speeds)
        return np.asarray(phasors.loads[self._pairs.speed, self._pairs.line])

    def _load_slopes(self, name: str, numbers: Mapping[str, float]) -> ComplexArray:
        number = self._numbers[name]
        step = DIFFERENCE_STEP * (abs(numbers[name]) or USUAL_SIZES.get(number.dimension, 1.0))
        ends = [self._loads({**numbers, name: numbers[name] + sign * step}) for sign in (1, -1)]
        return np.asarray((ends[0] - ends[1]) / (2 * step))


def excited_orders(drivetrain: AssembledModel, speed_of: str = "") -> tuple[float, ...]:
    """Orders of the reference shaft that the excitations of a drivetrain have, rising, without fixed frequencies.

    Raises
    ------
    UsageError
        The drivetrain has no excitations, or the reference shaft is not known.
    """
    request = OrderRequest.of(drivetrain, None if drivetrain.definition.speeds else [1.0], speed_of or None)
    lines = request.loads(request.speeds[:1]).lines
    return tuple(sorted({float(line.relative) for line in lines if not line.fixed and line.relative}))


def same_order(first: float, second: float) -> bool:
    """Whether two orders are the same but for the few digits of a tracked order."""
    return bool(abs(first - second) <= SAME_ORDER_DIFFERENCE * max(abs(first), abs(second)))


def _pairs_of(request: OrderRequest, orders: FloatArray, speed: NDArray[np.intp]) -> _Pairs:
    """Pairs of measured and model lines with their frequencies."""
    loads = request.loads(request.speeds)
    several = [load.name for load in loads.by_excitation if load.torques.alternatives is not None]
    if several:
        text = f"{comma_list(several)} misfires in each cylinder in turn, which is no single condition"
        raise UsageError(f"{text}; choose a configuration without misfire: each", kind="unsupported-law")
    parts: list[tuple[int, int, int]] = []
    for order in np.unique(orders).tolist():
        lines = [
            number for number, line in enumerate(loads.lines)
            if not line.fixed and line.relative and same_order(float(line.relative), order)
        ]  # fmt: skip
        if not lines:
            known = comma_list(sorted({float(line.relative) for line in loads.lines if not line.fixed}), none="none")
            raise UsageError(f"the model does not excite order {order:g}; its orders are {known}", kind="unknown-order")
        parts += [(int(place), int(speed[place]), line) for place in np.flatnonzero(orders == order) for line in lines]
    measured, at, line = np.array(parts, dtype=np.intp).T
    return _Pairs(measured, at, line, np.asarray(loads.hertz[at, line]))


def _responses(
    request: OrderRequest, outputs: Sequence[str | Sensor], pairs: _Pairs, structural: tuple[str, ...]
) -> list[tuple[ParametricResponse, NDArray[np.intp], NDArray[np.intp]]]:
    rig, responses = request.drivetrain, []
    inputs: list[Any] = list(request.loads(request.speeds[:1]).inputs)
    twisted = [channel.of for channel in inputs if channel.quantity == "twist"]
    if twisted:
        text = f"an excitation imposes the twist of {comma_list(twisted)}, of which fits have no derivatives"
        raise UsageError(f"{text}; switch that excitation off for the fit", kind="unsupported-law")
    settled = settled_values(request) if rig.definition.following else {}
    for at_speed, places in drivetrains_at_speeds(rig, request.reference, request.speeds, settled, apart=True):
        mine = np.flatnonzero(np.isin(pairs.speed, places))
        if len(mine):
            frequencies, where = np.unique(np.abs(pairs.hertz[mine]), return_inverse=True)
            responses.append(
                (parametric_response(at_speed, outputs, inputs, frequencies, structural), mine, where.ravel())
            )
    return responses


# Orders that a model calculates at a toothed wheel, parted into what masses decide and what the test decides.

SPEED_STEP, MOST_SPEEDS = 0.0025, 600
"""Relative step of the speeds at which orders are calculated, and their largest number: between them go splines, and a
resonance of 0.5 % damping is twice as wide."""
SPEED_MARGIN = 1e-4
"""Share by which the speeds reach beyond those asked for, as a window's mean speed has errors, too."""


def speed_grid(lowest: float, highest: float) -> FloatArray:
    """Speeds in rad/s, shape (n,), fine enough for splines through resonances, from lowest to highest of a test.

    >>> speed_grid(100.0, 200.0)[[0, -1]].round(2).tolist()
    [99.99, 200.02]
    """
    low, high = lowest * (1 - SPEED_MARGIN), highest * (1 + SPEED_MARGIN)
    return np.geomspace(low, high, int(np.clip(np.log(high / low) / SPEED_STEP, 5, MOST_SPEEDS)))


def calculated_wheel_orders(
    drivetrain: Drivetrain, node: str, speeds: ArrayLike, *, zero: float = 0.0
) -> CalculatedOrders:
    """Response of a node's angle in rad, referred to the reference shaft, as a calibration of a wheel there takes it.

    The response to inertia torques of reciprocating masses is known; that to the working gas of each engine, and to
    any other excitation, is known but for a complex factor in each order.

    Parameters
    ----------
    drivetrain : Drivetrain
        With excitations, in one configuration.
    node : str
        Where the wheel is.
    speeds : (n_speeds,) array
        Of the model's reference shaft, rad/s, rising.
    zero : float, optional
        Angle of that shaft at tooth 0 in the convention of the orders, rad: 0 at top dead centre of the first cylinder.

    Raises
    ------
    UsageError
        The model has no excitations, or no such node.

    Examples
    --------
    >>> import torsionnet as tn
    >>> plant = tn.load("engine_generator_set").configured("firing=normal,rubber=warm")
    >>> orders = calculated_wheel_orders(plant, "fly", np.array([90.0, 100.0]))
    >>> orders.shapes.shape, orders.orders[:2].tolist()
    ((1, 24, 2), [0.5, 1.0])
    """
    if node not in drivetrain.nodes:
        raise UsageError(
            f'the model has no node "{node}" for the wheel; there are {", ".join(drivetrain.nodes)}',
            kind="unknown-node",
        )
    excitations = {name: given for name, given in drivetrain.definition.excitations.items() if given.enabled}
    if not excitations:
        raise UsageError(
            f"{drivetrain.name} has no excitations: what moves the wheel is not known", kind="missing-entry"
        )
    parts = dict(_gas_and_masses(excitations))
    wanted = np.asarray(speeds, dtype=float)
    runs = {name: _with(drivetrain, {name.removesuffix(_MASSES): part}, node, wanted) for name, part in parts.items()}
    orders = np.array(
        sorted(
            {float(line.relative) for run in runs.values() for line in run.lines if line.relative and not line.fixed}
        )
    )
    spread = {name: _by_order(run, orders) for name, run in runs.items()}
    # Inertia torques follow from masses and lengths; all others have a size that the test decides.
    known = sum((values for name, values in spread.items() if name.endswith(_MASSES)), np.zeros((1, 1)))
    shapes = [values for name, values in spread.items() if not name.endswith(_MASSES)]
    shape = (len(orders), len(wanted))
    return CalculatedOrders(
        speeds=wanted,
        orders=orders,
        known=np.broadcast_to(known, shape).astype(complex),
        shapes=np.array(shapes).reshape(len(shapes), *shape),
        zero=zero,
        source=f"{drivetrain.name} {drivetrain.configuration}".strip(),
    )


_MASSES = " masses"


def _gas_and_masses(excitations: dict[str, OrderExcitation]) -> Iterable[tuple[str, OrderExcitation]]:
    """Excitations by name, each engine parted into its gas and its masses."""
    for name, excitation in excitations.items():
        if not isinstance(excitation, ReciprocatingEngine):
            yield name, excitation
            continue
        if excitation.misfire == EACH:
            raise UsageError(
                f"{name} misfires in each cylinder in turn, and a test in one state: choose a configuration without "
                "misfire, or name the cylinder",
                kind="unsupported-law",
            )
        yield name + _MASSES, replace(excitation, gas_off=tuple(excitation.numbers), misfire=(), spread=0.0)
        yield name, replace(excitation, reciprocating_mass=0.0, spread=0.0)


def _with(
    drivetrain: Drivetrain, excitations: dict[str, OrderExcitation], node: str, speeds: FloatArray
) -> OrderResponse:
    changed = Drivetrain.from_definition(replace(drivetrain.definition, excitations=excitations), [])
    reference = changed.order_response(node, speeds=speeds[:1]).reference
    return changed.order_response(f"{node} referred to {reference}", speeds=speeds)


def _by_order(run: OrderResponse, orders: FloatArray) -> ComplexArray:
    """Peak amplitudes in rad, shape (n_orders, n_speeds), of lines of one order added."""
    amplitudes = np.zeros((len(orders), len(run.speeds)), dtype=complex)
    for line, values in zip(run.lines, run.values[:, :, 0].T, strict=True):
        if line.relative and not line.fixed:
            amplitudes[int(np.abs(orders - float(line.relative)).argmin())] += values
    return amplitudes
