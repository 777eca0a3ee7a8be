"""Linear parts that carry the mean torques of laws of motion at their mean twists, for mean torques of all elements."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from torsionnet.model.balanced_state import BalancedState
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.element import OtherLaws
from torsionnet.model.element_base.laws import MotionState
from torsionnet.model.elements import Constraint, Element, Law, MotionLaw, Part, Values


@dataclass(frozen=True)
class SecantLaws(OtherLaws):
    """Laws of an element with springs T/gamma at the mean torques and twists of its laws.

    What stands still is rigid, what slips or has no torque is nothing: the torque of what slips acts from outside.
    """

    states: tuple[MotionState, ...]
    torques: tuple[float, ...]

    def parts(self, value: Values) -> tuple[Part, ...]:
        given = iter(zip(self.states, self.torques, strict=True))
        return tuple(
            _secant(part, *next(given)) if isinstance(part, MotionLaw) else part
            for part in self.element.whole_parts(value)
        )


def _secant(law: MotionLaw, state: MotionState, torque: float) -> Part:
    # Friction that holds passes its torque at no rate, as a rigid link; what slips is a torque from outside.
    if law.curve.over == "rate":
        return Constraint(law.row) if torque and law.curve.holds(state) else Law(law.row)
    # T/gamma in the origin is the tangent there; a twist without torque, as in a clearance, has no spring.
    if not torque:
        tangent = law.tangent(state)[0]
        return Law(law.row, stiffness=tangent.stiffness if isinstance(tangent, Law) and not state.twist else 0)
    return Law(law.row, stiffness=torque / state.twist) if state.twist else Constraint(law.row)


@dataclass(frozen=True, eq=False)
class Secants:
    """Operating point at which laws of motion are springs that carry their mean torques at their mean twists."""

    state: BalancedState

    def linear(self, elements: Sequence[Element]) -> tuple[Element, ...]:
        """Elements with secants in place of their laws of motion."""
        return tuple(map(self._linear, elements))

    def _linear(self, element: Element) -> Element:
        if element.name not in self.state.states or not element.has_motion_laws:
            return element
        states, torques = self.state.states[element.name], self.state.torques[element.name]
        return element.with_laws(SecantLaws(element, states, torques))

    @property
    def states(self) -> tuple[BalancedState, ...]:
        """Tuple of the one state whose secants these are."""
        return (self.state,)

    @property
    def is_loaded(self) -> bool:
        """Whether torques or speeds are given, which they are."""
        return True

    @property
    def given_speeds(self) -> Mapping[str, float]:
        """Empty mapping, as the state is given and no speed chooses it."""
        return {}

    def depends_on(self, names: frozenset[str]) -> bool:
        """Whether the state may change with parameters: it is given."""
        del names
        return False

    def of(self, definition: Definition) -> Secants:
        """Secants of any definition, which are these, as their state is given."""
        del definition
        return self

    def with_values(self, values: Mapping[str, float]) -> Secants:
        """Secants of any definition, which are these, as their state is given."""
        del values
        return self


def with_secants(definition: Definition, state: BalancedState) -> Definition:
    """Definition of a model whose laws of motion carry the mean torques of a state, which act from outside.

    It has no load of its own.
    """
    return replace(definition, tangents=Secants(state), load=None)


@dataclass(frozen=True, eq=False)
class SlippingLaw:
    """Law over the rate that slips, with its element and its mean torque in N m against its motion."""

    owner: str
    law: MotionLaw
    torque: float


def slipping_torques(elements: Sequence[Element], value: Values, state: BalancedState) -> Iterator[SlippingLaw]:
    """Yield every law over the rate that slips at a state with a torque."""
    for element in elements:
        if element.name in state.states and element.has_motion_laws:
            laws = [part for part in element.whole_parts(value) if isinstance(part, MotionLaw)]
            given = zip(laws, state.states[element.name], state.torques[element.name], strict=True)
            yield from (
                SlippingLaw(element.name, law, torque)
                for law, own, torque in given
                if law.curve.over == "rate" and torque and not law.curve.holds(own)
            )
