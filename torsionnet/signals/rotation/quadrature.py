"""Direction and steps of an encoder with two tracks, the second a quarter pitch further than the first."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.pulse_channel import PulseChannel

EDGES = 4
"""Number of edges of two tracks in a pitch: forwards the first rises, the second rises, the first falls, the second
falls."""

LEAST_APART = 0.03
"""Least share of a pitch, by median, from an edge of one track to that of the other, nominally a quarter; below it
jitter exchanges the two."""


@dataclass(frozen=True, eq=False)
class DirectedPulses(PulseChannel):
    """Pulses of an encoder whose direction is known.

    Attributes
    ----------
    numbers : (n,) int array
        Pitch of each pulse; it falls while the shaft turns backwards, and is the same before and after it turns back
        between two teeth.
    """

    numbers: NDArray[np.intp] = field(default_factory=lambda: np.empty(0, np.intp))

    @property
    def turns_back(self) -> int:
        """Number of times that the shaft turns back between pulses."""
        moves = np.sign(np.diff(self.numbers))
        moves = moves[moves != 0]
        return int(np.count_nonzero(np.diff(moves)))


def quadrature_pulses(
    name: str,
    first: tuple[FloatArray, FloatArray],
    second: tuple[FloatArray, FloatArray],
    *,
    edge: str = "rising",
    notes: tuple[NoteOrText, ...] = (),
) -> DirectedPulses:
    """Pulses of the first track of an encoder with the direction that the second tells.

    In both directions a pulse is the passage of the same flank of a tooth.

    Parameters
    ----------
    name : str
        Name of the channel.
    first, second : pair of arrays
        Times in s at which a track rises, and at which it falls.
    edge : {"rising", "falling"}
        Flank of the first track that is a pulse, as it is while the shaft turns forwards.
    notes : tuple of str, optional

    Raises
    ------
    UsageError
        A track without edges, or tracks of which one changes twice before the other does most of the time.

    Examples
    --------
    >>> quarter = np.arange(12) * 0.25
    >>> found = quadrature_pulses("n1", (quarter[::4], quarter[2::4]), (quarter[1::4], quarter[3::4]))
    >>> found.times.tolist(), found.numbers.tolist()
    ([0.0, 1.0, 2.0], [0, 1, 2])
    """
    times = np.concatenate([first[0], second[0], first[1], second[1]])
    kinds = np.repeat(np.arange(EDGES), [len(first[0]), len(second[0]), len(first[1]), len(second[1])])
    if len(times) <= 2 * EDGES or len(np.unique(kinds)) < EDGES:
        raise UsageError(
            f"{name}: a track has no edges that rise and fall, and two tracks are needed for the direction"
        )
    order = np.argsort(times, kind="stable")
    times, kinds = times[order], kinds[order]
    signs = _signs(kinds)
    # A flank is that of the same tooth in both directions, but falls on the way back where it rose before.
    flanks = np.where(signs > 0, kinds, (kinds + 2) % EDGES)
    usual = (signs[1:] + signs[:-1]) // 2
    lost = (signs[1:] * (np.diff(flanks) - usual)) % EDGES
    shares = np.diff(times)[: -EDGES + 1] / (times[EDGES:] - times[:-EDGES])
    apart = min(float(np.median(shares[kinds[: len(shares)] == kind])) for kind in range(EDGES))
    if np.count_nonzero(lost) > len(lost) // 2 or apart < LEAST_APART:
        raise UsageError(
            f"{name}: the two tracks do not change in turn: the second is not a quarter pitch further, or not of "
            "the same teeth"
        )
    steps = np.concatenate([[flanks[0]], usual + signs[1:] * lost]).cumsum()
    wanted = flanks == (2 if edge == "falling" else 0)
    numbers = (steps[wanted] - flanks[wanted]) // EDGES
    remarks = (f"{np.count_nonzero(lost)} lost edges of two tracks counted",) if lost.any() else ()
    return DirectedPulses(name, times[wanted], notes=(*notes, *remarks), numbers=numbers - numbers[0])


def _signs(kinds: NDArray[np.intp]) -> NDArray[np.intp]:
    """Direction at each edge, 1 or -1, from the level of the other track."""
    places = np.arange(len(kinds))
    signs = np.ones(len(kinds), dtype=np.intp)
    for track in (0, 1):
        own, other = np.flatnonzero(kinds % 2 == track), np.flatnonzero(kinds % 2 != track)
        last = np.searchsorted(other, places[own]) - 1
        # Before its first edge the other track has the level that this edge leaves.
        high = np.where(last >= 0, kinds[other[np.maximum(last, 0)]] < 2, kinds[other[0]] >= 2)
        rises = kinds[own] < 2
        signs[own] = np.where(rises != high, 1, -1) if track == 0 else np.where(rises == high, 1, -1)
    return signs
