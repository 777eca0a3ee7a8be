"""Base class of test signals, the excitations of a test bench."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import UsageError

FloatArray = NDArray[np.float64]

POINTS_PER_CYCLE = 2.0
"""Number of samples per cycle of the highest frequency that a sampling rate must exceed, by the sampling theorem."""


@dataclass(frozen=True, kw_only=True)
class Excitation(ABC, Declared):
    """Test signal of finite length around a mean value, such as the torque that excites a drivetrain in a test.

    Attributes
    ----------
    amplitude : float
        Peak of the alternating part, in the unit of the input: N m for a torque.
    mean : float
        Mean value, added throughout.
    """

    kind: ClassVar[str] = ""

    # The default amplitude of 1 N m is of use in Python only: a file has to state the amplitude of its test.
    amplitude: float = entry(Value("peak of the alternating torque", "torque"), 1.0, must=True)
    mean: float = entry(Value("torque added throughout; the test begins in its equilibrium", "torque", lower=None), 0.0)

    def __post_init__(self) -> None:
        faults = [
            f"{name} must be a positive number, got {value!r}"
            for name in (declared.name for declared in fields(self))
            if name != "mean" and isinstance(value := getattr(self, name), int | float)
            if not (np.isfinite(value) and (value > 0 or (value == 0 and name in self._may_be_zero)))
        ]
        if not np.isfinite(self.mean):
            faults.append(f"mean must be a number, got {self.mean!r}")
        faults += self._contradictions() if not faults else []
        if faults:
            raise UsageError(f"{self.kind}: {'; '.join(faults)}")

    common: ClassVar[tuple[str, ...]] = ("amplitude", "mean")
    _may_be_zero: ClassVar[tuple[str, ...]] = ("seed",)

    def _contradictions(self) -> list[str]:
        """Errors in the combination of a test signal's values that are valid one by one, as text."""
        return []

    @property
    @abstractmethod
    def length(self) -> float:
        """Duration of the test signal in s."""

    @property
    @abstractmethod
    def highest_frequency(self) -> float:
        """Highest frequency in Hz that the test signal excites."""

    @abstractmethod
    def _alternating(self, time: FloatArray, sampling_rate: float) -> FloatArray:
        """Test signal without its mean at times in s, with a peak amplitude of 1, (n,)."""

    def time(self, sampling_rate: float) -> FloatArray:
        """Times in s of the test signal's samples from 0 on, (n,)."""
        return np.arange(round(self.length * sampling_rate)) / sampling_rate

    def samples(self, sampling_rate: float) -> FloatArray:
        """Samples of the test signal at ``sampling_rate`` Hz, in the unit of its amplitude, (n,).

        Raises
        ------
        UsageError
            The sampling rate is not above twice the highest frequency.
        """
        if not sampling_rate > POINTS_PER_CYCLE * self.highest_frequency:
            top = f"{self.kind} up to {self.highest_frequency:g} Hz"
            raise UsageError(f"{top} needs more than twice that rate, not {sampling_rate:g} Hz")
        return self.mean + self.amplitude * self._alternating(self.time(sampling_rate), sampling_rate)
