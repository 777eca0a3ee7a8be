"""How a predicted line is held against a measured one: complex, by log magnitude and phase, or by magnitude alone.

Errors are small against the values, so those of log(prediction / test) are those of the line over its value.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from torsionnet.assembly.rows import ComplexArray, FloatArray

Form: TypeAlias = str
FORMS = ("complex", "log", "magnitude")


def parts(values: ComplexArray | FloatArray) -> FloatArray:
    """Real parts, then imaginary parts, (2 n, ...)."""
    return np.concatenate([values.real, values.imag])


def apart(
    form: Form, predicted: ComplexArray, slopes: ComplexArray, measured: ComplexArray
) -> tuple[FloatArray, FloatArray]:
    """Prediction (n,) against test as so many real numbers as the form has, and derivatives (.., n_p)."""
    if form == "complex":
        return parts(predicted - measured), parts(slopes)
    with np.errstate(divide="ignore", invalid="ignore"):  # a gain of 0 on the way: infinitely far, and the step shrinks
        ratio, relative = np.log(predicted / measured), slopes / predicted[:, None]
    return (ratio.real, relative.real) if form == "magnitude" else (parts(ratio), parts(relative))


def of_errors(form: Form, errors: FloatArray, measured: ComplexArray) -> FloatArray:
    """What small errors of real and imaginary parts (2 n, k) are in a form, (.., k)."""
    if form == "complex":
        return errors
    count = len(measured)
    relative = (errors[:count] + 1j * errors[count:]) / measured[:, None]
    return np.asarray(relative.real) if form == "magnitude" else parts(relative)


def of_covariance(form: Form, covariance: FloatArray, measured: ComplexArray) -> FloatArray:
    """The same of a covariance (2 n, 2 n)."""
    return of_errors(form, of_errors(form, covariance, measured).T, measured)
