"""Orders that a model calculates at a toothed wheel, parted into what masses decide and what the test decides."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.machinery.excitations.engine_entries import EACH
from torsionnet.machinery.excitations.order_excitation import OrderExcitation
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.signals.rotation.pitch_order import CalculatedOrders

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
