"""Residuals between prediction and test as complex numbers, log magnitude and phase, or log magnitude alone.

Errors are small against the values, so the error of log(prediction / test) is the relative error of the line.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray

Form: TypeAlias = str
FORMS = ("complex", "log", "magnitude")
"""Names of the forms of residuals (difference of complex values, of log magnitude and phase, of log magnitude
alone)."""


def parts(values: ComplexArray | FloatArray) -> FloatArray:
    """Real parts of complex values, then their imaginary parts, as one real array (2 n, ...)."""
    return np.concatenate([values.real, values.imag])


def residuals_in_form(
    form: Form, predicted: ComplexArray, slopes: ComplexArray, measured: ComplexArray
) -> tuple[FloatArray, FloatArray]:
    """Residuals between prediction and test as real numbers in a form, and their derivatives (n_residuals, n_p)."""
    if form == "complex":
        return parts(predicted - measured), parts(slopes)
    with np.errstate(
        divide="ignore", invalid="ignore"
    ):  # a gain of 0 gives an infinite residual, and the search takes a smaller step
        ratio, relative = np.log(predicted / measured), slopes / predicted[:, None]
    return (ratio.real, relative.real) if form == "magnitude" else (parts(ratio), parts(relative))


def errors_in_form(form: Form, errors: FloatArray, measured: ComplexArray) -> FloatArray:
    """Small errors of a response's real and imaginary parts (2 n, k) as errors of residuals in a form, (.., k)."""
    if form == "complex":
        return errors
    count = len(measured)
    relative = (errors[:count] + 1j * errors[count:]) / measured[:, None]
    return np.asarray(relative.real) if form == "magnitude" else parts(relative)


def covariance_in_form(form: Form, covariance: FloatArray, measured: ComplexArray) -> FloatArray:
    """Covariance of the residuals in a form, from that of a response's real and imaginary parts (2 n, 2 n)."""
    return errors_in_form(form, errors_in_form(form, covariance, measured).T, measured)
