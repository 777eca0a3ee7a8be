"""Mean response of a drivetrain to the mean torques of running machinery, over speed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.packages import NotebookResult
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import Channel, FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class MeanResponse(NotebookResult):
    """Mean values of outputs (torques, twists, stresses) in SI units over speed, shape (n_speeds, n_out).

    Attributes
    ----------
    speeds : (n_speeds,) array
        Speeds of the reference shaft, rad/s.
    reference : str
        Node of the reference shaft.
    values : (n_speeds, n_out) array
        Mean values, SI.
    outputs : tuple of Channel
    title : str
        Name of the model with its configuration.
    notes : tuple of str
        Remarks on what the values are based on.
    """

    speeds: FloatArray
    reference: str
    values: FloatArray
    outputs: tuple[Channel, ...]
    title: str = ""
    notes: tuple[str, ...] = ()

    @property
    def rpm(self) -> FloatArray:
        """Speeds of the reference shaft in r/min, shape (n_speeds,)."""
        return np.asarray(self.speeds * RPM)

    def of(self, output: str) -> FloatArray:
        """Mean values of an output in SI units over speed, shape (n_speeds,).

        Raises
        ------
        UsageError
            There is no such output.
        """
        names = [channel.name for channel in self.outputs]
        if output not in names:
            raise UsageError(
                f'no output is named "{output}"{did_you_mean(output, names)}; there are {", ".join(names)}'
            )
        return np.asarray(self.values[:, names.index(output)])

    def table(self, conventions: Conventions = SI) -> Table:
        """Table of mean values with a row for each speed in rpm and a column for each output."""
        columns = [Column("speed", "rpm")]
        columns += [Column(channel.name, conventions.unit(channel.unit)) for channel in self.outputs]
        scales = np.array([conventions.scale(channel.unit) for channel in self.outputs])
        rows = zip(self.rpm.tolist(), (self.values * scales).tolist(), strict=True)
        notes = (f"mean values; speeds of {self.reference}", *self.notes)
        return Table(f"{self.title}: mean values", tuple(columns), tuple((rpm, *row) for rpm, row in rows), notes)
