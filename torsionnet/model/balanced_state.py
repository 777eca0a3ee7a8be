"""Steady state of a drivetrain with laws of motion: speeds, torques, and the state of each law."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from torsionnet.model.element_base.laws import MotionState


@dataclass(frozen=True)
class BalancedState:
    """Operating point of a drivetrain with laws of motion, at which all mean torques are in balance.

    Attributes
    ----------
    speeds : mapping
        Mean speed in rad/s by node, of the nodes whose speed is known.
    states : mapping
        Mean twist, rate and piece of each law of motion, in their order, by element.
    torques : mapping
        Mean torque in N m of each law of motion against its motion, by element.
    external : mapping
        Mean external torque in N m by node.
    acting : mapping
        The same with the torques of laws that slip, which act on their nodes as torques from outside do.
    stated : tuple of str
        Nodes whose torque from outside is that of a law there, as of a propeller whose load is given too.
    is_stable : bool
        Whether speeds return after a small disturbance.
    notes : tuple of str
    sticking : int
        Number of laws that stick.
    """

    speeds: Mapping[str, float]
    states: Mapping[str, tuple[MotionState, ...]]
    torques: Mapping[str, tuple[float, ...]]
    external: Mapping[str, float] = field(default_factory=dict)
    acting: Mapping[str, float] = field(default_factory=dict)
    is_stable: bool = True
    notes: tuple[str, ...] = ()
    sticking: int = 0
    stated: tuple[str, ...] = ()

    @property
    def tangent_key(self) -> tuple[object, ...]:
        """Pieces in force, and states of smooth curves, by element: equal where all tangents are equal."""
        return tuple(
            (name, tuple(state if state.piece is None else state.piece for state in states))
            for name, states in self.states.items()
        )
