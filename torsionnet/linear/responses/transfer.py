"""Transfer functions between inputs, nodes and sensors of a drivetrain, also against measured inputs.

For excitations u every reading is y = L(s) q + direct u. Against measured inputs m under the same excitations the
transfer function is Y_out Y_in^-1, equations (8)-(13) and (20) of Galvagno et al. (2015) for any sensor anywhere.

Here as well: error estimates of uncertain frequency points, and their responses in many digits where rounding would
show.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import FreeTurningWarning, SolveError, TorsionnetWarning, UsageError, warn_user
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import LawStiffness, law_stiffness
from torsionnet.linear.assembly.rows import Assembly, ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.quotient import (
    METHODS,
    NOTHING,
    Evaluate,
    FrequencyPoints,
    rounding_errors,
    transfer_functions,
    uncertain_points,
)
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, cached_request
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.model.channels import Channels
from torsionnet.model.checks.structure import rigid_motions

if TYPE_CHECKING:
    from torsionnet.linear.dynamic_stiffness.many_digits import ManyDigits
    from torsionnet.linear.responses.grid import Adaptive

PROMISED_ERROR = 1e-9
"""Largest relative error of response values that are returned without a warning."""
ACCEPTED_ERROR = PROMISED_ERROR / 5
"""Estimated relative error up to which a value is kept, a fifth of the promised one as the estimate is statistical."""
PERTURBATIONS, PERTURBATION = 4, 8 * float(np.finfo(float).eps)
"""Number of perturbed solutions for an error estimate, and relative perturbation of the stiffnesses, a few
roundings."""
SURE_PERTURBATIONS, SURE_ERROR = 2, ACCEPTED_ERROR / 100
"""Number of perturbed solutions, one in each elimination order, and error below which a point needs no more of them."""
MOST_WORK = 20_000
"""Most laws times points that are solved in many digits for one response, which takes a few seconds."""


def refine_uncertain_points(
    assemblies: Sequence[Assembly],
    request: TransferRequest,
    frequencies: FloatArray,
    laws: LawStiffness,
    calculated: FrequencyPoints,
    method: str = "auto",
) -> FrequencyPoints:
    """Transfer functions whose uncertain points are checked, and solved in many digits where rounding shows.

    Parameters
    ----------
    assemblies : sequence of Assembly
        One for each variant.
    request : TransferRequest
    frequencies : (n_f,) or (n_variants, n_f) array
        Hz.
    laws : LawStiffness
        Of all points.
    calculated : FrequencyPoints
    method : str
        Solver by which uncertain points are estimated.

    Raises
    ------
    UsageError
        The measured inputs depend on each other at every frequency.
    """
    again = evaluation(request, method)
    rounding = rounding_errors(again, laws, calculated.values)
    points = np.flatnonzero(uncertain_points(rounding, len(laws.stiffness)))
    if not len(points):
        return calculated
    errors = expected_errors(again, laws.at(points), calculated.values[points], rounding[points])
    # The worst first, as many as time allows.
    worst = errors.max(axis=(1, 2), initial=0.0)
    order = [place for place in np.argsort(-worst, kind="stable").tolist() if worst[place] > ACCEPTED_ERROR]
    most = max(1, MOST_WORK // max(1, laws.n_laws))
    values = calculated.values.copy()
    exact = _ManyPoints(assemblies, request, frequencies)
    uncertain = [(points[place], worst[place]) for place in order[most:]]
    for place in order[:most]:
        known = exact.transfer_function(points[place])
        if known is None:
            uncertain.append((points[place], worst[place]))
        else:
            values[points[place]] = np.where(errors[place] > ACCEPTED_ERROR, known, values[points[place]])
    if uncertain:
        _warn(uncertain, exact.frequencies.ravel())
    return replace(calculated, values=values)


def evaluation(request: TransferRequest, method: str) -> Evaluate:
    """Calculation of the transfer functions of a request from laws, in either order of elimination."""
    return lambda laws, other_order: (
        transfer_functions(request, laws, method, other_order=other_order, values_alone=True).values
    )


def expected_errors(evaluate: Evaluate, laws: LawStiffness, values: ComplexArray, rounding: FloatArray) -> FloatArray:
    """Relative errors of ``values`` (n_points, ...), from solutions with stiffnesses changed by roundings.

    All stiffnesses are moved by a few roundings, with signs by chance. That shows how a value depends on them. Every
    later rounding falls out differently too, the more so in another order of elimination (``True``), which shows what
    elimination itself has lost. No error is smaller than that of ``rounding``, where it is finite: a share next to 1
    falls on the same side in most solutions.
    """
    random = np.random.default_rng(0)
    error = np.where(np.isfinite(values), np.where(np.isfinite(rounding), rounding, 0.0), np.inf)
    rows = tuple(range(1, error.ndim))
    unsure = np.arange(len(values))
    for draw in range(PERTURBATIONS):
        if draw == SURE_PERTURBATIONS:
            unsure = np.flatnonzero(error.max(axis=rows, initial=0.0) > SURE_ERROR)
        if not len(unsure):
            break
        # Equation (3.6): each stiffness moved by some roundings, up or down by chance.
        moves = PERTURBATION * random.uniform(0.5, 1, laws.n_laws) * random.choice([-1.0, 1.0], laws.n_laws)
        again = evaluate(laws.at(unsure).scaled(1 + moves), draw % 2 > 0)
        with np.errstate(all="ignore"):
            change = np.abs(again - values[unsure]) / np.maximum(np.abs(values[unsure]), NOTHING)
        change[np.isnan(change)] = np.inf
        error[unsure] = np.maximum(error[unsure], change)
    return np.asarray(error)


class _ManyPoints:
    """Transfer functions (n_out, n_in) of single frequency points of some variants, in many digits."""

    def __init__(self, assemblies: Sequence[Assembly], request: TransferRequest, frequencies: FloatArray) -> None:
        self.assemblies, self.request = assemblies, request
        self.frequencies = np.broadcast_to(frequencies, (len(assemblies), frequencies.shape[-1]))
        self.asked: dict[int, ManyDigits] = {}

    def transfer_function(self, point: int) -> ComplexArray | None:
        """Transfer functions (n_out, n_in) of a point, exact to double precision, or None if digits run out.

        Raises
        ------
        UsageError
            The measured inputs depend on each other here, and then everywhere: a frequency in Hz is no exact root.
        """
        import mpmath

        from torsionnet.linear.dynamic_stiffness.many_digits import CALCULATION_DIGITS, ManyDigits

        variant, number = divmod(point, self.frequencies.shape[1])
        with mpmath.workdps(CALCULATION_DIGITS):
            if variant not in self.asked:
                self.asked[variant] = ManyDigits(self.assemblies[variant], self.request)
            omega = 2 * mpmath.pi * mpmath.mpf(self.frequencies[variant, number])
            try:
                exact = self.asked[variant].transfer(mpmath.mpc(0, omega))
            except SolveError:
                return None
            if exact is None:
                raise self.request.dependent_inputs_error()
            return np.array([[complex(value) for value in row] for row in exact])


def _warn(uncertain: Sequence[tuple[int, float]], frequencies: FloatArray) -> None:
    point, error = max(uncertain, key=lambda pair: pair[1])
    size = f"{error:.0e} of themselves" if error < 1 else "nothing but their order of magnitude"
    text = (
        f"{len(uncertain)} values next to undamped resonances or antiresonances are rounded; "
        f"near {frequencies[point]:.6g} Hz they are known to {size}"
    )
    warn_user(text)


VANISHING_INPUT_RATIO = 1e-10
"""Ratio of a measured input to the sum of its terms' magnitudes below which a warning says that it all but vanishes."""


def frequency_response(
    drivetrain: AssembledModel,
    output: Channels,
    input: Channels,
    frequencies: ArrayLike | Adaptive,
    *,
    driven_by: str | Sequence[str] | None = None,
    method: str = "auto",
) -> FrequencyResponse:
    """Transfer functions between sensors, inputs and nodes at the given frequencies.

    Parameters
    ----------
    output : str, Sensor or sequence of these
        Names of sensors or nodes (the angle there), or ``torque(element, port)``, ``twist(element)``,
        ``velocity(node)``, ``acceleration(node)``, ``angle(node)``.
    input : str, Sensor or sequence of these
        Names of inputs or nodes (a torque there): response to an excitation. Names of sensors: a *measured*
        input, Y_out Y_in^-1 under the excitation, equations (8)-(13) and (20) of Galvagno et al. (2015).
    frequencies : (n_f,) array or Adaptive
        Hz, >= 0; or ``tn.Adaptive(start, stop)``, which resolves every peak in that range. At 0 the finite limit,
        or inf with a warning.
    driven_by : str or sequence of str, optional
        What drives the drivetrain when the input is measured; default: the model's only input.
    method : str
        ``"auto"``: elimination along the drivetrain, fast and exact; where numba is installed and the work is large
        (1000 nodes at 100 000 frequencies), in a compiled loop. ``"graph"``: always in numpy. ``"compiled"``:
        always in the compiled loop (``pip install "torsionnet[fast]"``; its start takes a second or two).
        ``"dense"``: LAPACK on the assembled matrices, as a cross-check: one value in twenty is off by more than
        1e-9 of itself, most of them far below the first natural frequency or where values span many decades.

    Returns
    -------
    FrequencyResponse
        ``values`` of shape (n_f, n_out, n_in).

    Examples
    --------
    >>> import torsionnet as tn
    >>> H = tn.load("dmf_rig").frequency_response("theta_1", "T_T", [8.116])
    >>> round(float(abs(H.values[0, 0, 0])) * 57.29578, 4)
    0.2519
    """
    known_method(method)
    request = cached_request(drivetrain, output, input, driven_by)
    f = chosen_frequencies(drivetrain, frequencies, request)
    values, conditioning = responses([drivetrain], request, f, method)
    if not np.isfinite(values).all():
        warn_infinite(values, conditioning, f)
    notes = request.notes
    if drivetrain.definition.tangents is not None:
        from torsionnet.model.operating_values import law_notes

        notes = (*notes, *law_notes(drivetrain.definition))
    if drivetrain.assembly.system.dynamic:
        from torsionnet.linear.assembly.table_range import range_notes

        # Tables over frequency that end before some of the frequencies.
        notes = (*notes, *range_notes(drivetrain.assembly, f))
    return FrequencyResponse(
        frequencies=f,
        values=values[0],
        outputs=tuple(reading.channel for reading in request.outputs),
        inputs=tuple(reading.channel for reading in request.inputs),
        title=drivetrain.title,
        conditioning=conditioning[0] if request.is_measured else None,
        notes=notes,
        model=drivetrain.name,
        configuration=drivetrain.configuration,
    )


def known_method(method: str) -> None:
    """Raise UsageError for the name of a solver method that does not exist."""
    if method not in METHODS:
        raise UsageError(f'no method is named "{method}"; choose {", ".join(METHODS)}', kind="unknown-word")


def chosen_frequencies(
    drivetrain: AssembledModel, frequencies: ArrayLike | Adaptive, request: TransferRequest
) -> FloatArray:
    """Frequencies (n_f,) in Hz of a request, as given, or as an adaptive range resolves them."""
    if not isinstance(frequencies, np.ndarray):
        from torsionnet.linear.responses.grid import Adaptive

        if isinstance(frequencies, Adaptive):
            return _resolving(drivetrain, frequencies, request)
    try:
        f = np.atleast_1d(np.asarray(frequencies, dtype=float))
    except (TypeError, ValueError):
        f = np.array([np.nan])
    if f.ndim != 1 or not np.isfinite(f).all() or (f < 0).any():
        raise UsageError("frequencies must be a list of finite numbers >= 0, in Hz", kind="not-finite")
    return f


class Evaluated(NamedTuple):
    """Transfer functions (n_variants, n_f, n_out, n_in), and conditioning (n_variants, n_f) of measured inputs."""

    values: ComplexArray
    conditioning: FloatArray


def responses(drivetrains: Sequence[AssembledModel], request: TransferRequest, f: FloatArray, method: str) -> Evaluated:
    """Transfer functions (n, n_f, n_out, n_in) in SI units of n drivetrains with the same rows at f >= 0 in Hz."""
    assemblies, moving = [drivetrain.assembly for drivetrain in drivetrains], f > 0
    if moving.all():
        return evaluate(assemblies, request, f, method)
    shape = (len(drivetrains), len(f))
    evaluated = Evaluated(np.empty((*shape, len(request.outputs), len(request.inputs)), dtype=complex), np.ones(shape))
    # At 0 Hz a response is a limit, and found for itself.
    if moving.any():
        evaluated.values[:, moving], evaluated.conditioning[:, moving] = evaluate(
            assemblies, request, f[moving], method
        )
    for number, drivetrain in enumerate(drivetrains):
        evaluated.values[number, ~moving] = _static(drivetrain, request, method)
    return evaluated


def _static(drivetrain: AssembledModel, request: TransferRequest, method: str) -> ComplexArray:
    """Transfer functions (n_out, n_in) in SI units at 0 Hz, static if finite and certain, else as a limit."""
    if not rigid_motions(drivetrain.assembly.kinematics):
        laws, again = law_stiffness([drivetrain.assembly.system], np.zeros(1)), evaluation(request, method)
        values = again(laws, False)
        if not uncertain_points(rounding_errors(again, laws, values), 1).any():
            return np.asarray(values[0])
    from torsionnet.linear.responses.zero import at_zero

    return at_zero(drivetrain, request)


def _resolving(drivetrain: AssembledModel, wanted: Adaptive, request: TransferRequest) -> FloatArray:
    """Frequencies (n_f,) in Hz that resolve the peaks of a drivetrain and the poles against a measured input."""
    from torsionnet.linear.modes.natural_modes import modes_against

    modes = [modes_against(drivetrain, None)]
    if request.is_measured and len(request.inputs) == 1:
        modes.append(modes_against(drivetrain, request))
    return wanted.frequencies(*modes)


def evaluate(
    assemblies: Sequence[Assembly],
    request: TransferRequest,
    frequencies: FloatArray,
    method: str = "auto",
    laws: LawStiffness | None = None,
) -> Evaluated:
    """Transfer functions (n_variants, n_f, n_out, n_in) in SI units at frequencies > 0, with conditioning.

    Parameters
    ----------
    assemblies : sequence of Assembly
        Variants with the same rows.
    request : TransferRequest
    frequencies : (n_f,) or (n_variants, n_f) array
        Hz.
    method : str
    laws : LawStiffness, optional
        Dynamic stiffnesses of the laws where they are known; assemblies then only serve uncertain points.
    """
    if laws is None:
        laws = law_stiffness([assembly.system for assembly in assemblies], 2 * np.pi * frequencies)
    calculated = transfer_functions(request, laws, method)
    if method != "dense":
        calculated = refine_uncertain_points(assemblies, request, frequencies, laws, calculated, method)
    shape = (len(assemblies), frequencies.shape[-1])
    poor = np.flatnonzero(calculated.conditioning < VANISHING_INPUT_RATIO)
    if request.is_measured and len(poor):
        names = ", ".join(reading.name for reading in request.inputs)
        first = np.broadcast_to(frequencies, shape).ravel()[poor[0]]
        text = f"{names}: the measured input all but vanishes at {len(poor)} frequencies, the first {first:.6g} Hz"
        warn_user(text)
    return Evaluated(
        calculated.values.reshape(*shape, *calculated.values.shape[1:]), calculated.conditioning.reshape(shape)
    )


def warn_infinite(values: ComplexArray, conditioning: FloatArray, f: FloatArray) -> None:
    """Warn of infinite responses where rounding of a vanishing measured input does not explain them."""
    finite = np.isfinite(values).all(axis=(2, 3))
    for points, where, kind in (
        (f == 0, "at 0 Hz: the drivetrain turns freely", FreeTurningWarning),
        ((f > 0) & (conditioning >= VANISHING_INPUT_RATIO), "at a frequency above 0", TorsionnetWarning),
    ):
        if (points & ~finite).any():
            warn_user(f"the response is infinite {where}", kind)
