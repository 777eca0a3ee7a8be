"""Laws of a drivetrain at values of its unknowns, about the operating point that it has at these values.

Torques, stiffnesses and ratios move the states of laws of motion, and with these the slopes of smooth curves. The
derivative of a stiffness or damping there is the one along the solution of the balance: differences of balances give
it, as that of a straight piece, which does not move within the piece, is exact without them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from torsionnet.base.errors import ModelError, UsageError
from torsionnet.base.expressions import FLOAT
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.sensitivity.dual import DUALS, Dual, value_of
from torsionnet.linear.sensitivity.unknowns import Unknowns
from torsionnet.model.balanced_state import BalancedState
from torsionnet.model.definition import Definition, Tangents
from torsionnet.model.element_base.element import TangentLaws
from torsionnet.model.elements import Element, Law, MotionLaw, Values
from torsionnet.model.kinematics import OwnedPart, owned_parts
from torsionnet.model.law_network import following_elements
from torsionnet.model.motion_laws.piece_curve import PieceCurve

STEPS = (1e-3, 1e-4, 1e-5)
"""Shares of a parameter by which it is moved: the first has the least error, the others serve beside a corner."""
AGREEMENT = 1e-3
"""Share by which differences over one and over two steps may differ: far more than curvature, far less than a corner
between them makes."""
ROUNDING = 1e-9
"""Share of a coefficient, over the share of the step, that rounding in balances may leave in differences."""


def parts_at(unknowns: Unknowns, at: Sequence[float]) -> tuple[OwnedPart, ...]:
    """Laws, constraints and actions with derivatives to the unknowns, about the operating point at their values.

    Raises
    ------
    ModelError
        The torques are not in balance there.
    UsageError
        The slope of a curve has no derivative there, as at the breakdown torque of a motor.
    """
    values, definition = Values(unknowns.values(at), DUALS), unknowns.definition
    tangents = definition.tangents
    if tangents is None or not following_elements(definition):
        return owned_parts(definition, values)
    here = tangents.with_values(dict(zip(unknowns.parameters, at, strict=True)))
    definition = replace(definition, tangents=here)
    found = owned_parts(definition, values)
    smooth = tuple(name for name, one in _about_states(definition) if _is_smooth(one, values))
    if not smooth:
        return found
    slopes = _Slopes(tangents, unknowns, tuple(at), smooth, here.state)
    gradients = np.stack([slopes.along(p) for p in range(len(at))], axis=-1)
    numbers = iter(gradients.tolist())
    return tuple(
        replace(one, part=_with_gradients(one.part, next(numbers), next(numbers)))
        if one.element in smooth and isinstance(one.part, Law)
        else one
        for one in found
    )


def _about_states(definition: Definition) -> list[tuple[str, Element]]:
    """Elements, by name, whose laws of motion are linear about states that follow from the operating point."""
    pairs = ((one.name, one.other_laws) for one in definition.active)
    return [(name, laws.element) for name, laws in pairs if isinstance(laws, TangentLaws)]


def _is_smooth(element: Element, values: Values) -> bool:
    laws = (part for part in element.whole_parts(values) if isinstance(part, MotionLaw))
    return any(not isinstance(law.curve, PieceCurve) for law in laws)


def _with_gradients(law: Law, damping: Sequence[float], stiffness: Sequence[float]) -> Law:
    return replace(
        law,
        damping=Dual(value_of(law.damping), np.array(damping)),
        stiffness=Dual(value_of(law.stiffness), np.array(stiffness)),
    )


@dataclass(frozen=True, eq=False)
class _Slopes:
    """Damping and stiffness of the laws of some elements along the unknowns, with the balance at each of their values.

    ``state`` is that of the operating point: of several balances at other values the one next to it counts.
    """

    tangents: Tangents
    unknowns: Unknowns
    at: tuple[float, ...]
    elements: tuple[str, ...]
    state: BalancedState

    def along(self, number: int) -> FloatArray:
        """Derivatives (2 n_laws,) of damping and stiffness of all laws to one unknown."""
        size, own = abs(self.at[number]) or 1.0, self._own
        for share in STEPS:
            step = share * size
            try:
                moved = [self._moved(number, count * step) for count in (1, -1, 2, -2)]
            except (ModelError, UsageError, ArithmeticError):
                continue
            once, twice = (moved[0] - moved[1]) / (2 * step), (moved[2] - moved[3]) / (4 * step)
            sizes = np.maximum(np.abs(once), np.abs(twice))
            if (np.abs(once - twice) <= AGREEMENT * sizes + ROUNDING * np.abs(own) / step).all():
                return np.asarray((4 * once - twice) / 3)
        raise UsageError(
            f"the slopes of {', '.join(self.elements)} at the operating point have no derivative to "
            f"{self.unknowns.names[number]} there: a curve ends or has a corner; take another operating point"
        )

    @cached_property
    def _own(self) -> FloatArray:
        return self._coefficients(self.at)

    def _moved(self, number: int, step: float) -> FloatArray:
        return self._coefficients([*self.at[:number], self.at[number] + step, *self.at[number + 1 :]])

    def _coefficients(self, at: Sequence[float]) -> FloatArray:
        """Damping and stiffness (2 n_laws,) of all laws of the elements at values of the unknowns."""
        numbers = dict(zip(self.unknowns.parameters, at, strict=True))
        moved = self.tangents.with_values(numbers)
        state = self.state if tuple(at) == self.at else min(moved.states, key=self._distance)
        values = Values({name: float(one) for name, one in self.unknowns.values(at).items()}, FLOAT)
        found: list[Any] = []
        for element in self.unknowns.definition.switched_on:
            if element.name in self.elements:
                parts = element.tangent_parts(values, state.states[element.name])
                found += [one for law in parts if isinstance(law, Law) for one in (law.damping, law.stiffness)]
        return np.array(found, dtype=float)

    def _distance(self, other: BalancedState) -> float:
        """Largest difference of twists and rates of two states, over the largest of both."""
        first, second = _numbers(self.state.states), _numbers(other.states)
        largest = max((max(abs(one), abs(two)) for one, two in zip(first, second, strict=True)), default=0.0)
        return max((abs(one - two) for one, two in zip(first, second, strict=True)), default=0.0) / (largest or 1.0)


def _numbers(states: Mapping[str, Sequence[Any]]) -> list[float]:
    return [number for some in states.values() for one in some for number in (one.twist, one.rate)]
