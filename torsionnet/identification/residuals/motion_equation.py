"""Equation of motion of an element with laws of motion, as a function of parameters, along a twist over time.

The element with the laws is taken out; a spring k_0 stays in its place. If one mass moves then, the linear rest is

    J gamma'' + c gamma' + k gamma + tau(gamma, gamma') = g u

with the torque u that drives and the torque tau of the laws; an output y = p gamma reads the twist.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.expressions import FLOAT, ExpressionError
from torsionnet.identification.residuals.laws_over_time import slider_torque, torque_over_time
from torsionnet.identification.residuals.stepped_curve import (
    LawsOnTwist,
    beside_of,
    channels_beside,
    laws_of,
    linear_beside,
    on_one_twist,
)
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.sensitivity.parametric import parametric_response
from torsionnet.linear.sensitivity.unknowns import unknowns
from torsionnet.model.elements import Values
from torsionnet.model.motion_laws.element_stiffness import stiffness_over_twists

SPREAD = np.array([0.7, 1.0, 1.6])
"""Frequencies, over that of the motion, at which the linear rest is read: two tell J, c and k, the third checks."""
NO_EFFECT = 1e-9
"""Twist by a torque of the laws, over that of k_0 alone, that is none."""
ONE_MASS = 1e-6
"""Largest share by which the rest may miss that of one mass."""
HALVES, GAUSS = np.array([[-1.0], [-1], [1], [1]]), np.array([[-1.0], [1], [-1], [1]]) / 3**0.5
"""Half of a sample, before and after a reversal, and place in it of the points by Gauss at which laws are evaluated."""


@dataclass(frozen=True)
class LinearRest:
    """Coefficients of the linear rest: J, c and k of its twist in SI units, g of the torque, p of the output."""

    inertia: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0
    drive: float = 1.0
    output: float = 1.0


@dataclass(frozen=True, eq=False)
class MotionEquation(LawsOnTwist):
    """Equation of motion of the twist of an element, as a function of parameters.

    Attributes
    ----------
    drives : bool
        Whether a torque is measured, else the motion is a decay.
    """

    drives: bool
    unit: str = "N*m"

    @cached_property
    def rest_at_start(self) -> LinearRest:
        """Coefficients of the linear rest in the model as given."""
        return self.rest(self.start.tolist())

    def rest(self, numbers: Sequence[float]) -> LinearRest:
        """Coefficients of the linear rest at values of the unknowns.

        Raises
        ------
        UsageError
            More than one mass moves, the output is no multiple of the twist, or the torque is that of another element.
        """
        if self.linear is None:
            return LinearRest()
        beside, omega = beside_of(self.linear, self.row, numbers), 2 * np.pi * self.linear.frequencies
        if np.abs(beside.by_torque).max() * self.spring < NO_EFFECT:
            what = ", ".join(self.elements)
            text = f"the torque measured is that of an element beside {what}, which it tells nothing of"
            raise UsageError(f"{text}; name the torque of all of them, as of an input or a meter", kind="no-effect")
        kappa = 1 / beside.by_torque  # k_0 + k + j w c - w^2 J
        inertia = -float((kappa[1] - kappa[0]).real / (omega[1] ** 2 - omega[0] ** 2))
        damping = float(kappa[0].imag / omega[0])
        stiffness = float(kappa[0].real + inertia * omega[0] ** 2)
        g, p = beside.of_twist * kappa, beside.output_by_torque * kappa
        rest = np.asarray(stiffness + 1j * omega * damping - omega**2 * inertia, dtype=np.complex128)
        even = (
            _apart(rest, kappa),
            *(_apart(np.full(3, coefficient[0].real), coefficient) for coefficient in (p, g)[: 1 + self.drives]),
        )
        if max(even) > ONE_MASS:
            what = ", ".join(self.elements)
            text = f"beside {what} more than one mass moves, or the output is no multiple of the twist of {what}"
            raise UsageError(
                f"{text}; lock what stands still, and name a sensor {{twist: {self.elements[0]}}}", kind="unfit-channel"
            )
        return LinearRest(inertia, damping, stiffness - self.spring, float(g[0].real), float(p[0].real))

    def torque(self, numbers: Sequence[float], twist: FloatArray, rate: FloatArray, step: float) -> FloatArray:
        """Torque (n,) in N m of the laws along a twist in rad with its rate in rad/s, a step of ``step`` s apart.

        It is the mean over the time of a sample, each side of a reversal in it by itself: there friction turns.
        """
        bend = np.gradient(rate, step)
        # The rate is taken for linear within a sample: it is zero -rate/bend after the middle, if that is inside.
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = np.where(np.abs(rate) < np.abs(bend) * step / 2, -rate / bend, 0.0)
        share = (step / 2 - HALVES * turn) / (2 * step)
        # Gauss' points of the parts before and after the reversal.
        at = (turn + HALVES * step / 2) / 2 + GAUSS * step * share
        twists, rates = twist + at * rate + at**2 / 2 * bend, rate + at * bend

        def slider(stiffness: float, most: float, angles: FloatArray) -> FloatArray:
            return slider_torque(stiffness, most, np.sum(share * angles, axis=0))[None]

        total = np.zeros(len(twist))
        try:
            given = {name: float(number) for name, number in self.unknowns.values(list(numbers)).items()}
            value = Values(given, FLOAT)
            for name in self.elements:
                laws = laws_of(self.unknowns.definition.elements[name], value)
                total += np.sum(share * torque_over_time(*laws, twists, rates, slider), axis=0)
        except (ZeroDivisionError, OverflowError, ExpressionError) as error:
            raise SolveError(f"the laws of {', '.join(self.elements)}: {error}", kind="no-solution") from None
        return total

    @property
    def remembers(self) -> bool:
        """Whether a law depends on what went before: friction behind a spring."""
        elements = [self.unknowns.definition.elements[name] for name in self.elements]
        return any(
            element.kind == "friction" and getattr(element, "stiffness", None) is not None for element in elements
        )


def _apart(supposed: FloatArray | ComplexArray, expected: ComplexArray) -> float:
    return float(np.abs(supposed - expected).max() / np.abs(expected).max())


def motion_equation(
    rig: AssembledModel,
    output: str,
    into: str,
    excitation: str | None,
    parameters: tuple[str, ...],
    motion: tuple[float, float],
) -> MotionEquation:
    """Equation of motion of the element with laws of motion whose twist ``output`` reads, under the torque ``into``.

    ``motion`` is a typical amplitude in rad and frequency in Hz; without ``into`` nothing drives.

    Raises
    ------
    UsageError
        The model has no law of motion, laws on several twists, or names that it lacks.
    """
    varied = unknowns(rig, parameters)
    elements, row = on_one_twist(rig)
    sensor = rig.sensors.get(into)
    if sensor is not None and sensor.quantity == "torque" and sensor.of in elements:
        return MotionEquation(rig, varied, (sensor.of,), None, row, 0.0, drives=True)
    value, sizes = Values(dict(rig.exact_values), FLOAT), (*motion[:1], 0.0, 2 * np.pi * motion[1])
    at = tuple(np.array([size]) for size in sizes)
    each = [stiffness_over_twists(*laws_of(rig.definition.elements[name], value), *at)[0] for name in elements]
    # A spring of the size of the laws stands in their place: responses beside it are those of a plant that holds.
    spring = float(np.abs(sum(each))) or 1.0
    linear_rig, held = linear_beside(varied, rig, elements, row, spring)
    outputs, driving = channels_beside(rig, output, into or next(iter(held)), excitation, elements[0])
    linear = parametric_response(linear_rig, outputs, [driving, *held], motion[1] * SPREAD, varied.parameters)
    equation = MotionEquation(rig, varied, elements, linear, held, spring, drives=bool(into))
    equation.rest(equation.start.tolist())
    return equation
