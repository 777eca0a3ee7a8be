"""Relative vector sums of an engine's cylinders on the modes of a drivetrain."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.modes.mode_pairs import vibration_modes
from torsionnet.linear.modes.natural_modes import modes as damped_modes
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.machinery.phasors.generalised_force import star_diagram
from torsionnet.machinery.phasors.vector_sums import VectorSums


def vector_sums(
    drivetrain: AssembledModel,
    excitation: str,
    *,
    modes: Iterable[int] | None = None,
    orders: Iterable[float] | None = None,
    without: Iterable[int] = (),
) -> VectorSums:
    """Relative vector sums of an engine by mode and order, all cylinders alike: misfires and factors do not count.

    Cylinder z at the amplitude theta_z of the mode fires at the crank angle alpha_z; order h has the sum
    ``|sum_z theta_z exp(-j h alpha_z)| / max theta``, the largest amplitude being that of a cylinder
    (W. Ker Wilson, Practical Solution of Torsional Vibration Problems, volume 2, Amplitude Calculations).

    Parameters
    ----------
    excitation : str
        Name of the engine.
    modes : iterable of int, optional
        Numbers of modes; default: all that vibrate.
    orders : iterable of float, optional
        Orders; default: those of the engine.
    without : iterable of int, optional
        Numbers of cylinders that give no torque, as one that is out.

    Raises
    ------
    UsageError
        The excitation is no engine, or there is no such mode.

    Examples
    --------
    >>> import torsionnet as tn
    >>> found = vector_sums(tn.load("two_stroke_ship").configured("normal"), "engine", modes=[1], orders=[1, 5, 6])
    >>> [(one.order, round(one.sum, 3)) for one in found.rows()]
    [(1, 0.056), (5, 0.056), (6, 5.611)]
    >>> found = vector_sums(tn.load("two_stroke_ship"), "engine", modes=[1], orders=[1, 6], without=[2])
    >>> [(one.order, round(one.sum, 3)) for one in found.rows()]
    [(1, 0.99), (6, 4.622)]
    """
    known = drivetrain.definition.excitations
    engine = known.get(excitation)
    if not isinstance(engine, ReciprocatingEngine):
        engines = [name for name, one in known.items() if isinstance(one, ReciprocatingEngine)]
        raise UsageError(f'no engine is named "{excitation}"{did_you_mean(excitation, engines)}')
    sound = replace(engine, misfire=(), gas_off=tuple(without), factors={})
    shapes = _shapes(drivetrain)
    numbers = tuple(shapes if modes is None else modes)
    if missing := [number for number in numbers if number not in shapes]:
        raise UsageError(f"there is no mode {missing[0]}; there are {len(shapes)}, counted from 1")
    chosen = tuple(engine.acting_orders.tolist() if orders is None else orders)
    stars = {
        (mode, order): star_diagram(sound, excitation, order, shapes[mode], phrase("mode {number}", number=mode))
        for mode in numbers
        for order in chosen
    }
    return VectorSums(excitation, numbers, chosen, stars)


def _shapes(drivetrain: AssembledModel) -> dict[int, Mapping[str, complex]]:
    """Shape of every vibration by number of the mode, as complex angles by node, without unit."""
    nodes = drivetrain.assembly.nodes
    found = sorted(vibration_modes(drivetrain, damped_modes(drivetrain)), key=lambda one: one.number)
    return {one.number: dict(zip(nodes, one.shape.tolist(), strict=True)) for one in found}
