"""Natural frequencies of a drivetrain, counted from 1, with what swings against what and the nodes of vibration."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table

SECONDS_PER_MINUTE = 60.0
"""Factor from a frequency in Hz to vibrations per minute."""


@dataclass(frozen=True)
class CountedVibration:
    """Vibration with its number, undamped and damped natural frequency in Hz, damping ratio, nodes and what swings.

    Attributes
    ----------
    mode : int
        Number as in every other table: 1 is the lowest vibration.
    undamped_frequency, natural_frequency : float
        Hz, without damping and with it (``|lambda|/2pi``); nan where the mode exists only one way.
    damping_ratio : float
    n_nodes : int or None
        Number of nodes of vibration; None where an element ties three shafts, or has nodes inside.
    nodes : tuple of str
        Elements with these nodes in words, such as "in intermediate".
    against : str
        Masses with most of the kinetic energy in either sense of rotation, as "propeller against flywheel".
    remark : str
        Why a frequency is missing; empty if none is.
    """

    mode: Annotated[int, Out("mode")]
    undamped_frequency: Annotated[float, Out("undamped", "Hz", "undamped_natural_frequency_Hz", digits=4)]
    natural_frequency: Annotated[float, Out("with damping", "Hz", "natural_frequency_Hz", digits=4)]
    damping_ratio: Annotated[float, Out("damping ratio", "%", digits=3, factor=100)]
    n_nodes: Annotated[int | None, Out("nodes")]
    nodes: tuple[str, ...]
    against: Annotated[str, Out("what swings")]
    remark: Annotated[str, Out("remark")]

    @property
    def per_minute(self) -> Annotated[float, Out("undamped", "1/min", None, digits=5, after="undamped_frequency")]:
        """Undamped natural frequency of a mode in vibrations per minute."""
        return SECONDS_PER_MINUTE * self.undamped_frequency

    @property
    def node_places(self) -> Annotated[str, Out("nodes of vibration", json=None, after="n_nodes")]:
        """Text with the places of a mode's nodes of vibration, joined by commas."""
        return ", ".join(self.nodes)

    @property
    def lowest(self) -> float:
        """Lower one of a mode's natural frequencies in Hz without and with damping, or the only one it has."""
        both = (self.undamped_frequency, self.natural_frequency)
        return min(one for one in both if not math.isnan(one))


def natural_frequency_table(title: str, rows: tuple[CountedVibration, ...], notes: tuple[str, ...] = ()) -> Table:
    """Table of natural frequencies in Hz and per minute, with damping ratio in percent and number of nodes."""
    return result_table(title, rows, CountedVibration, notes=notes)
