"""Critical speeds: every order of what runs against every mode."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import UsageError
from torsionnet.model.damper_states import AS_MODELLED, with_dampers
from torsionnet.model.excitations import OrderExcitation
from torsionnet.model.speeds import speeds_with
from torsionnet.response.critical_speeds import FREQUENCIES, CriticalSpeed, CriticalSpeeds
from torsionnet.response.margin_rules import MarginRule, margin_rule
from torsionnet.response.order_line import OrderLine
from torsionnet.response.vibration_mode import VibrationMode
from torsionnet.solve.generalised_force import generalised_force, star_diagram
from torsionnet.solve.mode_pairs import vibration_modes
from torsionnet.solve.modes import modes
from torsionnet.solve.modes_over_speed import ModesOverSpeed
from torsionnet.solve.order_response import order_response
from torsionnet.solve.speed_peaks import with_peaks

LINE = "line"
"""What lines at multiples of the line frequency are called."""


def critical_speeds(
    drivetrain: AssembledModel,
    outputs: Any = (),
    *,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitations: Iterable[str] | None = None,
    margin: str | float | MarginRule | None = None,
    reach: float = 0.25,
    lowest: int | None = None,
    line_frequency: float | None = None,
    dampers: str = AS_MODELLED,
    damper_names: Iterable[str] | None = None,
) -> CriticalSpeeds:
    """See :meth:`torsionnet.Drivetrain.critical_speeds`."""
    if not 0 <= reach < 1:
        raise UsageError(f"reach is a share of the speeds from 0 up to 1, got {reach}")
    if line_frequency is not None and not 0 < line_frequency < math.inf:
        raise UsageError(f"a line frequency is above 0 Hz, got {line_frequency}")
    rule = margin_rule(margin)
    changed = _with_dampers(drivetrain, dampers, damper_names)
    lines, reference, speed_range = _lines(changed, speeds, speed_of, excitations)
    question = _Question(changed, reference, speed_range, rule, reach, lowest)
    crossings = [one for name, group in lines.items() for one in question.of_excitation(name, group)]
    crossings += question.of_line(line_frequency) if line_frequency else []
    crossings.sort(key=lambda one: (one.mode.number, one.excitation, one.order, one.fixed))
    found = CriticalSpeeds(
        reference=reference,
        speed_range=question.speed_range,
        modes=question.modes,
        crossings=tuple(crossings),
        nodes=changed.assembly.nodes,
        rule=question.rule,
        title=drivetrain.title + ("" if dampers == AS_MODELLED else f", damper ring {dampers}"),
        condition=drivetrain.configuration,
    )
    if isinstance(outputs, (list, tuple)) and not outputs:
        return found
    limits = question.speed_range if question.over_speed.follow else question.limits
    peaks, channels = with_peaks(changed, found.crossings, outputs, reference, limits)
    return replace(found, crossings=peaks, outputs=channels)


def _lines(
    drivetrain: AssembledModel, speeds: ArrayLike | None, speed_of: str | None, excitations: Iterable[str] | None
) -> tuple[dict[str, list[OrderLine]], str, tuple[float, float]]:
    """Every line by its excitation, the reference node and the operating range.

    An order response at the ends of the range has them all, and refuses what cannot be answered.
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


def _with_dampers(drivetrain: AssembledModel, state: str, names: Iterable[str] | None) -> AssembledModel:
    definition = with_dampers(drivetrain.definition, drivetrain.exact_values, state, names)
    return drivetrain if definition is drivetrain.definition else drivetrain.with_definition(definition)


class _Question:
    """What all crossings have in common."""

    def __init__(
        self,
        drivetrain: AssembledModel,
        reference: str,
        speed_range: tuple[float, float],
        rule: MarginRule | None,
        reach: float,
        lowest: int | None,
    ) -> None:
        self.drivetrain, self.speed_range, self.rule, self.reach = drivetrain, speed_range, rule, reach
        self.limits = (speed_range[0] * (1 - reach), speed_range[1] * (1 + reach))
        self.modes = vibration_modes(drivetrain, modes(drivetrain))[:lowest]
        self.over_speed = ModesOverSpeed(drivetrain, reference, speed_range)
        self.turning = {
            node: speed
            for node, speed in speeds_with(drivetrain.definition, drivetrain.exact_values, reference).items()
            if speed
        }

    def of_excitation(self, name: str, lines: Sequence[OrderLine]) -> list[CriticalSpeed]:
        """Its lines against every mode."""
        blank = [self._settled(self._crossing(mode, name, line), line) for mode in self.modes for line in lines]
        near = [one for one in blank if self._is_near(one)]
        return list(self._with_forces(near, self.drivetrain.definition.excitations[name]))

    def of_line(self, line_frequency: float) -> list[CriticalSpeed]:
        """Once and twice the line frequency against every mode."""
        multiples = [_Fixed(times * line_frequency) for times in (1, 2)]
        blank = [self._crossing(mode, LINE, line) for mode in self.modes for line in multiples]
        return [one for one in blank if self._is_near(one)]

    def _crossing(self, mode: VibrationMode, name: str, line: OrderLine | _Fixed) -> CriticalSpeed:
        fixed = float(getattr(line, "fixed", 0.0))
        relative = line.order * float(line.ratio) / (2 * math.pi)
        ends = sorted(abs(relative * speed + fixed) for speed in self.speed_range)
        natural = [value for value in (mode.undamped_frequency, mode.natural_frequency) if not math.isnan(value)]
        margin = min(_distance(value, *ends) for value in natural)
        required = self.rule.required(line.order) if self.rule else None
        return CriticalSpeed(mode, name, line.order, line.ratio, fixed, margin, required)

    def _settled(self, one: CriticalSpeed, line: OrderLine) -> CriticalSpeed:
        """With the mode at the critical speed itself, where parameters follow the operating point."""
        if not self.over_speed.follow or not one.order:
            return one
        return self._crossing(self.over_speed.settled(one.mode, self._natural(one)), one.excitation, line)

    @staticmethod
    def _natural(one: CriticalSpeed) -> Callable[[VibrationMode], float]:
        """The critical speed of ``|lambda|/2pi``, else of the undamped frequency, for any mode in place of its own."""
        which = "undamped" if math.isnan(one.mode.natural_frequency) else "natural"
        return lambda mode: replace(one, mode=mode).speed(which)

    def _is_near(self, one: CriticalSpeed) -> bool:
        if not one.order:
            return one.margin < max(self.reach, one.required or 0)
        low, high = self.limits
        return any(low <= one.speed(which) <= high for which in FREQUENCIES)

    def _with_forces(self, near: Sequence[CriticalSpeed], excitation: OrderExcitation) -> Iterator[CriticalSpeed]:
        if not near:
            return
        found = excitation.torques(np.array([self._acting_speed(one) for one in near]) * float(near[0].ratio))
        fixed = getattr(found, "fixed", None)
        frequencies = np.zeros(len(found.orders)) if fixed is None else fixed
        lines = list(zip(found.orders.tolist(), frequencies.tolist(), strict=True))
        for number, one in enumerate(near):
            amplitudes = found.amplitudes[number, lines.index((one.order, one.fixed))]
            loads = dict(zip(found.nodes, amplitudes.tolist(), strict=True))
            yield self._with_force(one, excitation, loads, float(np.abs(found.amplitudes[number]).max()))

    def _with_force(
        self, one: CriticalSpeed, excitation: OrderExcitation, loads: Mapping[str, complex], strongest: float
    ) -> CriticalSpeed:
        if getattr(excitation, "quantity", "torque") != "torque":
            return replace(one, excited=any(loads.values()))
        # A torque drives the shaft it is on, whichever way that turns.
        shape = {
            node: value * math.copysign(1, self.turning.get(node, 1.0))
            for node, value in zip(self.drivetrain.assembly.nodes, one.mode.shape.tolist(), strict=True)
        }
        largest = self._largest(shape, excitation.shaft)
        force = generalised_force(excitation, one.order, loads, shape, largest, strongest)
        title = f"{self.drivetrain.title}, mode {one.mode.number}"
        return replace(
            one,
            generalised_force=abs(force.value),
            relative_force=force.relative,
            star=star_diagram(excitation, one.excitation, one.order, shape, title),
            excited=force.acts,
        )

    def _acting_speed(self, one: CriticalSpeed) -> float:
        """The critical speed at which the torques are taken: of the natural frequency where that is near."""
        low, high = self.limits
        found = [one.speed(which) for which in ("natural", "undamped", "damped")]
        return next((speed for speed in found if low <= speed <= high), self.speed_range[1])

    def _largest(self, shape: Mapping[str, complex], shaft: str) -> float:
        """Largest angle of a shape, referred to a shaft by the mean speeds."""
        own = self.turning.get(shaft)
        if own is None:
            return abs(shape[shaft])
        return max(abs(shape[node] * own / speed) for node, speed in self.turning.items() if node in shape)


@dataclass(frozen=True)
class _Fixed:
    """A line that does not follow the speed."""

    fixed: float
    order: float = 0.0
    ratio: Fraction = Fraction(1)


def _distance(natural: float, low: float, high: float) -> float:
    """From excitation frequencies between two, over the nearer of them; 0 inside."""
    if natural < low:
        return 1 - natural / low
    return natural / high - 1 if natural > high else 0.0
