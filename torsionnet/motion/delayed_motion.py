"""Motion over time of a drivetrain where torques of controllers act with a delay.

The torque of a delayed controller follows from the motion one delay ago, so that it is known in advance and acts like
a torque from outside (the method of steps). States go from point to point by the exact transition for torques
that run straight between points; delayed torques are read between points by cubics. The error falls with the square of
the step: it is taken out by extrapolation from two steps, and what that leaves is estimated from a third.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import TorsionnetWarning, UsageError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.dynamic_stiffness.action_states import LawStates, refuse_delayed_acceleration, undelayed_states
from torsionnet.linear.dynamic_stiffness.state_space import (
    NEGLIGIBLE_COEFFICIENT,
    StateSpaceForm,
    first_order,
    output_matrices,
)
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest
from torsionnet.motion.torque_courses import TorqueCourses, first_order_hold

MOST_TIME_STEPS = 400_000
"""Most time steps of all passes of a simulation with delays together, which bounds its duration since steps run one by
one in Python."""
FEWEST_STEPS_PER_DELAY = 3
"""Fewest time steps in the shortest delay, so that the cubic that reads a delayed torque ends before the current
point."""
ERROR_TOLERANCE = 1e-6
"""Estimated error of a simulation with delays, over the largest reading, at which the time step is halved no more."""
ERROR_WARNED = 1e-4
"""Estimated error of a simulation with delays, over the largest reading, above which a warning gives it."""


@dataclass(frozen=True)
class DelayedForm:
    """State space in SI with delayed torques T, x' = A x + B [u, T], y = C x + D [u, T], and the matrices for T itself.

    These give T(t + delay) = E x + F [u, T].
    """

    A: FloatArray
    B: FloatArray
    C: FloatArray
    D: FloatArray
    E: FloatArray
    F: FloatArray
    delays: FloatArray


def delayed_response(
    drivetrain: AssembledModel, request: TransferRequest, torques: TorqueCourses, sampling_rate: float
) -> FloatArray:
    """Readings (n_out, n) in SI units over time under torques (n_in, n) in N m, with delayed controllers.

    Raises
    ------
    UsageError
        The delays are too short against the time asked for, or a law has no motion over time.
    """
    form, h, n = _form(drivetrain, request), 1 / sampling_rate, torques.samples.shape[1]
    fineness = max(1, math.ceil(FEWEST_STEPS_PER_DELAY * h / form.delays.min()))
    used = 3 * fineness * n
    if used > MOST_TIME_STEPS:
        text = (
            f"the shortest delay, {form.delays.min():.3g} s, needs more than {MOST_TIME_STEPS} steps over {n * h:.3g} s"
        )
        raise UsageError(f"{text}; simulate a shorter time")
    last = _delayed_steps(form, torques, h, fineness)
    found, error = last, math.inf
    while error > ERROR_TOLERANCE and used <= MOST_TIME_STEPS:
        fineness *= 2
        finer = _delayed_steps(form, torques, h, fineness)
        extrapolated = finer + (finer - last) / 3
        sizes = np.abs(extrapolated).max(axis=1, keepdims=True)
        error = float((np.abs(extrapolated - found) / np.where(sizes > 0, sizes, 1.0)).max(initial=0.0))
        last, found, used = finer, extrapolated, used + 2 * fineness * n
    if error > ERROR_WARNED:
        text = f"with delays, readings are right to about {100 * error:.2g} % of their largest value"
        warnings.warn(
            f"{text}; a higher sampling rate or a shorter time gives more digits", TorsionnetWarning, stacklevel=5
        )
    return found


def _form(drivetrain: AssembledModel, request: TransferRequest) -> DelayedForm:
    assembly = drivetrain.assembly
    laws = [undelayed_states(assembly, one) for one in assembly.system.actions]
    opened = [one for one in laws if one.action.delay]
    for one in opened:
        refuse_delayed_acceleration(one)
    form = first_order(
        assembly, request.excitations, closing=[one for one in laws if not one.action.delay], opened=opened
    )
    sizes = np.cumsum([len(form.A), *(len(one.F) for one in opened)])
    A, B = np.zeros((sizes[-1], sizes[-1])), np.zeros((sizes[-1], form.B.shape[1]))
    n = len(form.A)
    A[:n, :n], B[:n] = form.A, form.B
    E, F = np.zeros((len(opened), sizes[-1])), np.zeros((len(opened), form.B.shape[1]))
    for place, law in enumerate(opened):
        own = slice(sizes[place], sizes[place + 1])
        y, direct, rate, rate_direct = _sensed(law, form)
        A[own, own] = law.F
        A[own, :n] = np.outer(law.G[:, 0], y) + np.outer(law.G[:, 1], rate)
        B[own] = np.outer(law.G[:, 0], direct) + np.outer(law.G[:, 1], rate_direct)
        E[place, own], E[place, :n] = law.H, law.at_once[0] * y + law.at_once[1] * rate
        F[place] = law.at_once[0] * direct + law.at_once[1] * rate_direct
    C, D = output_matrices(assembly, request.outputs, request.excitations, form, opened)
    C = np.hstack([C, np.zeros((len(C), sizes[-1] - n))])
    return DelayedForm(A, B, C, D, E, F, np.array([float(one.action.delay) for one in opened]))


def _sensed(law: LawStates, form: StateSpaceForm) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Sensed angle y and its rate y' of a controller, as rows over states and over torques (y_x, y_u, y'_x, y'_u)."""
    y, direct = law.sensed @ form.X, law.sensed @ form.U
    uses_rate = law.at_once[1] or law.G[:, 1].any()
    if uses_rate and np.abs(direct).max(initial=0.0) > NEGLIGIBLE_COEFFICIENT * np.abs(form.U).max(initial=0.0):
        text = "senses the rate of a motion without inertia and damper, which follows the rate of a torque"
        raise UsageError(f"{law.action.owner} {text}; give its nodes inertia or dampers")
    return y, direct, y @ form.A, y @ form.B


def _delayed_steps(form: DelayedForm, torques: TorqueCourses, h: float, fineness: int) -> FloatArray:
    """Readings (n_out, n) in SI units at the samples, with ``fineness`` time steps from each to the next."""
    n_in, n = torques.samples.shape
    count, step = (n - 1) * fineness + 1, h / fineness
    inside = torques.within(np.arange(fineness + 1) / fineness)
    drive = np.hstack([inside[:, :, :-1].reshape(n_in, -1), torques.samples[:, -1:]])
    ends = inside[:, :, 1:].reshape(n_in, -1).T
    passage, before, after = (part.real for part in first_order_hold(form.A, form.B, step))
    weights = [_Between(delay / step) for delay in form.delays]
    x, found = np.zeros(len(form.A)), np.zeros((count, len(form.delays)))
    u = np.concatenate([drive, np.zeros((len(form.delays), count))]).T.copy()
    states = np.zeros((n, len(x)))
    for point in range(count):
        for number, one in enumerate(weights):
            u[point, n_in + number] = one.read(found[:, number], point)
        if point:
            end = np.concatenate([ends[point - 1], u[point, n_in:]])
            x = passage @ x + before @ u[point - 1] + after @ end
        found[point] = form.E @ x + form.F @ u[point]
        if point % fineness == 0:
            states[point // fineness] = x
    return np.asarray(form.C @ states.T + form.D @ u[::fineness].T)


class _Between:
    """Interpolator of a signal ``ago`` points back in time, by the cubic through four points.

    The signal is zero before the first point.
    """

    def __init__(self, ago: float) -> None:
        whole = math.ceil(ago - 1e-9)
        self.back, self.share = whole, max(0.0, whole - ago)
        self.inner, self.first = _lagrange(self.share + 1), _lagrange(self.share)

    def read(self, signal: FloatArray, point: int) -> float:
        place = point - self.back
        if place < 0:
            return 0.0
        if place == 0:
            return float(self.first @ signal[:4])
        return float(self.inner @ signal[place - 1 : place + 3])


def _lagrange(x: float) -> FloatArray:
    """Weights (4,) of the values at 0, 1, 2 and 3 in the value at x, interpolated by a cubic."""
    return np.array([
        -(x - 1) * (x - 2) * (x - 3) / 6,
        x * (x - 2) * (x - 3) / 2,
        -x * (x - 1) * (x - 3) / 2,
        x * (x - 1) * (x - 2) / 6,
    ])  # fmt: skip
