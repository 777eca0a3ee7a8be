"""Transfer functions between inputs, nodes and sensors of a drivetrain, also against measured inputs.

For excitations u every reading is y = L(s) q + direct u. Against measured inputs m under the same excitations the
transfer function is Y_out Y_in^-1, equations (8)-(13) and (20) of Galvagno et al. (2015) for any sensor anywhere.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.assembly.law_stiffness import LawStiffness, law_stiffness
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.assembly.system import Assembly
from torsionnet.assembly.table_range import range_notes
from torsionnet.core.errors import TorsionnetWarning, UsageError
from torsionnet.model.channels import Sensor
from torsionnet.model.checks.structure import rigid_motions
from torsionnet.model.motion_balance.operating_notes import law_notes
from torsionnet.response import FrequencyResponse
from torsionnet.solve.dynamic_stiffness.quotient import METHODS, transfer_functions
from torsionnet.solve.dynamic_stiffness.transfer_request import TransferRequest, cached_request
from torsionnet.solve.modes.modes import modes_against
from torsionnet.solve.responses.uncertain import refine_uncertain_points

if TYPE_CHECKING:
    from torsionnet.solve.responses.grid import Adaptive

VANISHING_INPUT_RATIO = 1e-10
"""Ratio of a measured input to the sum of its terms' magnitudes below which a warning says that it all but vanishes."""


def frequency_response(
    drivetrain: AssembledModel,
    output: str | Sensor | Sequence[str | Sensor],
    input: str | Sensor | Sequence[str | Sensor],
    frequencies: ArrayLike | Adaptive,
    *,
    excitation: str | Sequence[str] | None = None,
    method: str = "auto",
) -> FrequencyResponse:
    """Frequency response in SI units between inputs and outputs of a drivetrain.

    See :meth:`torsionnet.Drivetrain.frequency_response`.
    """
    known_method(method)
    request = cached_request(drivetrain, output, input, excitation)
    f = chosen_frequencies(drivetrain, frequencies, request)
    values, conditioning = responses([drivetrain], request, f, method)
    warn_infinite(values, conditioning, f)
    return FrequencyResponse(
        frequencies=f,
        values=values[0],
        outputs=tuple(reading.channel for reading in request.outputs),
        inputs=tuple(reading.channel for reading in request.measured),
        title=drivetrain.title,
        conditioning=conditioning[0] if request.is_measured else None,
        notes=(*request.notes, *law_notes(drivetrain.definition), *range_notes(drivetrain.assembly, f)),
    )


def known_method(method: str) -> None:
    """Raise UsageError for the name of a solver method that does not exist."""
    if method not in METHODS:
        raise UsageError(f'no method is named "{method}"; choose {", ".join(METHODS)}')


def chosen_frequencies(
    drivetrain: AssembledModel, frequencies: ArrayLike | Adaptive, request: TransferRequest
) -> FloatArray:
    """Frequencies (n_f,) in Hz of a request, as given, or as an adaptive range resolves them."""
    if isinstance(frequencies, np.ndarray):
        return _checked(frequencies)
    from torsionnet.solve.responses.grid import Adaptive

    return _resolving(drivetrain, frequencies, request) if isinstance(frequencies, Adaptive) else _checked(frequencies)


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
    found = Evaluated(np.empty((*shape, len(request.outputs), len(request.measured)), dtype=complex), np.ones(shape))
    if moving.any():
        found.values[:, moving], found.conditioning[:, moving] = evaluate(assemblies, request, f[moving], method)
    for number, drivetrain in enumerate(drivetrains):
        found.values[number, ~moving] = _static(drivetrain, request, method)
    return found


def _static(drivetrain: AssembledModel, request: TransferRequest, method: str) -> ComplexArray:
    """Transfer functions (n_out, n_in) in SI units at 0 Hz, static if finite and certain, else as a limit."""
    if not rigid_motions(drivetrain.assembly.kinematics):
        found = transfer_functions(request, law_stiffness([drivetrain.assembly.system], np.zeros(1)), method)
        if np.isfinite(found.values).all() and not found.uncertain[0]:
            return np.asarray(found.values[0])
    from torsionnet.solve.responses.zero import at_zero

    return at_zero(drivetrain, request)


def _resolving(drivetrain: AssembledModel, wanted: Adaptive, request: TransferRequest) -> FloatArray:
    """Frequencies (n_f,) in Hz that resolve the peaks of a drivetrain and the poles against a measured input."""
    found = [modes_against(drivetrain, None)]
    if request.is_measured and len(request.measured) == 1:
        found.append(modes_against(drivetrain, request))
    return wanted.frequencies(*found)


def _checked(frequencies: ArrayLike) -> FloatArray:
    try:
        f = np.atleast_1d(np.asarray(frequencies, dtype=float))
    except (TypeError, ValueError):
        f = np.array([np.nan])
    if f.ndim != 1 or not np.isfinite(f).all() or (f < 0).any():
        raise UsageError("frequencies must be a list of finite numbers >= 0, in Hz")
    return f


def evaluate(
    assemblies: Sequence[Assembly], request: TransferRequest, frequencies: FloatArray, method: str = "auto"
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
    """
    kappa = law_stiffness([assembly.system for assembly in assemblies], 2 * np.pi * frequencies)
    return evaluate_laws(kappa, assemblies, request, frequencies, method)


def evaluate_laws(
    kappa: LawStiffness,
    assemblies: Sequence[Assembly],
    request: TransferRequest,
    frequencies: FloatArray,
    method: str = "auto",
) -> Evaluated:
    """Transfer functions (n_variants, n_f, n_out, n_in) in SI units for given dynamic stiffnesses of the laws.

    Assemblies are used for uncertain points.
    """
    found = transfer_functions(request, kappa, method)
    if method != "dense":
        found = refine_uncertain_points(assemblies, request, frequencies, kappa, found, method)
    shape = (len(assemblies), frequencies.shape[-1])
    if request.is_measured:
        _warn_poor(found.conditioning, request, np.broadcast_to(frequencies, shape).ravel())
    return Evaluated(found.values.reshape(*shape, *found.values.shape[1:]), found.conditioning.reshape(shape))


def _warn_poor(conditioning: FloatArray, request: TransferRequest, frequencies: FloatArray) -> None:
    poor = np.flatnonzero(conditioning < VANISHING_INPUT_RATIO)
    if len(poor):
        names = ", ".join(reading.name for reading in request.measured)
        where = f"{len(poor)} frequencies, the first {frequencies[poor[0]]:.6g} Hz"
        text = f"{names}: the measured input all but vanishes at {where}"
        warnings.warn(text, TorsionnetWarning, stacklevel=5)


def warn_infinite(values: ComplexArray, conditioning: FloatArray, f: FloatArray) -> None:
    """Warn of infinite responses where rounding of a vanishing measured input does not explain them."""
    finite = np.isfinite(values).all(axis=(2, 3))
    if finite.all():
        return
    for points, where in (
        (f == 0, "at 0 Hz: the drivetrain turns freely"),
        ((f > 0) & (conditioning >= VANISHING_INPUT_RATIO), "at a frequency above 0"),
    ):
        if (points & ~finite).any():
            warnings.warn(f"the response is infinite {where}", TorsionnetWarning, stacklevel=4)
