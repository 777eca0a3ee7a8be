"""Pulses of a toothed wheel with the tooth of each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.recording import FloatArray


@dataclass(frozen=True, eq=False)
class NumberedPulses:
    """Pulses of a toothed wheel, repaired, with a number for each that counts its teeth on from turn to turn.

    Attributes
    ----------
    times : (n,) array
        s.
    numbers : (n,) int array
        Tooth of each pulse, as ``numbers % teeth``, missing and lost ones counted.
    first : str
        Which tooth is 0, in words.
    known : bool
        Whether another record of the wheel has the same tooth 0.
    remarks : tuple of str
        Repairs, with their counts.
    """

    times: FloatArray
    numbers: NDArray[np.intp]
    first: str = ""
    known: bool = False
    remarks: tuple[str, ...] = ()
