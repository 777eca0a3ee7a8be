"""Stepped sines at several amplitudes: first harmonics of torque and twist of each step, and k' + j k'' of them.

Steps are found in the twist: cycles of one period and one swing that follow each other. From the torque through an
element and its twist k' + j k'' = T_1/gamma_1 over the amplitude, eta_1 = k''/k'; on an inertia J that the element
alone holds, the backbone is w(a)^2 = k'(a)/J.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.base.packages import SavedResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table

if TYPE_CHECKING:
    from torsionnet.model.element_base.element import Element

FloatArray = NDArray[np.float64]

HARMONICS = 9
"""Harmonics of a steady motion that are taken along, the first included."""
FEWEST_CYCLES = 4
"""Cycles of one period and one swing that make a step; the first is left out as it may still settle."""
SAME_SWING, SAME_PERIOD = 0.05, 0.1
"""Shares by which swings and periods of cycles of one step may differ; extremes tell a period roughly."""
NOISE_SWINGS = 8.0
"""Swings below this multiple of the noise between samples are none."""
SWEPT = 0.2
"""Phase in rad at either end by which the frequency of a step may change from that of its middle."""
RIPPLE, NEAR = 0.3, 4
"""Swing over those near by, up to so many before and behind, below which it is a ripple on them."""
NEARLY_A_SINE = 0.05
"""Share of harmonics of a twist from which first harmonics tell its law badly."""
NOT_A_SINE = 0.2
"""Share of a twist beside its first harmonic from which a group of cycles is none of one frequency, as of a sweep."""
REFINEMENTS = 6
"""Steps of Gauss and Newton by which the frequency of a step is fitted."""


class HasElements(Protocol):
    """Drivetrain, of which elements and the values of parameters are asked for."""

    @property
    def elements(self) -> Mapping[str, Element]:
        """Elements by name."""
        ...

    @property
    def exact_values(self) -> Mapping[str, Any]:
        """Values of parameters in SI units, by name."""
        ...


@dataclass(frozen=True, eq=False, repr=False)
class SteppedStiffness(SavedResult):
    """First harmonics of torque and twist at the steps of a sine test, a row for each step in the order of the test.

    Attributes
    ----------
    frequencies : (n,) array
        Hz.
    twists, torques : (n,) complex arrays
        First harmonics of the twist in rad and of the torque in N m, gamma = Re gamma_1 exp(j w t).
    mean_twists, mean_torques : (n,) arrays
        rad and N m.
    distortion : (n,) array
        What the torque has beside its first harmonic and its mean, root mean square over that of the first harmonic.
    title : str
    notes : tuple of str
    harmonics : (n, 8) complex array or None
        Harmonics of the twist in rad from the second on; None where only the first is known.
    """

    SHOWN: ClassVar = (
        "title", "notes", "frequencies", "amplitudes", "torque_amplitudes", "mean_twists", "mean_torques", "real",
        "imaginary", "loss_factors", "distortion",
    )  # fmt: skip

    frequencies: Annotated[FloatArray, Out(json="frequency_Hz")]
    twists: NDArray[np.complex128]
    torques: NDArray[np.complex128]
    mean_twists: Annotated[FloatArray, Out(json="mean_twist_rad")]
    mean_torques: Annotated[FloatArray, Out(json="mean_torque_Nm")]
    distortion: Annotated[FloatArray, Out(json="other_harmonics")]
    title: str = ""
    notes: tuple[NoteOrText, ...] = ()
    harmonics: NDArray[np.complex128] | None = None

    @property
    def amplitudes(self) -> Annotated[FloatArray, Out(json="amplitude_rad")]:
        """Amplitudes of the twist in rad, shape (n,)."""
        return np.asarray(np.abs(self.twists))

    @property
    def torque_amplitudes(self) -> Annotated[FloatArray, Out(json="torque_amplitude_Nm")]:
        """Amplitudes of the torque in N m, shape (n,)."""
        return np.asarray(np.abs(self.torques))

    @property
    def stiffness(self) -> NDArray[np.complex128]:
        """Complex k' + j k'' in N m/rad, shape (n,)."""
        return np.asarray(self.torques / self.twists)

    @property
    def real(self) -> Annotated[FloatArray, Out(json="k1_Nm_per_rad")]:
        """Stiffness k' in N m/rad, shape (n,)."""
        return self.stiffness.real

    @property
    def imaginary(self) -> Annotated[FloatArray, Out(json="k2_Nm_per_rad")]:
        """Part k'' of the stiffness in N m/rad, a quarter period ahead of the twist, shape (n,)."""
        return self.stiffness.imag

    @property
    def loss_factors(self) -> Annotated[FloatArray, Out(json="eta_1")]:
        """Loss factors eta_1 = k''/k', shape (n,)."""
        return _quotient(self.imaginary, self.real)

    def backbone(self, inertia: float) -> FloatArray:
        """Frequencies sqrt(k'(a)/J)/(2 pi) in Hz at which an inertia in kg m^2 on the element resonates, shape (n,)."""
        return np.asarray(np.sqrt(np.maximum(self.real, 0.0) / inertia) / (2 * np.pi))

    def model_stiffness(self, drivetrain: HasElements, element: str) -> NDArray[np.complex128]:
        """Stiffness k' + j k'' in N m/rad of an element of a model at the same amplitudes and means, shape (n,).

        Raises
        ------
        UsageError
            There is no such element, or a law of it has no describing function.
        """
        from torsionnet.base.errors import unknown_name
        from torsionnet.model.motion_laws.element_stiffness import element_stiffness

        elements = {name: part for name, part in drivetrain.elements.items() if part.enabled}
        if element not in elements:
            raise UsageError(unknown_name("element", element, list(elements)))
        rows = zip(self.amplitudes, self.mean_twists, self.mean_torques, 2 * np.pi * self.frequencies, strict=True)
        stiffnesses = [
            element_stiffness(elements[element], drivetrain.exact_values, *map(float, row)).stiffness for row in rows
        ]
        return np.array(stiffnesses)

    def table(self) -> Table:
        """Table with a row for each step."""
        columns = (
            Column("frequency", "Hz", 5),
            Column("amplitude", "deg", 4),
            Column("torque amplitude", "N*m", 4),
            Column("mean torque", "N*m", 4),
            Column("k'", "N*m/rad", 5),
            Column("k''", "N*m/rad", 4),
            Column("eta_1", "", 4),
            Column("other harmonics", "", 2),
        )
        data = (
            self.frequencies,
            np.rad2deg(self.amplitudes),
            self.torque_amplitudes,
            self.mean_torques,
            self.real,
            self.imaginary,
            self.loss_factors,
            self.distortion,
        )
        rows = tuple(tuple(map(float, row)) for row in zip(*data, strict=True))
        name = self.title or "Stepped sine"
        return Table.of(name, "stiffness over amplitude", columns, rows, tuple(map(str, self.notes)))

    def compared(self, drivetrain: HasElements, element: str) -> Table:
        """Table of the test over a model's element at the amplitudes of the test; differences are test - model."""
        model = self.model_stiffness(drivetrain, element)
        columns = (
            Column("frequency", "Hz", 5),
            Column("amplitude", "deg", 4),
            Column("mean torque", "N*m", 4),
            Column("k' test", "N*m/rad", 5),
            Column("k' model", "N*m/rad", 5),
            Column("difference", "%", 3),
            Column("eta_1 test", "", 4),
            Column("eta_1 model", "", 4),
        )
        data = (
            self.frequencies,
            np.rad2deg(self.amplitudes),
            self.mean_torques,
            self.stiffness.real,
            model.real,
            100 * (_quotient(self.stiffness.real, model.real) - 1),
            self.loss_factors,
            _quotient(model.imag, model.real),
        )
        rows = tuple(tuple(map(float, row)) for row in zip(*data, strict=True))
        name = f"{self.title or 'test'} and {element}"
        return Table.of(name, "stiffness over amplitude", columns, rows, tuple(map(str, self.notes)))


def _quotient(above: FloatArray, below: FloatArray) -> FloatArray:
    """Quotient of two arrays, nan where the second is zero, as the stiffness within a gap."""
    quotient: FloatArray = np.divide(above, below, out=np.full(len(below), np.nan), where=below != 0)
    return quotient


def stepped_stiffness(
    torque: FloatArray, twist: FloatArray, sampling_rate: float, title: str = "", notes: tuple[NoteOrText, ...] = ()
) -> SteppedStiffness:
    """First harmonics of a torque in N m and of a twist in rad at all steps of a sine test.

    See :meth:`torsionnet.signals.Recording.stepped_stiffness`.
    """
    if not (np.isfinite(torque).all() and np.isfinite(twist).all()):
        raise UsageError("torque and twist have samples without a value", kind="not-finite")
    harmonics = [
        _harmonics(torque[a:b], twist[a:b], rate, sampling_rate)
        for a, b, rate in _groups_of_cycles(twist, sampling_rate)
    ]
    rows = [row for row in harmonics if row is not None]
    if not rows:
        raise UsageError(
            f"the twist holds no frequency and no amplitude for {FEWEST_CYCLES} cycles; a stepped sine does",
            kind="too-short",
        )
    frequencies, twists, torques, mean_twists, mean_torques, distortion, others, further = (
        np.array(column) for column in zip(*rows, strict=True)
    )
    remarks: list[NoteOrText] = [*notes, f"{len(rows)} steps found; first cycle of each left out"]
    if others.max() > NEARLY_A_SINE:
        text = (
            f"harmonics of the twist are up to {100 * others.max():.2g} % of the first one, and describing functions "
            "suppose a sine: fit these steps, which takes the harmonics along, or the record over time"
        )
        remarks.append(warning(text))
    columns = (frequencies, twists, torques, mean_twists, mean_torques, distortion)
    return SteppedStiffness(*columns, title, tuple(remarks), further)


def _groups_of_cycles(angle: FloatArray, sampling_rate: float) -> list[tuple[int, int, float]]:
    """First and last sample, and frequency in Hz, of each group of cycles that are alike."""
    rises = _rises(angle)
    cycles = [(a, b, float(np.ptp(angle[a:b]))) for a, b in pairwise(rises) if b > a + 4]
    groups: list[list[tuple[int, int, float]]] = []
    for cycle in cycles:
        if groups and cycle[0] == groups[-1][-1][1] and _alike(cycle, groups[-1]):
            groups[-1].append(cycle)
        else:
            groups.append([cycle])
    steps = []
    for group in groups:
        if len(group) >= FEWEST_CYCLES:
            # From top to top, where the twist stands still: a part of a sample more or less does not count there.
            first, end = (a + int(np.argmax(angle[a:b])) for a, b, _ in (group[0], group[-1]))
            steps.append((first, end, (len(group) - 1) * sampling_rate / (group[-1][0] - group[0][0])))
    return steps


def _alike(cycle: tuple[int, int, float], group: Sequence[tuple[int, int, float]]) -> bool:
    # A transient fades, so that a cycle is like the one before rather than like the first.
    a, b, swing = group[-1]
    # A reversal is known to a sample at either end.
    period = (group[-1][1] - group[0][0]) / len(group)
    return abs(cycle[2] / swing - 1) <= SAME_SWING and abs((cycle[1] - cycle[0]) / period - 1) <= SAME_PERIOD + 2 / (
        b - a
    )


def _rises(angle: FloatArray) -> list[int]:
    """Samples at which the angle rises through the middle of its swing; ripples on a swing are none themselves."""
    turns = np.array([place for place, _ in _reversals(angle)], dtype=np.intp)
    while len(turns) > 3:
        swings = np.abs(np.diff(angle[turns]))
        # A ripple is far smaller than a swing near by on either side; of several the smallest goes first.
        around = np.lib.stride_tricks.sliding_window_view(np.pad(swings, NEAR), NEAR).max(axis=1)
        bound = RIPPLE * np.minimum(around[: len(swings)], around[NEAR + 1 :])[1:-1]
        small = np.flatnonzero((swings[1:-1] < bound) & (swings[1:-1] < swings[:-2]) & (swings[1:-1] <= swings[2:])) + 1
        if not len(small):
            break
        turns = np.delete(turns, np.concatenate([small, small + 1]))
    pairs = ((a, b) for a, b in pairwise(turns.tolist()) if angle[b] > angle[a])
    # Friction flattens the tops, which noise then places anywhere; in the middle of the swing the twist is fast.
    return [a + int(np.argmax(angle[a : b + 1] > (angle[a] + angle[b]) / 2)) for a, b in pairs]


def _reversals(angle: FloatArray) -> list[tuple[int, bool]]:
    """Sample of each reversal, and whether it is a maximum; swings within the noise are left out."""
    # Third differences of a sine that is sampled well are small, those of white noise are sqrt(20) of it.
    noise = float(np.median(np.abs(np.diff(angle, 3)))) / 0.6745 / np.sqrt(20) if len(angle) > 3 else 0.0
    least = max(NOISE_SWINGS * noise, 1e-4 * float(np.ptp(angle)))
    reversals: list[tuple[int, bool]] = []
    top = bottom = 0
    rising: bool | None = None
    # An extreme is one once the twist has come back from it by more than noise does.
    for place in range(1, len(angle)):
        top = place if angle[place] > angle[top] else top
        bottom = place if angle[place] < angle[bottom] else bottom
        if rising is not False and angle[top] - angle[place] > least:
            reversals.append((top, True))
            rising, bottom = False, place
        elif rising is not True and angle[place] - angle[bottom] > least:
            reversals.append((bottom, False))
            rising, top = True, place
    return reversals


def _harmonics(
    load: FloatArray, angle: FloatArray, frequency: float, rate: float
) -> tuple[float, complex, complex, float, float, float, float, NDArray[np.complex128]] | None:
    """Frequency in Hz, first harmonics of twist and torque, means and rests of both, further ones of the twist.

    None where the twist is no sine.
    """
    time = np.arange(len(angle)) / rate
    middle = time - time[-1] / 2
    ones = np.ones_like(time)
    for _ in range(REFINEMENTS):
        phase = 2 * np.pi * frequency * middle
        basis = np.array([np.cos(phase), np.sin(phase), ones, middle]).T
        a, b = np.linalg.lstsq(basis, angle, rcond=None)[0][:2]
        # d gamma/d omega = t (-a sin + b cos): the fifth column moves the frequency.
        moved = np.column_stack([basis, middle * (b * np.cos(phase) - a * np.sin(phase))])
        change = float(np.linalg.lstsq(moved, angle, rcond=None)[0][4]) / (2 * np.pi)
        frequency += change
        if abs(change) < 1e-12 * frequency:
            break
    # A frequency that goes on changes the phase by q t^2.
    bent = np.column_stack([moved, moved[:, 4] * middle])
    sweep = float(np.linalg.lstsq(bent, angle, rcond=None)[0][5]) * middle[-1] ** 2
    if abs(sweep) > SWEPT:
        return None
    phase = 2 * np.pi * frequency * middle
    # Whole periods, so that mean and harmonics do not mix.
    periods = max(1, int(len(time) * frequency / rate + 1e-9))
    kept = slice(0, round(periods / frequency * rate))
    basis = np.array([np.cos(phase), np.sin(phase), ones, middle]).T[kept]
    fit = np.linalg.lstsq(basis, np.column_stack([angle, load])[kept], rcond=None)[0]
    twist, torque = fit[0] - 1j * fit[1]
    left = np.column_stack([angle, load])[kept] - basis @ fit
    rest = np.sqrt(2 * np.mean(left**2, axis=0))
    if rest[0] > NOT_A_SINE * abs(twist):
        return None
    share = float(rest[1] / abs(torque)) if torque else 0.0
    orders = np.arange(2, HARMONICS + 1)
    further = 2 * np.exp(-1j * np.outer(orders, phase[kept])) @ left[:, 0] / len(left)
    further[orders * frequency >= rate / 2] = 0.0
    return (
        frequency,
        complex(twist),
        complex(torque),
        float(fit[2, 0]),
        float(fit[2, 1]),
        share,
        float(rest[0] / abs(twist)),
        further,
    )
