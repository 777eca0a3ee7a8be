"""State space of transfer functions against measured inputs, Y_out Y_in^-1, by inversion of the readings.

With x' = A x + B u, outputs y = C x + D u and measured inputs m = C_m x + D_m u the excitations u are unknown. Each
measured input is differentiated until excitations show in it, r_i times (Isidori, Nonlinear Control Systems, 3rd ed.,
section 5.1, for linear systems):

    m^(r) = Q x + G u,   so that   u = G^-1 (m^(r) - Q x)

The lower derivatives S x = (m, m', ...) fix as many states; the rest w turns by itself and under m:

    x = N w + P (m, m', ...),   w' = L (A - B G^-1 Q) (N w + P_0 m)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from torsionnet.base.errors import UsageError, warn_user
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import Functional, functional, law_stiffness
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.quotient import transfer_functions
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, cut_definition, elements_beyond_cut
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.elements import GROUND
from torsionnet.model.readings import port_of

NEGLIGIBLE = 1e-9
"""Size of a number over that of its terms below which it counts as zero, as the terms themselves are rounded."""
CHECKED, TOLD_ERROR = 24, 1e-6
"""Number of frequencies at which a state space is compared with the response, and share of that which is told."""
ROUNDED = 100 * np.finfo(float).eps
"""Change of A over its size by which a pole at 0 of a free motion is known; a double one is then far from 0."""
HIDDEN, CLEAR = 1e-8, 1e6
"""Share of a pole in what it is read or driven by, below which it is hidden, and condition up to which that counts."""


class FarSide(NamedTuple):
    """Drivetrain beyond a meter, its outputs, the torque at the cut that drives it, and the sense of that in T.

    Its motions are its own response to the measured torque, whatever stands before the meter.
    """

    drivetrain: AssembledModel
    outputs: tuple[Functional, ...]
    torque: Input
    sense: int


def far_side(drivetrain: AssembledModel, request: TransferRequest) -> FarSide | None:
    """Drivetrain beyond the measured torque of a request, None where that does not hold all of its outputs."""
    kept = elements_beyond_cut(drivetrain, request) if request.is_measured else None
    meter = request.inputs[0].sensor
    if kept is None or meter is None or meter.referred_to:
        return None
    rest = drivetrain.with_definition(cut_definition(drivetrain.definition, kept))

    def is_there(sensor: Sensor | None) -> bool:
        return (
            sensor is not None
            and not sensor.referred_to
            and (sensor.of in rest.elements if sensor.is_on_element else {*rest.nodes} >= {*sensor.nodes} - {GROUND})
        )

    if not all(is_there(output.sensor) for output in request.outputs):
        return None
    outputs = tuple(functional(rest, output.sensor, output.name) for output in request.outputs if output.sensor)
    # The reading counts torque into the element; the node gets the opposite.
    node, sense = port_of(drivetrain.elements[meter.of], meter.at)
    return FarSide(rest, outputs, Input("torque", node), sense if meter.of in kept else -sense)


@dataclass(frozen=True)
class LinearSystem:
    """Matrices of x' = A x + B u, y = C x + D u in SI units."""

    A: FloatArray
    B: FloatArray
    C: FloatArray
    D: FloatArray

    def response(self, s: complex) -> ComplexArray:
        """Outputs per input (n_out, n_in) at a Laplace variable s in rad/s."""
        return np.asarray(self.C @ np.linalg.solve(s * np.eye(len(self.A)) - self.A, self.B) + self.D)


def against_measured(outputs: LinearSystem, measured: LinearSystem, names: str, read: Sequence[str]) -> LinearSystem:
    """State space from measured inputs to outputs of two systems with the same states and excitations.

    Parameters
    ----------
    outputs, measured : LinearSystem
        With as many measured inputs as excitations.
    names : str
        Names of the measured inputs.
    read : sequence of str
        Names of the outputs.

    Raises
    ------
    UsageError
        The measured inputs depend on each other, or an output contains the rate of change of a measured input.
    """
    # Angles and velocities differ by the size of the rates: states in units of their own lose fewer digits.
    outputs, measured = balanced(outputs, measured)
    A, B = outputs.A, outputs.B
    # Rows of Q and G, and the chains c_i, c_i A, ... of the derivatives in which no excitation shows.
    followed = [_until_driven(A, B, row, direct, names) for row, direct in zip(measured.C, measured.D, strict=True)]
    Q, G = (np.array([getattr(chain, part) for chain in followed]) for part in ("states", "drive"))
    sizes = np.abs(G).max(axis=1, keepdims=True)
    if np.linalg.svd(G / sizes, compute_uv=False)[-1] < NEGLIGIBLE:
        raise UsageError(
            f"{names} do not tell the excitations apart at once; there is no state space against them",
            kind="dependent-inputs",
        )
    back = np.linalg.solve(G, np.eye(len(G)))
    closed = A - B @ back @ Q
    # P_(r-1) = B G^-1 e_i, P_(k-1) = (A - B G^-1 Q) P_k: then S P = 1, and w follows no derivative of m.
    S, chains = [], []
    for number, chain in enumerate(followed):
        column = B @ back[:, number]
        own = []
        for _ in chain.chain:
            own.append(column)
            column = closed @ column
        S += chain.chain
        chains.append(own[::-1])
    P = np.array([column for own in chains for column in own]).reshape(len(S), len(A)).T
    N = _null_space(np.array(S).reshape(len(S), len(A)))
    L = np.linalg.solve(np.hstack([N, P]), np.eye(len(A)))[: N.shape[1]]
    # What m itself does, as the start of a chain or, where excitations show in it at once, through G^-1.
    first = np.array([own[0] if own else np.zeros(len(A)) for own in chains]).T.reshape(len(A), len(G))
    at_once = np.array([not own for own in chains])
    drive = closed @ first + (B @ back) * at_once
    shown = outputs.C - outputs.D @ back @ Q
    direct = shown @ first + (outputs.D @ back) * at_once
    _refuse_rates(outputs, shown, back, chains, names, read)
    return balanced(LinearSystem(L @ closed @ N, L @ drive, shown @ N, direct))[0]


def balanced(*systems: LinearSystem) -> list[LinearSystem]:
    """Systems with the same states, in units of these in which rows and columns of A are of one size."""
    from scipy.linalg import matrix_balance

    with np.errstate(invalid="ignore"):  # it makes integers of the scales, too, and some are beyond these
        _, (scale, _) = matrix_balance(systems[0].A, permute=False, separate=True)
    return [
        LinearSystem(own.A / scale[:, None] * scale, own.B / scale[:, None], own.C * scale, own.D) for own in systems
    ]


@dataclass(frozen=True)
class _Followed:
    """Derivatives of a measured input: those of the states alone, and the first that excitations drive at once."""

    chain: list[FloatArray]
    states: FloatArray
    drive: FloatArray


def _until_driven(A: FloatArray, B: FloatArray, row: FloatArray, direct: FloatArray, names: str) -> _Followed:
    chain: list[FloatArray] = []
    size = np.abs(row)
    drive, scale = direct, np.abs(direct)
    for _ in range(len(A) + 1):
        if np.any(np.abs(drive) > NEGLIGIBLE * np.maximum(scale, 1e-300)):
            return _Followed(chain, row, drive)
        chain.append(row)
        drive, scale = row @ B, size @ np.abs(B)
        row, size = row @ A, size @ np.abs(A)
    raise UsageError(
        f"{names} stay zero under the excitations at every frequency; they cannot be measured inputs",
        kind="zero-reading",
    )


def _null_space(S: FloatArray) -> FloatArray:
    """Basis (n_x, n) of the states that S leaves zero, each with one state of its own: those that S tells least."""
    from scipy.linalg import qr

    if not len(S):
        return np.eye(S.shape[1])
    # Rows of S, derivatives of one reading, differ in size by many decades.
    _, R, order = qr(S / np.linalg.norm(S, axis=1, keepdims=True), mode="economic", pivoting=True)
    told, free = order[: len(S)], order[len(S) :]
    N = np.zeros((S.shape[1], len(free)))
    N[free] = np.eye(len(free))
    N[told] = -np.linalg.solve(R[:, : len(S)], R[:, len(S) :])
    return N


def _refuse_rates(
    outputs: LinearSystem,
    shown: FloatArray,
    back: FloatArray,
    chains: Sequence[Sequence[FloatArray]],
    names: str,
    read: Sequence[str],
) -> None:
    """Refuse outputs in which derivatives of a measured input are left, as of an acceleration against an angle."""
    for number, own in enumerate(chains):
        rates = [(shown @ column, np.abs(shown) @ np.abs(column)) for column in own[1:]]
        if own:
            rates.append((outputs.D @ back[:, number], np.abs(outputs.D) @ np.abs(back[:, number])))
        for rate, size in rates:
            for place in np.flatnonzero(np.abs(rate) > NEGLIGIBLE * np.maximum(size, 1e-300)).tolist():
                raise UsageError(
                    f"{read[place]}/{names} contains the rate of change of the measured input; it has a frequency "
                    "response but no state space",
                    kind="unsupported-law",
                )


def _rounded_rate(request: TransferRequest) -> float:
    """Size in rad/s that poles at rest may have by rounding, as stiffnesses cancel in what turns freely.

    k/J is omega^2, and of two poles at 0 the rounding of it is the square; without inertia k/c is a rate itself.
    """
    rows = request.assembly.system
    stiffest = float(np.abs(rows.stiffness).max(initial=0.0))
    for law, power in ((rows.inertia, 2), (rows.damping, 1)):
        if len(acting := law[law > 0]):
            return float((ROUNDED * stiffest / acting.max()) ** (1 / power))
    return 0.0


def warn_of_lost_digits(system: LinearSystem, request: TransferRequest, whole: LinearSystem) -> None:
    """Warn where the state space differs from the response solved along the graph, up to its fastest pole.

    ``whole`` is the system that it was made of, to whose size its numbers are rounded.
    """
    from scipy.linalg import eig

    if not len(system.A):
        return
    # A change dA moves a pole by |dA| / |y^H x|, with its vectors of unit length: what that reaches may be 0.
    solved: Any = eig(balanced(system)[0].A, left=True)
    poles, left, right = solved
    rounded = ROUNDED * np.linalg.norm(balanced(whole)[0].A)
    rates = np.abs(poles)[np.abs(poles * (left.conj() * right).sum(axis=0)) > rounded]
    rates = rates[rates > _rounded_rate(request)]
    if not len(rates):
        return
    # A tenth of the slowest pole, where springs or rigid bodies rule, and beside the fastest, which may be undamped.
    omega = np.geomspace(rates.min() / 10, rates.max() * 1.01, CHECKED)
    expected = transfer_functions(request, law_stiffness([request.assembly.system], omega)).values
    difference = np.array([system.response(1j * rate) for rate in omega]) - expected
    # Of the response there: far above resonances it may be small beside its peak, and still asked for.
    # On an undamped pole it is infinite, in either form.
    told = np.isfinite(expected) & (expected != 0)
    error = np.divide(np.abs(difference), np.abs(expected), out=np.zeros(difference.shape), where=told)
    lost = ~(error <= TOLD_ERROR)
    if lost.any():
        f = omega[lost.any(axis=(1, 2))] / (2 * np.pi)
        _, read, driven = np.unravel_index(np.argmax(error), error.shape)
        text = f"{request.outputs[read].name}/{request.inputs[driven].name} has lost digits"
        at_worst = f"from {f[0]:.3g} to {f[-1]:.3g} Hz, at worst {error.max():.0e} of the response there"
        warn_user(f"the state space of {text} {at_worst}; frequency_response has them")


def warn_of_hidden_poles(system: LinearSystem, names: str) -> None:
    """Warn of poles of the state space that none of its outputs shows, or none of its inputs drives."""
    poles, right = np.linalg.eig(system.A)
    left = np.linalg.pinv(right)
    # The condition of a pole: shares in repeated ones cannot be told apart.
    clear = np.linalg.norm(left, axis=1) * np.linalg.norm(right, axis=0) < CLEAR
    seen = np.abs(system.C @ right) / np.maximum(np.abs(system.C) @ np.abs(right), 1e-300)
    driven = np.abs(left @ system.B) / np.maximum(np.abs(left) @ np.abs(system.B), 1e-300)
    hidden = {
        "no output shows": seen.max(axis=0, initial=0.0) < HIDDEN,
        "no input drives": driven.max(axis=1, initial=0.0) < HIDDEN,
    }
    for why, there in hidden.items():
        told = [_pole_text(pole) for pole in poles[clear & there & (poles.imag >= 0)].tolist()]
        if told:
            warn_user(f"the state space of {names} has poles that {why}: {', '.join(told)}")


def _pole_text(pole: complex) -> str:
    rate = abs(pole)
    if not pole.imag:
        return f"{pole.real:.4g} 1/s"
    return f"{rate / (2 * np.pi):.4g} Hz with a damping ratio of {-100 * pole.real / rate:.3g} %"
