"""Criteria of mode shapes (MAC, MSF, MPC), and the complex mode indicator function of frequency responses."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray, powers_of


def mac(first: ArrayLike, second: ArrayLike) -> FloatArray:
    """Modal assurance criterion ``|a^H b|^2 / (a^H a  b^H b)`` of every pair of shapes, (n_first, n_second).

    Parameters
    ----------
    first, second : (n_sensors, n_modes) or (n_sensors,) arrays
        Shapes at the same sensors. Rows in which either has a nan, such as nodes that are not part of a cut system,
        are left out.

    Returns
    -------
    (n_first, n_second) array
        1 for shapes that are proportional, 0 for orthogonal ones; nan for a shape of zeros. With one sensor the
        MAC is always 1 and says nothing.

    References
    ----------
    Allemang and Brown, A correlation coefficient for modal vector analysis, IMAC 1982.

    Examples
    --------
    >>> mac([[1, 1], [1, -1]], [1, 1j]).round(12).tolist()
    [[0.5], [0.5]]
    """
    a, b = _pair(first, second)
    common = np.abs(a.conj().T @ b) ** 2
    sizes = [np.sum(np.abs(shape) ** 2, axis=0) for shape in (a, b)]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(common / np.outer(*sizes))


def msf(first: ArrayLike, second: ArrayLike) -> ComplexArray:
    """Modal scale factor of each shape, complex, (n_modes,), which brings ``first`` closest to ``second``.

    Parameters
    ----------
    first, second : (n_sensors, n_modes) or (n_sensors,) arrays

    Returns
    -------
    (n_modes,) complex array
        ``a^H b / a^H a``.

    Examples
    --------
    >>> msf([1, 2j], [-2, -4j]).tolist()
    [(-2+0j)]
    """
    a, b = _pair(first, second)
    if a.shape != b.shape:
        raise UsageError(f"scale factors need as many shapes on both sides, got {a.shape[1]} and {b.shape[1]}")
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.sum(a.conj() * b, axis=0) / np.sum(np.abs(a) ** 2, axis=0))


def mpc(shapes: ArrayLike) -> FloatArray:
    """Modal phase collinearity of each shape, (n_modes,), 1 where all sensors move in phase or against each other.

    ``((Sxx - Syy)^2 + 4 Sxy^2) / (Sxx + Syy)^2`` with the sums of squares and products of real and imaginary parts
    (Pappa, Elliott and Schenk 1993). Low values mean much non-proportional damping, a poor fit, or two modes in one.

    Parameters
    ----------
    shapes : (n_sensors, n_modes) or (n_sensors,) array

    Examples
    --------
    >>> mpc([[1, 1], [-2, 1j]]).tolist()
    [1.0, 0.0]
    """
    given = _shapes(shapes)
    x, y = given.real, given.imag
    # Of the eigenvalues l_1, l_2 of [[sxx, sxy], [sxy, syy]] it is ((l_1 - l_2)/(l_1 + l_2))^2.
    sxx, syy, sxy = np.nansum(x * x, axis=0), np.nansum(y * y, axis=0), np.nansum(x * y, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(((sxx - syy) ** 2 + 4 * sxy**2) / (sxx + syy) ** 2)


def cmif(response: FrequencyResponse) -> FloatArray:
    """Complex mode indicator function, singular values of the transfer functions at every frequency, (n_f, n_curves).

    Parameters
    ----------
    response : FrequencyResponse
        Outputs of unlike quantities are compared after each transfer function is divided by its root mean square.

    Returns
    -------
    (n_f, min(n_out, n_in)) array
        In the unit of the responses, largest first. Each curve has peaks at modes; two curves with a peak at one
        frequency are two modes there. (Shih et al. 1988 define it with the squares of these.)

    Examples
    --------
    >>> import torsionnet as tn
    >>> response = tn.load("dmf_rig").frequency_response("theta_1", "T_M", [1, 7, 20])
    >>> bool(np.allclose(cmif(response)[:, 0], response.magnitude[:, 0, 0]))
    True
    """
    values = response.values
    units = {(channel.unit, into.unit) for channel in response.outputs for into in response.inputs}
    if len(units) > 1:
        powers_of(response.outputs, response.inputs)
        # With unlike units the larger numbers would rule the singular values: each transfer function over its size.
        size = np.sqrt(np.nanmean(np.abs(values) ** 2, axis=0))
        values = values / np.where(size > 0, size, 1)
    found = np.full((len(values), min(values.shape[1:])), np.nan)
    finite = np.isfinite(values).all(axis=(1, 2))
    found[finite] = np.linalg.svd(values[finite], compute_uv=False)
    return found


def _shapes(given: ArrayLike) -> ComplexArray:
    values = np.asarray(given, dtype=complex)
    if values.ndim == 1:
        values = values[:, None]
    if values.ndim != 2 or not len(values):
        raise UsageError(f"shapes are arrays of sensors by modes, got {values.ndim} dimensions")
    return values


def _pair(first: ArrayLike, second: ArrayLike) -> tuple[ComplexArray, ComplexArray]:
    a, b = _shapes(first), _shapes(second)
    if len(a) != len(b):
        raise UsageError(f"shapes must be given at the same sensors, got {len(a)} and {len(b)}")
    known = np.isfinite(a).all(axis=1) & np.isfinite(b).all(axis=1)
    if not known.any():
        raise UsageError("there is no sensor at which both shapes are known; give shapes with a common sensor")
    return a[known], b[known]
