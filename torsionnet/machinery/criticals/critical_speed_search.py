"""Critical speeds at which an order of an excitation meets a natural frequency of a mode."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError, comma_list
from torsionnet.base.number_text import screen_text
from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.linear.modes.mode_pairs import VibrationMode, vibration_modes
from torsionnet.linear.modes.natural_modes import modes
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed, CriticalSpeeds
from torsionnet.machinery.criticals.line_meetings import LineOverModes, Meeting
from torsionnet.machinery.criticals.modes_over_speed import DAMPED, NATURAL, UNDAMPED, ModesOverSpeed
from torsionnet.machinery.criticals.speed_peaks import with_speed_peaks
from torsionnet.machinery.design.damper_design import AS_MODELLED, with_dampers
from torsionnet.machinery.excitations import OrderExcitation, OrderTorques
from torsionnet.machinery.orders.order_line import OrderLine
from torsionnet.machinery.orders.order_solution import input_senses, orders_at_speeds, with_motions_held
from torsionnet.machinery.orders.vector_sums import generalised_force, star_diagram
from torsionnet.machinery.verdicts.margin_rules import MarginRule, margin_rule
from torsionnet.model.channels import Channels
from torsionnet.model.operating_values import operating_speed_notes
from torsionnet.model.speeds import speeds_by_reference

LINE_FREQUENCY = "line frequency"
"""Name of the excitation under which lines at 1 and 2 times the frequency of the electric grid are listed."""
FOLLOWED_ABOVE = 1.5
"""Ratio of a mode's frequency to the highest of any line above which the mode is not followed closely: no margin of a
rule is near a half."""


def critical_speeds(
    drivetrain: AssembledModel,
    output: Channels = (),
    *,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitation: str | Iterable[str] | None = None,
    lines: Iterable[str] | None = None,
    margin: str | float | MarginRule | None = None,
    reach: float = 0.25,
    lowest: int | None = None,
    line_frequency: float | None = None,
    rings: str = AS_MODELLED,
    damper: Iterable[str] | None = None,
) -> CriticalSpeeds:
    """Critical speeds at which orders meet natural frequencies, with and without damping, and their excitation.

    Parameters
    ----------
    output : str, Sensor or sequence of these, optional
        Also the speeds at which the orders of these are largest.
    speeds : array, optional
        rad/s; the lowest and the highest bound the operating range. Default: those of the model.
    speed_of : str, optional
        The node they belong to; default: that of the model.
    excitation : str or iterable of str, optional
        Which of the model's excitations count; default: all.
    lines : iterable of str, optional
        Names of the order lines that count, such as ``"engine 6"``; default: all.
    margin : str, float or MarginRule, optional
        A preset (``"api610"``, ``"api617"``, ``"api618"``, ``"api684"``, ``"line_frequency"``), or a share as 0.1.
    reach : float
        Critical speeds are listed up to this share outside the operating range.
    lowest : int, optional
        Only the lowest so many modes.
    line_frequency : float, optional
        Hz; once and twice of it are compared with the natural frequencies, too.
    rings : str
        ``"as_modelled"``, or the rings of viscous dampers ``"free"``, ``"locked"``, or by ``"half"``.
    damper : iterable of str, optional
        Which dampers, or films between a hub and a ring; default: all elements of type viscous_damper.

    Raises
    ------
    UsageError
        Unknown names, no excitations or speeds, or a shaft without a fixed ratio to the reference.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...     tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)]
    >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["500 rpm", "700 rpm"]},
    ...     excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}})
    >>> [(speed.mode.number, speed.order, speed.generalised_force) for speed in fan.critical_speeds().crossings]
    [(1, 2.0, 10.0)]
    """
    if not 0 <= reach < 1:
        raise UsageError(f"reach is a share of the speeds, 0 or more and below 1, got {reach}", kind="out-of-range")
    if line_frequency is not None and not 0 < line_frequency < math.inf:
        raise UsageError(f"a line frequency is above 0 Hz, got {line_frequency}", kind="out-of-range")
    rule = margin_rule(margin)
    changed = _with_dampers(drivetrain, rings, damper)
    every, reference, speed_range = excited_lines(changed, speeds, speed_of, excitation)
    examined = every if lines is None else _chosen_lines(every, lines)
    # The vibrations are those with imposed motions held, as in the order response.
    held = with_motions_held(changed, {name: changed.definition.excitations[name] for name in examined})
    title = drivetrain.title + ("" if rings == AS_MODELLED else f", damper ring {rings}")
    acting = {name: float(group[0].ratio) for name, group in examined.items()}
    if line_frequency:
        examined[LINE_FREQUENCY] = [
            OrderLine(LINE_FREQUENCY, 0.0, Fraction(1), times * line_frequency) for times in (1, 2)
        ]
    every_line = [line for group in examined.values() for line in group]
    # Modes are followed up to the highest of all lines, so that other lines and conditions find them known.
    beside = [line for group in every.values() for line in group]
    search = CrossingSearch(held, title, reference, speed_range, every_line, rule, reach, lowest, beside)
    search.known = {name: search.known_speeds(name, ratio) for name, ratio in acting.items()}
    crossings = [crossing for name, group in examined.items() for crossing in search.crossings(name, group)]
    crossings.sort(key=lambda speed: (speed.mode.number, speed.excitation, speed.order, speed.fixed, speed.first_speed))
    critical = CriticalSpeeds(
        reference=reference,
        speed_range=search.speed_range,
        modes=search.modes,
        crossings=tuple(crossings),
        lines=tuple(every_line),
        nodes=held.assembly.nodes,
        rule=search.rule,
        title=title,
        condition=drivetrain.configuration,
        notes=tuple(search.notes()),
    )
    if isinstance(output, (list, tuple)) and not output:
        return critical
    # Peaks are searched only where modes and torques of all excitations are known.
    ends = [search.limits, search.over_speed.known, *search.known.values()]
    common = max(low for low, _ in ends), min(high for _, high in ends)
    peaks, channels = with_speed_peaks(changed, critical.crossings, output, reference, common)
    return replace(critical, crossings=peaks, outputs=channels)


def order_margins(
    drivetrain: AssembledModel, *, speeds: ArrayLike | None = None, excitations: Iterable[str] | None = None
) -> tuple[CriticalSpeed, ...]:
    """Places where every order line is nearest to every mode, however far away, with margins but no forces or peaks."""
    lines, reference, speed_range = excited_lines(drivetrain, speeds, None, excitations)
    held = with_motions_held(drivetrain, {name: drivetrain.definition.excitations[name] for name in lines})
    every = [line for group in lines.values() for line in group]
    search = CrossingSearch(held, drivetrain.title, reference, speed_range, every, None, 0.0, None)
    return tuple(search.nearest(mode, line) for line in every for mode in search.modes)


def excited_frequencies(line: OrderLine, speed_range: tuple[float, float]) -> tuple[float, float]:
    """Lowest and highest frequency in Hz, 0 or more, of an order line over a range of speeds in rad/s."""
    ends = line.frequency(np.array(speed_range))
    # A slip that changes its sign within the range passes 0 Hz.
    return (0.0 if ends[0] * ends[1] < 0 else float(np.abs(ends).min())), float(np.abs(ends).max())


def excited_lines(
    drivetrain: AssembledModel, speeds: ArrayLike | None, speed_of: str | None, excitations: Iterable[str] | None
) -> tuple[dict[str, list[OrderLine]], str, tuple[float, float]]:
    """Order lines by excitation, name of the reference node, and the operating range of its speed in rad/s.

    All are read from an order response at the ends of the range, which also refuses excitations that cannot act.
    """
    given = drivetrain.definition.speeds
    at = np.atleast_1d(np.asarray(given.values if given and speeds is None else () if speeds is None else speeds))
    ends = np.array([at.min(), at.max()]) if at.size else None if speeds is None else at
    reference = speed_of or (given and given.of) or drivetrain.nodes[0]
    run = orders_at_speeds(drivetrain, reference, speeds=ends, speed_of=speed_of, excitations=excitations)
    lines: dict[str, list[OrderLine]] = {}
    for line in run.lines:
        lines.setdefault(line.excitation, []).append(line)
    return lines, run.reference, (float(run.speeds[0]), float(run.speeds[-1]))


def _chosen_lines(known: Mapping[str, Sequence[OrderLine]], names: Iterable[str]) -> dict[str, list[OrderLine]]:
    """Order lines with the given names, by excitation."""
    wanted = {names} if isinstance(names, str) else set(names)
    given = [str(line) for group in known.values() for line in group]
    if missing := sorted(wanted - set(given)):
        raise UsageError(
            f"no order line is named {comma_list(missing)}; there are {comma_list(given)}", kind="unknown-name"
        )
    chosen = {name: [line for line in group if str(line) in wanted] for name, group in known.items()}
    return {name: group for name, group in chosen.items() if group}


def _with_dampers(drivetrain: AssembledModel, state: str, names: Iterable[str] | None) -> AssembledModel:
    definition = with_dampers(drivetrain.definition, drivetrain.exact_values, state, names)
    return drivetrain if definition is drivetrain.definition else drivetrain.with_definition(definition)


class CrossingSearch:
    """Search for critical speeds of a drivetrain's modes, with operating range in rad/s, margin and reach."""

    def __init__(
        self,
        drivetrain: AssembledModel,
        title: str,
        reference: str,
        speed_range: tuple[float, float],
        lines: Sequence[OrderLine],
        rule: MarginRule | None,
        reach: float,
        lowest: int | None,
        beside: Sequence[OrderLine] = (),
    ) -> None:
        self.drivetrain, self.title, self.speed_range = drivetrain, title, speed_range
        self.rule, self.reach, self.reference = rule, reach, reference
        self.limits = (speed_range[0] * (1 - reach), speed_range[1] * (1 + reach))
        self.known: dict[str, tuple[float, float]] = {}
        vibrations = vibration_modes(drivetrain, modes(drivetrain))
        self.modes = tuple(sorted(vibrations, key=lambda mode: mode.number))[:lowest]
        required = [margin for line in lines if rule and (margin := rule.required(line.order))]
        self.widest = max([reach, *required])
        highest = max((excited_frequencies(line, self.limits)[1] for line in (*lines, *beside)), default=0.0)
        self.over_speed = ModesOverSpeed(
            drivetrain, reference, speed_range, [mode.number for mode in vibrations],
            reach=self.widest, highest=FOLLOWED_ABOVE * highest,
        ).shared()  # fmt: skip
        self.turning = {
            node: speed
            for node, speed in speeds_by_reference(drivetrain.definition, drivetrain.exact_values, reference).items()
            if speed
        }

    def crossings(self, name: str, lines: Sequence[OrderLine]) -> list[CriticalSpeed]:
        """Critical speeds at which order lines of one excitation meet modes, near the operating range.

        Where the margin is less than required and they meet nowhere near it, that at which they are nearest.
        """
        crossings = [crossing for mode in self.modes for line in lines for crossing in self._near(mode, line)]
        excitation = self.drivetrain.definition.excitations.get(name)
        return crossings if excitation is None else list(self._with_forces(crossings, excitation, self.known[name]))

    def nearest(self, mode: VibrationMode, line: OrderLine) -> CriticalSpeed:
        """Place in the operating range where a line is nearest to a mode, with the margin between the two."""
        beside = LineOverModes.of(line, self.over_speed)
        points = [beside.nearest(mode.number, curve) for curve in (NATURAL, UNDAMPED)]
        # Rules are kept by both frequencies, with damping and without: the nearer one counts.
        there = [(0.0 if point.meets else abs(point.offset), point.speed) for point in points if point is not None]
        margin, speed = min(there, key=lambda pair: pair[0], default=(math.nan, math.nan))
        required = self.rule.required(line.order) if self.rule else None
        if not line.order and not self.over_speed.is_speed_dependent:
            speed = math.nan  # all speeds are as near
        return CriticalSpeed(
            mode, line.excitation, line.order, line.ratio, line.fixed, margin, required, nearest_speed=speed
        )

    def known_speeds(self, name: str, ratio: float) -> tuple[float, float]:
        """Lowest and highest operating speed in rad/s, widened by ``reach`` where the excitation's data cover that."""
        excitation = self.drivetrain.definition.excitations[name]
        low, high = (
            beyond if _has_torques(excitation, beyond * ratio) else end
            for beyond, end in zip(self.limits, self.speed_range, strict=True)
        )
        return low, high

    def notes(self) -> Iterator[str]:
        for where in operating_speed_notes(self.drivetrain.external_torques):
            yield f"{where}; critical speeds are found with the values at their own speed"
        yield from range_notes(self.drivetrain.assembly, [mode.damped_frequency for mode in self.modes])
        low, high = self.over_speed.known
        if low > self.limits[0] or high < self.limits[1]:
            ends = phrase("{low} to {high} rpm", low=screen_text(low * RPM, 6), high=screen_text(high * RPM, 6))
            yield f"tables and laws give the modes from {ends}; critical speeds beyond are unknown"
        for name, known in self.known.items():
            if known != self.limits:
                text = f"the data of {name} do not go beyond the operating range"
                yield f"{text}; at critical speeds outside, its torques are those at the nearer end"

    def _near(self, mode: VibrationMode, line: OrderLine) -> Iterator[CriticalSpeed]:
        """Yield the crossings of a line with a mode near the operating range, else their nearest place if that counts.

        It counts where the margin is less than required, or than the reach from a frequency without a speed.
        """
        beside = LineOverModes.of(line, self.over_speed)
        every = [beside.meetings(mode.number, curve) for curve in (UNDAMPED, NATURAL, DAMPED)]
        if self.rule is None and line.order and not any(every):
            return  # nothing that counts by its margin alone
        nearest = self.nearest(mode, line)
        is_close = nearest.margin < (nearest.required or 0.0)
        # A margin that a rule misses is listed with its crossing even beyond the reach asked for.
        reach, count = (self.widest if is_close else self.reach), 0
        low, high = self.speed_range[0] * (1 - reach), self.speed_range[1] * (1 + reach)
        for row in _crossings(every):
            main = row[NATURAL] or row[UNDAMPED]
            if main is not None and any(meeting is not None and low <= meeting.speed <= high for meeting in row):
                undamped, natural, damped = (math.nan if meeting is None else meeting.speed for meeting in row)
                there = self._mode_at(mode, main.speed)
                count += 1
                yield replace(
                    nearest,
                    mode=there,
                    undamped_speed=undamped,
                    natural_speed=natural,
                    damped_speed=damped,
                    leaps=math.isinf(main.slope),
                )
        if not count and (is_close or (not line.order and nearest.margin < self.reach)):
            yield replace(nearest, mode=self._mode_at(mode, nearest.nearest_speed))

    def _mode_at(self, mode: VibrationMode, speed: float) -> VibrationMode:
        """The mode of the same number at a speed in rad/s."""
        if not self.over_speed.is_speed_dependent or math.isnan(speed):
            return mode
        return next((other for other in self.over_speed.at(speed) if other.number == mode.number), mode)

    def _with_forces(
        self, near: Sequence[CriticalSpeed], excitation: OrderExcitation, known: tuple[float, float]
    ) -> Iterator[CriticalSpeed]:
        if not near:
            return
        # Torques at the critical speed, or at the nearest one that the data of the excitation cover.
        speeds = np.clip([self._acting_speed(crossing) for crossing in near], *known)
        torques = excitation.torques(speeds * float(near[0].ratio))
        frequencies = np.zeros(len(torques.orders)) if torques.fixed is None else torques.fixed
        lines = list(zip(torques.orders.tolist(), frequencies.tolist(), strict=True))
        # A torque drives the shaft it is on, whichever way that turns.
        senses = input_senses(self.drivetrain, excitation, self.reference)
        for number, crossing in enumerate(near):
            shape = dict(zip(self.drivetrain.assembly.nodes, crossing.mode.shape.tolist(), strict=True))
            largest = self._largest(shape, excitation.shaft)
            # A torque between two nodes works on their relative angle: phi_n - phi_reaction.
            still = shape.get(excitation.reaction_node or "", 0.0)
            shape |= {node: sense * (shape[node] - still) for node, sense in senses.items() if node in shape}
            at = number, lines.index((crossing.order, crossing.fixed))
            yield self._with_force(crossing, excitation, torques, at, shape, largest)

    def _with_force(
        self,
        crossing: CriticalSpeed,
        excitation: OrderExcitation,
        torques: OrderTorques,
        at: tuple[int, int],
        shape: Mapping[str, complex],
        largest: float,
    ) -> CriticalSpeed:
        if excitation.quantity != "torque":
            return replace(crossing, excited=bool(torques.amplitudes[at].any()))
        force = generalised_force(excitation, torques, at, shape, largest)
        title = phrase("{order}, mode {mode}", order=self.title, mode=crossing.mode.number) + (
            f", {force.case}" if force.case else ""
        )
        return replace(
            crossing,
            generalised_force=force.value,
            relative_force=force.relative,
            star=star_diagram(excitation, crossing.excitation, crossing.order, shape, title, force.part),
            excited=force.acts,
            case=force.case,
            force_by_case=force.by_case,
            modal_inertia=self._modal_inertia(crossing.mode),
        )

    def _modal_inertia(self, mode: VibrationMode) -> float:
        """Sum of J |phi|^2 over all inertias in kg m^2, for the mode shape whose largest angle is 1."""
        coordinates = mode.shape[self._coordinates]
        # phi^H M phi over the kept coordinates, in which M has all inertias with their reflected parts.
        return float((coordinates.conj() @ self.drivetrain.assembly.system.M @ coordinates).real)

    @cached_property
    def _coordinates(self) -> list[int]:
        """Indices of the kept coordinates among the nodes of a mode shape."""
        assembly = self.drivetrain.assembly
        return [assembly.node_index[name] for name in assembly.kinematics.coordinates]

    def _acting_speed(self, crossing: CriticalSpeed) -> float:
        """Critical speed in rad/s at which torques are taken, by natural frequency where that is in range."""
        low, high = self.limits
        speeds = (crossing.natural_speed, crossing.undamped_speed, crossing.damped_speed, crossing.nearest_speed)
        return next((speed for speed in speeds if low <= speed <= high), self.speed_range[1])

    def _largest(self, shape: Mapping[str, complex], shaft: str) -> float:
        """Largest magnitude of a mode shape's angles, each referred to a shaft by the ratio of mean speeds."""
        own = self.turning.get(shaft)
        if own is None:
            return abs(shape[shaft])
        # Angles referred to the shaft: phi times the shaft's speed over the own one, as reflection through gears
        # does.
        return max(abs(shape[node] * own / speed) for node, speed in self.turning.items() if node in shape)


def _has_torques(excitation: OrderExcitation, speed: float) -> bool:
    """Whether the torque data of an excitation cover a speed in rad/s of its shaft."""
    try:
        # An excitation refuses speeds outside its tables.
        excitation.torques(np.array([speed]))
    except UsageError:
        return False
    return True


def _crossings(every: Sequence[Sequence[Meeting]]) -> list[list[Meeting | None]]:
    """Crossings of a line and a mode, as meetings with the undamped, the natural and the damped frequency.

    Meetings with two of them are one crossing if they are nearest to each other and the line goes the same way there.
    """
    rows: list[list[Meeting | None]] = []
    for curve in (NATURAL, UNDAMPED, DAMPED):
        # Nearest pairs first, by the ratio of speeds; slopes of opposite signs are two passages of the line and not
        # one.
        pairs = sorted(
            (abs(math.log(meeting.speed / main.speed)), place, number)
            for place, row in enumerate(rows)
            for number, meeting in enumerate(every[curve])
            if (main := row[NATURAL] or row[UNDAMPED]) is not None
            and (meeting.slope * main.slope >= 0 or math.isinf(meeting.slope) or math.isinf(main.slope))
        )
        left = set(range(len(every[curve])))
        for _, place, number in pairs:
            if rows[place][curve] is None and number in left:
                rows[place][curve] = every[curve][number]
                left.remove(number)
        # A damped frequency by itself is no critical speed: it belongs to a natural one.
        alone = [every[curve][number] for number in sorted(left) if curve != DAMPED]
        rows += [[meeting if kind == curve else None for kind in (UNDAMPED, NATURAL, DAMPED)] for meeting in alone]
    return rows
