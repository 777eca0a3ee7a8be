"""Pairs of undamped and damped modes of a drivetrain with the most similar strain.

Strong dampers move frequencies so far that their order says nothing, and the mode of a damper may have most of the
motion. Shafts fail by strain: pairs are chosen for the most similar strain, by the modal assurance criterion weighted
with the stiffness. Undamped modes of one frequency count together, since any mixture of their shapes is a mode shape.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.phrases import phrase
from torsionnet.base.result_rows import Out
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray, RowSystem
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.linear.modes.eigen import undamped_modes, unit_shapes
from torsionnet.linear.modes.modes import OSCILLATORY, Modes
from torsionnet.linear.modes.natural_modes import modes as damped_modes
from torsionnet.model.element_base.speed_path import SpeedPaths
from torsionnet.model.elements import Values

# Mode of vibration with its frequencies in Hz with and without damping.

SHIFTED_SHARE = 0.01
"""Relative difference of natural and undamped frequency above which a mode counts as shifted by damping."""


@dataclass(frozen=True, eq=False)
class VibrationMode:
    """Undamped mode paired with the damped mode of the most similar strain, frequencies in Hz; either may be missing.

    Attributes
    ----------
    number : int
        Number of the damped mode, from 1 by rising ``|lambda|``, as in every table of modes; undamped modes that are
        overdamped follow after them.
    undamped_frequency : float
        Frequency in Hz from M and K alone; nan where a mode exists only with damping.
    natural_frequency, damped_frequency : float
        ``|lambda|/2pi`` and ``Im lambda/2pi`` in Hz; nan for an overdamped mode.
    damping_ratio : float
    similarity : float
        Modal assurance criterion of the two shapes, weighted with the stiffness; nan where one is missing.
    shape : (n_nodes,) complex array
        Angles, 1 at the node that moves most; the undamped shape if there is one.
    """

    number: Annotated[int, Out("mode", json="mode")]
    undamped_frequency: Annotated[float, Out("undamped", "Hz", "undamped_natural_frequency_Hz")]
    natural_frequency: Annotated[float, Out("|lambda|/2pi", "Hz", "natural_frequency_Hz")]
    damped_frequency: Annotated[float, Out("damped Im lambda/2pi", "Hz", "damped_frequency_Hz")]
    damping_ratio: Annotated[float, Out("damping ratio", "1", digits=4)]
    similarity: float
    shape: Annotated[ComplexArray, Out(json=None)]

    @property
    def amplification(self) -> Annotated[float, Out("amplification", digits=4, after="damping_ratio")]:
        """Amplification of a mode at resonance, ``1/(2 zeta)``; nan without a damped mode, infinite without damping."""
        if math.isnan(self.damping_ratio):
            return math.nan
        return 1 / (2 * self.damping_ratio) if self.damping_ratio > 0 else math.inf

    @property
    def is_shifted(self) -> bool:
        """Whether damping shifts the natural frequency of a mode by more than 1 %."""
        return abs(self.natural_frequency - self.undamped_frequency) > SHIFTED_SHARE * self.undamped_frequency

    @property
    def remark(self) -> Annotated[str, Out("remark", json=None, after="shape")]:
        """Text on why a frequency of a mode is missing (overdamped, or only with damping); empty if none is."""
        if math.isnan(self.natural_frequency):
            return phrase("overdamped: none with damping")
        return phrase("exists with damping only") if math.isnan(self.undamped_frequency) else ""


def amplification(frequency_ratio: float, damping_ratio: float) -> float:
    """Magnification ``1/|1 - r^2 + 2 j zeta r|`` of one degree of freedom at r = excitation over natural frequency.

    >>> round(amplification(0.9, 0.01), 2)
    5.24
    """
    size = abs(complex(1 - frequency_ratio**2, 2 * damping_ratio * frequency_ratio))
    return 1 / size if size else math.inf


LEAST_SIMILARITY = 0.5
"""Similarity of strain, from 0 to 1, below which an undamped and a damped mode are no pair."""
REPEATED_FREQUENCY = 1e-6
"""Relative difference below which natural frequencies are one repeated frequency, whose shapes may be mixed in any
way."""


def vibration_modes(drivetrain: AssembledModel, modes: Modes) -> tuple[VibrationMode, ...]:
    """Vibration modes as pairs of undamped and damped modes, by undamped frequency, then modes with damping only.

    A pair has the number of its damped mode; undamped modes without a partner are numbered after all vibrations.
    """
    assembly = drivetrain.assembly
    rates, shapes = undamped_modes(assembly.system)
    rates, shapes = rates[rates > 0], shapes[:, rates > 0]
    places = [assembly.node_index[name] for name in assembly.kinematics.coordinates]
    vibrating = [number for number, kind in enumerate(modes.kinds) if kind == OSCILLATORY]
    # Similarity of strain, the MAC with K as metric, equation (7.3).
    similarities = _similarity(assembly.system, rates, shapes, np.asarray(modes.shapes[np.ix_(places, vibrating)]))
    partners = _in_order(dict(_assigned(similarities)), rates)
    behind = itertools.count(len(vibrating) + 1)
    at_nodes = unit_shapes(np.asarray(assembly.node_rows.dense @ shapes)).astype(complex)
    vibrations: list[VibrationMode] = []
    for number, rate in enumerate(rates):
        damped = None if number not in partners else vibrating[partners[number]]
        similarity = math.nan if damped is None else float(similarities[number, partners[number]])
        place = next(behind) if damped is None else partners[number] + 1
        vibrations.append(_mode(place, rate / (2 * np.pi), modes, damped, similarity, at_nodes[:, number]))
    for place, damped in enumerate(vibrating):
        if place not in partners.values():
            vibrations.append(_mode(place + 1, math.nan, modes, damped, math.nan, modes.shapes[:, damped]))
    return tuple(vibrations)


def undamped_place(drivetrain: AssembledModel, number: int) -> tuple[int, VibrationMode]:
    """Index among undamped vibrations, by rising frequency, of the mode with this number, and the mode itself.

    Raises
    ------
    UsageError
        There is no such mode, or the mode exists with damping only.
    """
    modes = vibration_modes(drivetrain, damped_modes(drivetrain))
    for place, mode in enumerate(modes):
        if mode.number == number:
            if math.isnan(mode.undamped_frequency):
                raise UsageError(
                    f"mode {number} ({mode.natural_frequency:.5g} Hz) exists with damping only; choose another mode",
                    kind="unknown-mode",
                )
            return place, mode
    known = f"there are {len(modes)}, counted from 1 without rigid bodies" if modes else "nothing vibrates here"
    raise UsageError(f"there is no mode {number}; {known}", kind="unknown-mode")


def _in_order(partners: Mapping[int, int], rates: FloatArray) -> dict[int, int]:
    """Index of the damped partner by index of the undamped mode.

    Among undamped modes of one frequency partners are sorted.
    """
    in_order: dict[int, int] = {}
    for group in _groups(rates):
        paired = [place for place in group if place in partners]
        in_order |= dict(zip(paired, sorted(partners[place] for place in paired), strict=True))
    return in_order


def _mode(
    number: int, undamped: float, modes: Modes, damped: int | None, similarity: float, shape: ComplexArray
) -> VibrationMode:
    return VibrationMode(
        number=number,
        undamped_frequency=float(undamped),
        natural_frequency=math.nan if damped is None else float(modes.natural_frequencies[damped]),
        damped_frequency=math.nan if damped is None else float(modes.damped_frequencies[damped]),
        damping_ratio=math.nan if damped is None else float(modes.damping_ratios[damped]),
        similarity=similarity,
        shape=shape,
    )


def _similarity(system: RowSystem, rates: FloatArray, shapes: FloatArray, damped: ComplexArray) -> FloatArray:
    """Share (n_undamped, n_damped) of each damped mode's strain energy that lies in each undamped mode's shape."""
    similarity = np.zeros((len(rates), damped.shape[1]))
    rows = system.rows
    for group in _groups(rates):
        # Laws over frequency count with the strain energy that they have at this frequency.
        stiffness = system.stiffness.copy()
        for law, table in system.dynamic:
            stiffness[law] += max(table.energy(1j * float(rates[group[0]]))[1], 0.0)
        weight = np.sqrt(stiffness)[:, None]
        # MAC of the strains sqrt(k) gamma, with the space of all shapes that have this frequency.
        basis, strain = np.linalg.qr(weight * (rows @ shapes[:, group]))[0], weight * (rows @ damped)
        sizes = np.sum(np.abs(strain) ** 2, axis=0)
        common = np.sum(np.abs(basis.T @ strain) ** 2, axis=0)
        similarity[group] = np.divide(common, sizes, out=np.zeros_like(sizes), where=sizes > 0)
    return similarity


def _groups(rates: FloatArray) -> Iterator[list[int]]:
    """Yield groups of indices of rising natural frequencies that are equal within rounding."""
    group: list[int] = []
    for place, rate in enumerate(rates):
        if group and rate - rates[group[0]] > REPEATED_FREQUENCY * rate:
            yield group
            group = []
        group.append(place)
    if group:
        yield group


def _assigned(similarity: FloatArray) -> Iterator[tuple[int, int]]:
    """Yield index pairs (undamped, damped) of modes with the largest sum of strain similarities, similar ones only."""
    clear = np.where(similarity >= LEAST_SIMILARITY, similarity, 0)
    rows = np.flatnonzero(clear.any(axis=1))
    if not len(rows):
        return
    best = clear[rows].max(axis=1, initial=0.0)
    is_best = clear[rows] == best[:, None]
    if (is_best.sum(axis=1) == 1).all() and (is_best.sum(axis=0) <= 1).all():
        # Each row has one largest entry, all in columns of their own: no other choice reaches their sum.
        yield from zip(rows.tolist(), is_best.argmax(axis=1).tolist(), strict=True)
        return
    from scipy.optimize import linear_sum_assignment  # a quarter of a second of CPU, which few drivetrains need

    for row, column in zip(*linear_sum_assignment(-clear), strict=True):
        if clear[row, column]:
            yield int(row), int(column)


# Mode shapes with all angles referred to one shaft, as is usual for geared drivetrains.


def referred_shapes(drivetrain: AssembledModel, modes: Modes, referred_to: str) -> Modes:
    """Modes with angles times speed of a shaft over speed of the node, scaled to a largest angle of 1.

    Nodes to which no ratio leads, as a block on its mounts, keep their own angles; a note names them.

    Raises
    ------
    UsageError
        There is no such node.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("amt_rig").configured("V")
    >>> shapes = referred_shapes(rig, rig.modes(), "motor")
    >>> bool(abs(shapes.shape_at("input_shaft")[0] - shapes.shape_at("output_shaft")[0]) < 1e-12)
    True
    """
    if referred_to not in drivetrain.nodes:
        raise UsageError(
            f'no node is named "{referred_to}"{did_you_mean(referred_to, drivetrain.nodes)}', kind="unknown-node"
        )
    value = Values(drivetrain.exact_values)
    paths = SpeedPaths(tuple(drivetrain.elements.values()), value)
    paths_to = {node: paths.between(node, referred_to) for node in modes.nodes}
    # An angle on another shaft is the angle times the ratio of speeds.
    factors = np.array([1.0 if path is None else float(path.ratio(value)) for path in paths_to.values()])
    own = [node for node, path in paths_to.items() if path is None]
    notes = (f"angles referred to {referred_to}", *([f"no ratio leads there from {', '.join(own)}"] if own else []))
    return replace(
        modes,
        shapes=np.asarray(unit_shapes(modes.shapes * factors[:, None]), dtype=complex),
        notes=(*modes.notes, *notes),
    )
