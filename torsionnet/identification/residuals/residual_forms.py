"""Residuals between prediction and test as complex numbers, log magnitude and phase, or log magnitude alone.

Errors are small against the values, so the error of log(prediction / test) is the relative error of the line.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from torsionnet.assembly.rows import ComplexArray, FloatArray

Form: TypeAlias = str
FORMS = ("complex", "log", "magnitude")
"""Names of the forms that residuals between prediction and test can have."""


def parts(values: ComplexArray | FloatArray) -> FloatArray:
    """Real parts of complex values, then imaginary parts, (2 n, ...)."""
    return np.concatenate([values.real, values.imag])


def residuals_in_form(
    form: Form, predicted: ComplexArray, slopes: ComplexArray, measured: ComplexArray
) -> tuple[FloatArray, FloatArray]:
    """Residuals between prediction and test (n,) as real numbers in a form, and derivatives (.., n_p)."""
    if form == "complex":
        return parts(predicted - measured), parts(slopes)
    with np.errstate(
        divide="ignore", invalid="ignore"
    ):  # a gain of 0 gives an infinite residual, and the search takes a smaller step
        ratio, relative = np.log(predicted / measured), slopes / predicted[:, None]
    return (ratio.real, relative.real) if form == "magnitude" else (parts(ratio), parts(relative))


def errors_in_form(form: Form, errors: FloatArray, measured: ComplexArray) -> FloatArray:
    """Small errors of real and imaginary parts (2 n, k) converted to a form of residuals, (.., k)."""
    if form == "complex":
        return errors
    count = len(measured)
    relative = (errors[:count] + 1j * errors[count:]) / measured[:, None]
    return np.asarray(relative.real) if form == "magnitude" else parts(relative)


def covariance_in_form(form: Form, covariance: FloatArray, measured: ComplexArray) -> FloatArray:
    """Covariance (2 n, 2 n) of real and imaginary parts converted to that of residuals in a form."""
    return errors_in_form(form, errors_in_form(form, covariance, measured).T, measured)
