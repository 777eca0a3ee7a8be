"""Critical speeds at which an order of an excitation meets a natural frequency of a mode."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import UsageError
from torsionnet.core.listing import comma_list
from torsionnet.model.damper_states import AS_MODELLED, with_dampers
from torsionnet.model.excitations import OrderExcitation, OrderTorques
from torsionnet.model.operating_values import operating_speed_notes
from torsionnet.model.speeds import speeds_by_reference
from torsionnet.response.critical_speeds import FREQUENCY_FIELDS, CriticalSpeed, CriticalSpeeds
from torsionnet.response.margin_rules import MarginRule, margin_rule
from torsionnet.response.order_line import OrderLine
from torsionnet.response.vibrations.vibration_mode import VibrationMode
from torsionnet.solve.modes.mode_pairs import vibration_modes
from torsionnet.solve.modes.modes import modes
from torsionnet.solve.running.generalised_force import generalised_force, star_diagram
from torsionnet.solve.running.modes_over_speed import ModesOverSpeed
from torsionnet.solve.running.order_response import input_senses, order_response, with_motions_held
from torsionnet.solve.running.speed_peaks import with_speed_peaks

LINE_FREQUENCY = "line frequency"
"""Name of the excitation under which lines at 1 and 2 times the frequency of the electric grid are listed."""


def critical_speeds(
    drivetrain: AssembledModel,
    outputs: Any = (),
    *,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitations: Iterable[str] | None = None,
    lines: Iterable[str] | None = None,
    margin: str | float | MarginRule | None = None,
    reach: float = 0.25,
    lowest: int | None = None,
    line_frequency: float | None = None,
    dampers: str = AS_MODELLED,
    damper_names: Iterable[str] | None = None,
) -> CriticalSpeeds:
    """Critical speeds of a drivetrain near its operating range, with margins, forces and peaks.

    See :meth:`torsionnet.Drivetrain.critical_speeds`.
    """
    if not 0 <= reach < 1:
        raise UsageError(f"reach is a share of the speeds, 0 or more and below 1, got {reach}")
    if line_frequency is not None and not 0 < line_frequency < math.inf:
        raise UsageError(f"a line frequency is above 0 Hz, got {line_frequency}")
    rule = margin_rule(margin)
    changed = _with_dampers(drivetrain, dampers, damper_names)
    every, reference, speed_range = excited_lines(changed, speeds, speed_of, excitations)
    examined = every if lines is None else _chosen_lines(every, lines)
    # The vibrations are those with imposed motions held, as in the order response.
    held = with_motions_held(changed, {name: changed.definition.excitations[name] for name in examined})
    title = drivetrain.title + ("" if dampers == AS_MODELLED else f", damper ring {dampers}")
    search = CrossingSearch(held, title, reference, speed_range, rule, reach, lowest)
    search.known = {name: search.known_speeds(name, float(group[0].ratio)) for name, group in examined.items()}
    if line_frequency:
        examined[LINE_FREQUENCY] = [
            OrderLine(LINE_FREQUENCY, 0.0, Fraction(1), times * line_frequency) for times in (1, 2)
        ]
    crossings = [one for name, group in examined.items() for one in search.crossings(name, group)]
    crossings.sort(key=lambda one: (one.mode.number, one.excitation, one.order, one.fixed))
    found = CriticalSpeeds(
        reference=reference,
        speed_range=search.speed_range,
        modes=search.modes,
        crossings=tuple(crossings),
        lines=tuple(line for group in examined.values() for line in group),
        nodes=held.assembly.nodes,
        rule=search.rule,
        title=title,
        condition=drivetrain.configuration,
        notes=tuple(search.notes()),
    )
    if isinstance(outputs, (list, tuple)) and not outputs:
        return found
    ends = [search.limits, *search.known.values()]
    common = max(low for low, _ in ends), min(high for _, high in ends)
    limits = search.speed_range if search.over_speed.is_speed_dependent else common
    peaks, channels = with_speed_peaks(changed, found.crossings, outputs, reference, limits)
    return replace(found, crossings=peaks, outputs=channels)


def order_margins(
    drivetrain: AssembledModel, *, speeds: ArrayLike | None = None, excitations: Iterable[str] | None = None
) -> tuple[CriticalSpeed, ...]:
    """Crossings of every order line with every mode, however far away, with margins but no forces or peaks."""
    lines, reference, speed_range = excited_lines(drivetrain, speeds, None, excitations)
    held = with_motions_held(drivetrain, {name: drivetrain.definition.excitations[name] for name in lines})
    search = CrossingSearch(held, drivetrain.title, reference, speed_range, None, 0.0, None)
    return tuple(search.met(mode, line) for group in lines.values() for line in group for mode in search.modes)


def excited_frequencies(line: OrderLine, speed_range: tuple[float, float]) -> tuple[float, float]:
    """Lowest and highest frequency in Hz, 0 or more, of an order line over a range of speeds in rad/s."""
    ends = line.frequency(np.array(speed_range))
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
    run = order_response(drivetrain, reference, speeds=ends, speed_of=speed_of, excitations=excitations)
    lines: dict[str, list[OrderLine]] = {}
    for line in run.lines:
        lines.setdefault(line.excitation, []).append(line)
    return lines, run.reference, (float(run.speeds[0]), float(run.speeds[-1]))


def _chosen_lines(known: Mapping[str, Sequence[OrderLine]], names: Iterable[str]) -> dict[str, list[OrderLine]]:
    """Order lines with the given names, by excitation."""
    wanted = {names} if isinstance(names, str) else set(names)
    given = [str(line) for group in known.values() for line in group]
    if missing := sorted(wanted - set(given)):
        raise UsageError(f"no order line is named {comma_list(missing)}; there are {comma_list(given)}")
    found = {name: [line for line in group if str(line) in wanted] for name, group in known.items()}
    return {name: group for name, group in found.items() if group}


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
        rule: MarginRule | None,
        reach: float,
        lowest: int | None,
    ) -> None:
        self.drivetrain, self.title, self.speed_range = drivetrain, title, speed_range
        self.rule, self.reach, self.reference = rule, reach, reference
        self.limits = (speed_range[0] * (1 - reach), speed_range[1] * (1 + reach))
        self.known: dict[str, tuple[float, float]] = {}
        found = vibration_modes(drivetrain, modes(drivetrain))
        self.modes = tuple(sorted(found, key=lambda mode: mode.number))[:lowest]
        self.over_speed = ModesOverSpeed(drivetrain, reference, speed_range, [mode.number for mode in found])
        self.turning = {
            node: speed
            for node, speed in speeds_by_reference(drivetrain.definition, drivetrain.exact_values, reference).items()
            if speed
        }

    def crossings(self, name: str, lines: Sequence[OrderLine]) -> list[CriticalSpeed]:
        """Critical speeds at which order lines of one excitation meet modes, near the operating range."""
        blank = [self.met(mode, line) for mode in self.modes for line in lines]
        near = [one for one in blank if self._is_near(one)]
        excitation = self.drivetrain.definition.excitations.get(name)
        return near if excitation is None else list(self._with_forces(near, excitation, self.known[name]))

    def met(self, mode: VibrationMode, line: OrderLine) -> CriticalSpeed:
        """Critical speed at which an order line meets a mode, near the operating range or not."""
        return self._settled(self._crossing(mode, line), line)

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
            yield f"{where}; critical speeds are found with the values at this speed"
        for name, known in self.known.items():
            if known != self.limits:
                text = f"the data of {name} do not go beyond the operating range"
                yield f"{text}; at critical speeds outside, its torques are those at the nearer end"

    def _crossing(self, mode: VibrationMode, line: OrderLine) -> CriticalSpeed:
        low, high = excited_frequencies(line, self.speed_range)
        natural = [value for value in (mode.undamped_frequency, mode.natural_frequency) if not math.isnan(value)]
        margin = min(_distance(value, low, high) for value in natural)
        required = self.rule.required(line.order) if self.rule else None
        return CriticalSpeed(mode, line.excitation, line.order, line.ratio, line.fixed, margin, required)

    def _settled(self, one: CriticalSpeed, line: OrderLine) -> CriticalSpeed:
        """Crossing of an order line with a mode, by the mode at the critical speed itself if that depends on speed.

        It does where parameters follow the operating point.
        """
        if not self.over_speed.is_speed_dependent or not one.order:
            return one
        return self._crossing(self.over_speed.at_critical_speed(one.mode, self._natural(one)), line)

    @staticmethod
    def _natural(one: CriticalSpeed) -> Callable[[VibrationMode], float]:
        """Function from a mode to its critical speed in rad/s, by ``|lambda|/2pi``, else by undamped frequency."""
        which = "undamped" if math.isnan(one.mode.natural_frequency) else "natural"
        return lambda mode: replace(one, mode=mode).speed(which)

    def _is_near(self, one: CriticalSpeed) -> bool:
        if not one.order:
            return one.margin < max(self.reach, one.required or 0)
        low, high = self.limits
        return any(low <= one.speed(which) <= high for which in FREQUENCY_FIELDS)

    def _with_forces(
        self, near: Sequence[CriticalSpeed], excitation: OrderExcitation, known: tuple[float, float]
    ) -> Iterator[CriticalSpeed]:
        if not near:
            return
        speeds = np.clip([self._acting_speed(one) for one in near], *known)
        found = excitation.torques(speeds * float(near[0].ratio))
        frequencies = np.zeros(len(found.orders)) if found.fixed is None else found.fixed
        lines = list(zip(found.orders.tolist(), frequencies.tolist(), strict=True))
        # A torque drives the shaft it is on, whichever way that turns.
        senses = input_senses(self.drivetrain, excitation, self.reference)
        for number, one in enumerate(near):
            shape = dict(zip(self.drivetrain.assembly.nodes, one.mode.shape.tolist(), strict=True))
            largest = self._largest(shape, excitation.shaft)
            still = shape.get(excitation.reaction_node or "", 0.0)
            shape |= {node: sense * (shape[node] - still) for node, sense in senses.items() if node in shape}
            at = number, lines.index((one.order, one.fixed))
            yield self._with_force(one, excitation, found, at, shape, largest)

    def _with_force(
        self,
        one: CriticalSpeed,
        excitation: OrderExcitation,
        found: OrderTorques,
        at: tuple[int, int],
        shape: Mapping[str, complex],
        largest: float,
    ) -> CriticalSpeed:
        if excitation.quantity != "torque":
            return replace(one, excited=bool(found.amplitudes[at].any()))
        force = generalised_force(excitation, found, at, shape, largest)
        title = f"{self.title}, mode {one.mode.number}" + (f", {force.case}" if force.case else "")
        return replace(
            one,
            generalised_force=force.value,
            relative_force=force.relative,
            star=star_diagram(excitation, one.excitation, one.order, shape, title, force.part),
            excited=force.acts,
            case=force.case,
            modal_inertia=self._modal_inertia(one.mode),
        )

    def _modal_inertia(self, mode: VibrationMode) -> float:
        """Sum of J |phi|^2 over all inertias in kg m^2, for the mode shape whose largest angle is 1."""
        coordinates = mode.shape[self._coordinates]
        return float((coordinates.conj() @ self.drivetrain.assembly.system.M @ coordinates).real)

    @cached_property
    def _coordinates(self) -> list[int]:
        """Indices of the kept coordinates among the nodes of a mode shape."""
        assembly = self.drivetrain.assembly
        return [assembly.node_index[name] for name in assembly.kinematics.coordinates]

    def _acting_speed(self, one: CriticalSpeed) -> float:
        """Critical speed in rad/s at which torques are taken, by natural frequency where that is in range."""
        low, high = self.limits
        found = [one.speed(which) for which in ("natural", "undamped", "damped")]
        return next((speed for speed in found if low <= speed <= high), self.speed_range[1])

    def _largest(self, shape: Mapping[str, complex], shaft: str) -> float:
        """Largest magnitude of a mode shape's angles, each referred to a shaft by the ratio of mean speeds."""
        own = self.turning.get(shaft)
        if own is None:
            return abs(shape[shaft])
        return max(abs(shape[node] * own / speed) for node, speed in self.turning.items() if node in shape)


def _has_torques(excitation: OrderExcitation, speed: float) -> bool:
    """Whether the torque data of an excitation cover a speed in rad/s of its shaft."""
    try:
        excitation.torques(np.array([speed]))
    except UsageError:
        return False
    return True


def _distance(natural: float, low: float, high: float) -> float:
    """Distance of a natural frequency in Hz from the range low to high, over the range's nearer end; 0 inside."""
    if natural < low:
        return 1 - natural / low
    return natural / high - 1 if natural > high else 0.0
