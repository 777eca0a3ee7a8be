"""Mean power that the vibration of running machinery dissipates, by speed and element."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.packages import NotebookResult
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import FloatArray

FORMULA = "P = sum over frequencies of Re(T conj(dgamma/dt))/2, T the whole torque of the element, elastic and damping"


@dataclass(frozen=True, eq=False, repr=False)
class DissipatedPower(NotebookResult):
    """Mean power in W that the vibration of running machinery dissipates, by speed and element.

    Attributes
    ----------
    speeds : (n_speeds,) array
        Speeds of the reference shaft, rad/s.
    reference : str
        Node of the reference shaft.
    elements : tuple of str
    values : (n_speeds, n_elements) array
        Mean power, W.
    title : str
        Name of the model with its configuration.
    """

    speeds: FloatArray
    reference: str
    elements: tuple[str, ...]
    values: FloatArray
    title: str = ""

    @property
    def rpm(self) -> FloatArray:
        """Speeds of the reference shaft in r/min, shape (n_speeds,)."""
        return np.asarray(self.speeds * RPM)

    def of(self, element: str) -> FloatArray:
        """Mean power that an element dissipates over speed in W, shape (n_speeds,).

        Raises
        ------
        UsageError
            No power of this element was calculated.
        """
        if element not in self.elements:
            hint = did_you_mean(element, self.elements)
            raise UsageError(f'no power of "{element}"{hint}; there is {", ".join(self.elements)}')
        return np.asarray(self.values[:, self.elements.index(element)])

    def table(self) -> Table:
        """Table of dissipated power in W with a row for each speed in rpm and a column for each element."""
        columns = (Column("speed", "rpm"), *(Column(name, "W") for name in self.elements))
        rows = tuple((rpm, *row) for rpm, row in zip(self.rpm.tolist(), self.values.tolist(), strict=True))
        notes = (f"speeds of {self.reference}; {FORMULA}", "heat of a steady slip is not in it")
        return Table(f"{self.title}: dissipated power", columns, rows, notes)
