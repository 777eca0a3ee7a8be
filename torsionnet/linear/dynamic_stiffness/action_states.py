"""State equations of actions (controllers, fluid couplings), with delays as lines of collocation points.

A law is split into P(s) + R(s)/D(s), R of lower degree than D. P acts as inertia, damping and stiffness that need not
be symmetric; R/D has the states of a companion form in a time of its own,

    z' = w (F z + e y),    T = h z

A delay has no finite number of states. With ``points``, the torque travels along a line of so many
(collocation on Chebyshev points), which is right far beyond 1/delay but never everywhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.action_laws import ActionLaw, divide_polynomials
from torsionnet.linear.assembly.rows import Assembly, FloatArray

HIGHEST_POWER = 2
"""Highest power of s, 2, with which an action may feed the sensed angle through at once, that is its acceleration."""


@dataclass(frozen=True)
class LawStates:
    """State matrices of an action, z' = F z + G_0 y + G_1 y', T = P(s) y + H z, from angle y in rad to T in N m.

    The coefficients of P are ``at_once``.

    ``row`` and ``sensed`` (n_q,) are where T drives, and the motion y.
    """

    action: ActionLaw
    row: FloatArray
    sensed: FloatArray
    at_once: FloatArray
    F: FloatArray
    G: FloatArray
    H: FloatArray


def law_states(assembly: Assembly, points: int = 0) -> tuple[LawStates, ...]:
    """State equations of each action of an assembly (controller, fluid coupling), in the order of its actions.

    A delay is replaced by a line of ``points`` collocation points.

    Raises
    ------
    UsageError
        A delay without points, or a law that grows quicker with frequency than can be followed in time.
    """
    return tuple(_states(assembly, action, points) for action in assembly.system.actions)


def undelayed_states(assembly: Assembly, action: ActionLaw) -> LawStates:
    """State equations of one action as if its torque followed the sensed angle without its delay.

    Raises
    ------
    UsageError
        A law that grows quicker with frequency than can be followed in time.
    """
    # N / D = P + R / D, with P acting at once.
    whole, rest = divide_polynomials(action.numerator, action.denominator)
    if len(whole) > HIGHEST_POWER + 1:
        text = "its law grows quicker with frequency than the acceleration of what it senses; give it a filter"
        raise UsageError(f"{action.owner}: {text}", kind="unsupported-law")
    P = np.array([float(value) for value in (*whole, 0, 0, 0)[: HIGHEST_POWER + 1]])
    F, w, h = companion(rest, action.denominator)
    G = np.zeros((len(F), 2))
    G[-1:, 0] = w
    row, sensed = (assembly.over_coordinates(part) for part in (action.row, action.sensed))
    return LawStates(action, row, sensed, P, F, G, h)


def _states(assembly: Assembly, action: ActionLaw, points: int) -> LawStates:
    alone = undelayed_states(assembly, action)
    if not action.delay:
        return alone
    if not points:
        text = "a delay has no finite number of states; leave it out, or ask for modes, responses or a motion"
        raise UsageError(f"{action.owner}: {text}", kind="unsupported-law")
    refuse_delayed_acceleration(alone)
    travelling = _delayed(alone.at_once, alone.F, alone.G, alone.H, float(action.delay), points)
    return LawStates(action, alone.row, alone.sensed, np.zeros(3), *travelling)


def refuse_delayed_acceleration(law: LawStates) -> None:
    """Raise UsageError for a delayed action that feeds an acceleration through at once.

    It has infinitely many fast poles.

    Raises
    ------
    UsageError
        The law hands on an acceleration at once.
    """
    if law.at_once[HIGHEST_POWER]:
        text = "what follows an acceleration with a delay and without a filter has infinitely many fast poles"
        raise UsageError(f"{law.action.owner}: {text}; give it a filter", kind="unsupported-law")


def companion(numerator: Sequence[Fraction], denominator: Sequence[Fraction]) -> tuple[FloatArray, float, FloatArray]:
    """Companion matrices F (n, n) and h (n,) of a controller's R(s)/D(s), and their scale w in 1/s.

    No coefficient is above w. The form is z' = F z + w e y, T = h z with e the last state.
    """
    d, r = ([float(value) for value in part] for part in (denominator, numerator))
    n = len(d) - 1
    # With s in units of w no coefficient of D is above 1.
    w = max((abs(value) ** (1 / (n - power)) for power, value in enumerate(d[:-1]) if value), default=1.0)
    F = w * np.eye(n, k=1)
    if n:
        F[-1] = [-w * value * w ** (power - n) for power, value in enumerate(d[:-1])]
    h = np.array([value * w ** (power - n) for power, value in enumerate(r)])
    return F, w, np.concatenate([h, np.zeros(n - len(h))])


def _delayed(
    P: FloatArray, F: FloatArray, G: FloatArray, h: FloatArray, delay: float, points: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """State matrices F, G (n, 2) and H (n,) of an action with a delay of ``delay`` seconds, by collocation points.

    The torque travels along a line of these points, whose values are states after those of the action.
    """
    # Transport along the line from 0 to 1, delay dT/dt = -dT/dx, which P y + h z enters.
    along = _derivative(points) / delay
    n, m = len(F), points
    whole = np.zeros((n + m, n + m))
    whole[:n, :n], whole[n:, n:] = F, -along[1:, 1:]
    whole[n:, :n] = -np.outer(along[1:, 0], h)
    driven = np.zeros((n + m, 2))
    driven[:n], driven[n:] = G, -np.outer(along[1:, 0], P[:2])
    end = np.zeros(n + m)
    end[-1] = 1.0
    return whole, driven, end


def _derivative(points: int) -> FloatArray:
    """Matrix (m, m) that differentiates values at m = points + 1 Chebyshev points from 0 to 1.

    See Trefethen, Spectral Methods in MATLAB.
    """
    place = np.cos(np.pi * np.arange(points + 1) / points)
    weight = np.where(np.isin(np.arange(points + 1), (0, points)), 2.0, 1.0) * (-1.0) ** np.arange(points + 1)
    apart = place[:, None] - place[None, :] + np.eye(points + 1)
    slopes = np.outer(weight, 1 / weight) / apart
    # A constant has no derivative: every row adds up to zero.
    slopes -= np.diag(slopes.sum(axis=1))
    # Cosines run from 1 to -1, places from 0 to 1.
    return np.asarray(-2 * slopes)
