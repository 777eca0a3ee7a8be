"""Pitch pattern of a toothed wheel: by how much each tooth stands beyond its place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.recording import FloatArray


@dataclass(frozen=True, eq=False)
class WheelPattern:
    """Angle in rad by which the edge of each tooth stands beyond its place on a wheel of even pitch.

    Tooth 0 is the first after the gap of a wheel with missing teeth, else the one named in ``first``. A pulse of
    tooth k comes at the wheel's angle 2 pi k/teeth + positions[k], teeth that are missing included.

    Attributes
    ----------
    positions : (teeth,) array
        rad, of mean 0; of missing teeth 0.
    half_widths : (teeth,) array
        Half width of the 95 % interval of each position, rad.
    missing : int
        Teeth that the gap lacks, the last ones of a turn.
    name : str
        Wheel, with machine and date.
    first : str
        Which tooth is 0, in words.
    unresolved : tuple of int
        Whole orders whose share of the pattern the calibration could not tell from vibration.
    notes : tuple of str
        From which records, by which method.
    reversed : bool
        Whether it was calibrated while the wheel turned against the sense of the model: a pickup then sees the other
        edges of the teeth, in the other sequence.

    Raises
    ------
    UsageError
        There are fewer than two teeth, or the two arrays differ in length.

    Examples
    --------
    >>> wheel = WheelPattern(np.radians(0.05) * np.cos(2 * np.pi * np.arange(60) / 60), np.zeros(60))
    >>> float(np.degrees(abs(wheel.order(1))).round(6)), wheel.teeth
    (0.05, 60)
    """

    positions: FloatArray
    half_widths: FloatArray
    missing: int = 0
    name: str = ""
    first: str = ""
    unresolved: tuple[int, ...] = ()
    notes: tuple[str, ...] = ()
    reversed: bool = False

    def __post_init__(self) -> None:
        if len(self.positions) < 2 or len(self.positions) != len(self.half_widths):
            raise UsageError("a pattern has a position and a half width for each tooth, two teeth or more")

    @property
    def teeth(self) -> int:
        """Number of teeth of the wheel, missing ones included."""
        return len(self.positions)

    def order(self, order: int) -> complex:
        """Complex peak amplitude in rad that the pattern adds to a whole order of the angle, X of Re X exp(j o phi).

        An edge that stands beyond its place comes late, so the angle read there is too small: X is minus the
        amplitude of the positions.
        """
        turning = np.exp(-2j * np.pi * order * np.arange(self.teeth) / self.teeth)
        lines: ComplexArray = self.positions * turning
        mean = complex(lines.mean())
        if order % self.teeth in (0, self.teeth / 2):
            return complex(-mean.real, 0)  # real but for rounding, which would be read as a phase
        return -2 * mean
