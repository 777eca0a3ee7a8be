"""Transfer functions in the limit of zero frequency, also where the drivetrain turns freely.

There the static stiffness is singular while ratios of readings may still have a finite limit. The readings are
evaluated at two very small real s with many digits, which tells a finite limit from one that grows without bound.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, smallest_rate
from torsionnet.linear.dynamic_stiffness.many_digits import ManyDigits
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest

LIMIT_DIGITS = 400
"""Decimal digits for limits at 0 Hz, enough for several measured inputs at s of 10^-25 to its fifth power and more."""
LIMIT_POWER = 25
"""Power of ten by which s for a limit lies below the slowest rate, where several inputs may differ by its fifth
power."""


def at_zero(drivetrain: AssembledModel, request: TransferRequest) -> ComplexArray:
    """Limits (n_out, n_in) of the transfer functions in SI units for s -> 0, inf where there is none.

    Raises
    ------
    UsageError
        The measured inputs depend on each other whatever s.
    """
    import mpmath

    assembly = drivetrain.assembly
    with mpmath.workdps(LIMIT_DIGITS):
        rate = mpmath.mpf(smallest_rate(assembly.system))
        asked = ManyDigits(assembly, request)
        # Two values of s a factor of ten apart show which power of s the response goes with.
        first, second = (asked.transfer(rate * mpmath.mpf(10) ** -power) for power in (LIMIT_POWER, LIMIT_POWER + 1))
        if first is not None and second is not None:
            pairs = (zip(*rows, strict=True) for rows in zip(first, second, strict=True))
            return np.array([[_limit(*pair) for pair in row] for row in pairs])
        # Another s, off the axis, tells whether the inputs depend on each other at every one.
        if asked.transfer(rate * mpmath.mpc(1, 1)) is None:
            raise request.dependent_inputs_error()
    return np.full((len(request.outputs), len(request.inputs)), complex(np.inf))


def _limit(first: Any, second: Any) -> complex:
    """Limit of a response for s -> 0, judged from values at s and s / 10.

    Ten times larger is a pole, ten times smaller a zero.
    """
    if abs(second) > 5 * abs(first):
        return complex(np.inf, 0.0)
    return 0j if abs(second) < abs(first) / 5 else complex(second)
