"""Verdicts on the limits of a model in one condition, from order responses and mean torques over speed.

Speeds are added until the largest utilisation of every limit and the ends of its ranges are known.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import ModelError, UsageError, suggestion_or
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.checks.section_checks import limit_subject
from torsionnet.machinery.excitations.engine_entries import EngineEntries
from torsionnet.machinery.excitations.reciprocating_engine import running_engines_text
from torsionnet.machinery.excitations.speed_range import StartingRange
from torsionnet.machinery.limits import Limit, limit_rules
from torsionnet.machinery.limits.evidence import Evidence, LimitSubject
from torsionnet.machinery.limits.limit import LimitLine, merged_line
from torsionnet.machinery.mean.mean_solution import lost_power_notes, means_of
from torsionnet.machinery.mean.power_flow import power_flows, power_sensors
from torsionnet.machinery.orders.order_amplitudes import summed_orders
from torsionnet.machinery.orders.order_response import NOT_MET, OrderResponse
from torsionnet.machinery.orders.refined_response import ExaminedSpeeds, merged_responses
from torsionnet.machinery.orders.speed_refinement import refine_speeds, speeds_to_refine
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.machinery.passage.passage_solution import passage_response
from torsionnet.machinery.verdicts.limit_check import LimitCheck, PassedLimit, RunUpCheck
from torsionnet.machinery.verdicts.limit_verdict import (
    FAIL,
    OPEN,
    PASS,
    LimitVerdict,
    highest_permitted,
    listed_names,
    without_contradictions,
    without_narrow_windows,
)
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan, spans_above
from torsionnet.model.channels import Sensor
from torsionnet.model.definition import Definition, with_tangents
from torsionnet.model.elements import Values
from torsionnet.model.operating_values import running_notes

NO_CYCLE = "the shafts have no short common cycle: half ranges of the shafts are added"
"""Text of the note of a limit check whose orders repeat only after many revolutions, so that half ranges are added."""
RUN_IN_SHARE = 0.25
"""Share of the width of the speeds at which a limit is exceeded by which their passage begins before and ends behind
them, where vibration is small and steady."""
MISFIRING, UNLOADED = "a cylinder misfires in this condition", "a cylinder is unloaded in this condition"
"""Texts of the note of a limit check in a condition in which an engine, or a compressor alone, has a cylinder out."""


def check_limits(
    drivetrain: AssembledModel,
    limits: str | Iterable[str] | None = None,
    *,
    speeds: ArrayLike | None = None,
    excitation: str | Iterable[str] | None = None,
    refine: bool | None = None,
    nonlinear: str | None = None,
) -> LimitCheck:
    """Verdicts on the model's limits over speed, and barred ranges.

    Parameters
    ----------
    limits : str or iterable of str, optional
        Names of limits of the model; default: all.
    speeds, excitations
        As for :meth:`order_response`.
    refine : bool, optional
        Whether speeds between these are examined as well, until the largest value over value allowed and the ends
        of ranges are known to 0.1 %; the result has them among its speeds. Default: yes, but for a model whose
        speeds are a list, which is all that is examined then.
    nonlinear : {"linear", "periodic"}, optional
        As for :meth:`order_response`: with ``"periodic"`` the largest stable motion is judged, and where none was found
        that is stable, a limit that would hold is not judged.

    Raises
    ------
    UsageError
        The model has no limits, speeds or excitations, or unknown names.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...     tn.Shaft("shaft", nodes=("a", "b"), outer_diameter="20 mm", length=1)]
    >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["600 rpm"]},
    ...     excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}},
    ...     limits={"shaft": {"rule": "curve", "output": "stress(shaft)", "value": "40 MPa", "source": "maker"}})
    >>> fan.check_limits().of("shaft").verdict
    'pass'
    """
    return _check(drivetrain, limits, speeds, excitation, refine, nonlinear, starts=True)


def limits_at(drivetrain: AssembledModel, speeds: FloatArray) -> LimitCheck:
    """Check of all limits of a model at some speeds in rad/s alone, without its starts."""
    return _check(drivetrain, None, speeds, None, False, None, starts=False)


def _check(
    drivetrain: AssembledModel,
    limits: str | Iterable[str] | None,
    speeds: ArrayLike | None,
    excitations: Iterable[str] | None,
    refine: bool | None,
    nonlinear: str | None,
    *,
    starts: bool,
) -> LimitCheck:
    """Check of limits over speed, with that of starts along the model's run-up where these are asked for."""
    chosen = {name: limit.fitted(drivetrain.definition.elements)
              for name, limit in _chosen_limits(drivetrain.definition.limits, limits).items()}  # fmt: skip
    subject = limit_subject(drivetrain.definition, drivetrain.exact_values)
    asked = excitations if excitations is None or isinstance(excitations, str) else tuple(excitations)
    examined = ExaminedSpeeds.of(drivetrain, speeds, excitations=asked, refine=refine, nonlinear=nonlinear)
    examination = _Examination(drivetrain, subject, chosen, asked, examined)
    # Where the values allowed jump or bend, the speed itself is examined.
    breaks = np.array([speed for limit in chosen.values() for speed in limit.breaks(subject)])
    curves, verdicts = examination.examined(examined.first(breaks))
    run, evidence = curves.run, curves.evidence
    run_up = _run_up(examination, evidence) if starts else None
    notes = [NO_CYCLE] * (run.revolutions is None)
    notes += [_cylinder_note(drivetrain.definition)] * subject.misfiring + [*run.engine_notes]
    notes += lost_power_notes(drivetrain, float(run.speeds[-1])) if evidence.means else ()
    notes += [running] if (running := running_engines_text(drivetrain.definition.excitations)) else []
    about = run.notes if examined.periodic else running_notes(drivetrain.definition)
    notes += (*about, *range_notes(drivetrain.assembly, np.abs(run.frequencies)))
    return LimitCheck(
        run.speeds, run.reference, verdicts, tuple(map(str, run.lines)), drivetrain.title, drivetrain.configuration,
        subject.misfiring, tuple(notes), drivetrain.configurations, drivetrain.other_configurations,
        _left_out(drivetrain.definition, chosen, excitations), run_up, summed_orders(run),
        run.labels if isinstance(run, WorstResponse) else (), subject.rated, subject.propels,
    )  # fmt: skip


def _run_up(running: _Examination, evidence: Evidence) -> RunUpCheck | None:
    """Verdicts on what the limits permit while the speeds of a start are passed; None where the model has no run-up."""
    drivetrain = running.drivetrain
    speeds = drivetrain.definition.speeds
    if speeds is None or speeds.run_up is None:
        return None
    run_up = speeds.run_up
    acting, loaded = at_load(drivetrain, run_up.load)
    passed = ExaminedSpeeds.of(
        acting, run_up.speeds(speeds.step), speed_of=speeds.of, excitations=running.excitations, refine=True,
        nonlinear=running.speeds.nonlinear,
    )  # fmt: skip
    try:
        examination = _Examination(
            acting, running.subject, running.limits, running.excitations, passed, loaded, evidence.rated_means
        )
        examined = examination.resolved(examination.at(passed.first(np.empty(0))))
    except UsageError as error:
        raise UsageError(f"run-up: {error}", kind=error.kind) from None
    judged = []
    for (name, limit), lines in zip(running.limits.items(), examined.lines, strict=True):
        for line in lines:
            if not line.absent and (line.why_not or np.isfinite(line.allowed).any()):
                steady = limit.while_passed(line, name, examined.evidence)
                judged.append(_at_its_rate(examination, run_up, limit, examined.evidence, steady))
    return RunUpCheck(*run_up.range, speeds.of, run_up.load, run_up.rate, tuple(judged))


def _at_its_rate(
    running: _Examination, run_up: StartingRange, limit: Limit, evidence: Evidence, steady: LimitVerdict
) -> PassedLimit:
    """Verdict on a limit that steady vibration exceeds, by the vibration while the speed rises at its rate."""
    is_open = steady.verdict in (FAIL, OPEN)
    sensors_and_factor = limit.passing_sensors(steady.criterion, running.subject) if is_open else None
    # The passage is that of a linear drivetrain: motions that jump are judged as if each speed lasted.
    if run_up.rate is None or sensors_and_factor is None or not len(steady.values) or running.speeds.periodic:
        return PassedLimit(steady)
    sensors, factor = sensors_and_factor
    above = spans_above(steady.speeds, steady.values, steady.allowed)
    wide = RUN_IN_SHARE * (above[-1].high - above[0].low)
    # Only the speeds around those at which the steady value is too large are passed in time.
    span = SpeedSpan(above[0].low - wide, above[-1].high + wide).within(SpeedSpan(*run_up.range))
    run = passage_response(
        running.drivetrain, sensors, [0.0, (span.high - span.low) / run_up.rate], [span.low, span.high],
        speed_of=running.speeds.reference, excitation=running.excitations,
    )  # fmt: skip
    peak = max((run.peak(str(sensor)) for sensor in sensors), key=lambda at_sensor: at_sensor.half_range)
    # The mean part of the value, as of T_mean + T_v, is the same whether the speed rises or not.
    mean = float(np.max(steady.values - factor * evidence.size(sensors)))
    return PassedLimit(steady, factor * peak.half_range + mean, peak.rpm)


def at_load(drivetrain: AssembledModel, share: float) -> tuple[AssembledModel, AssembledModel]:
    """Copies of a drivetrain at a share of its load: with the engines at that share, and with their pressures kept.

    The first gives the vibration, the second the mean torques, which the load alone makes smaller.
    """
    definition = drivetrain.definition
    load = None if definition.load is None else definition.load.at_share(share)
    loaded = with_tangents(replace(definition, load=load))
    engines = {name: excitation.at_load(share) for name, excitation in definition.excitations.items()}
    acting = replace(loaded, excitations=engines)
    return drivetrain.with_definition(acting), drivetrain.with_definition(loaded)


def _cylinder_note(definition: Definition) -> str:
    out = [
        engine
        for engine in definition.excitations.values()
        if isinstance(engine, EngineEntries) and engine.has_lost_cylinder
    ]
    return UNLOADED if all(engine.absorbs for engine in out) else MISFIRING


def _left_out(definition: Definition, limits: Iterable[str], excitations: Iterable[str] | None) -> tuple[str, ...]:
    """Sentences that name the limits and excitations of the model that were not examined."""
    examined = {
        "limits": set(limits),
        "excitations": set(definition.excitations if excitations is None else excitations),
    }
    known = {"limits": definition.limits, "excitations": definition.excitations}
    missing = {what: [name for name in known[what] if name not in examined[what]] for what in known}
    return tuple(f"{what} not examined: {listed_names(names)}" for what, names in missing.items() if names)


@dataclass(frozen=True, eq=False)
class _Examined:
    """Order responses and mean values at some speeds in rad/s, and from them each limit's curves over speed."""

    evidence: Evidence
    lines: tuple[tuple[LimitLine, ...], ...]

    @property
    def run(self) -> OrderResponse:
        return self.evidence.run


@dataclass(frozen=True, eq=False)
class _Examination:
    """Drivetrain with the limits, excitations and speeds of a limit check."""

    drivetrain: AssembledModel
    subject: LimitSubject
    limits: Mapping[str, Limit]
    excitations: Any
    speeds: ExaminedSpeeds
    loaded: AssembledModel | None = None
    """Drivetrain with the mean torques of a run-up; None where speeds are examined in continuous operation."""
    known_rated: Mapping[Sensor, float] = field(default_factory=dict)
    """Mean values at rated speed that are known already, in SI units by sensor."""
    run_below: float | None = None
    """Highest speed in rad/s that is permitted below the speed bands of limits; None where these are run."""

    def at(self, speeds: FloatArray) -> _Examined:
        """Order responses, mean values and limit curves over the speeds (n_speeds,) in rad/s of the reference shaft."""
        run = self.speeds.response(self.drivetrain, self._sensors, speeds, self.excitations)
        means, why = _means(self.loaded or self.drivetrain, self.subject, self._here, run.speeds)
        full = self.known_rated or self._full_load
        return self.judged_by(Evidence(run, means, why, self.subject, full, self._idle, self.run_below))

    def judged_by(self, evidence: Evidence) -> _Examined:
        """The limits' curves over the speeds of some evidence."""
        lines = [
            limit.known_lines(evidence) if self.loaded is None else limit.lines_in_passing(evidence)
            for limit in self.limits.values()
        ]
        return _Examined(evidence, tuple(map(tuple, lines)))

    @cached_property
    def _here(self) -> list[Limit]:
        """Limits to check whose elements are not switched off in this condition."""
        return [limit for limit in self.limits.values() if not limit.switched_off(self.subject)]

    @cached_property
    def _sensors(self) -> list[Sensor]:
        return _seen(self.subject, self._here)

    @cached_property
    def _rated(self) -> dict[Sensor, float]:
        """Mean value in SI units at the rated speed by sensor, empty where that speed is not examined.

        That of all cylinders working, also where one is lost: shares of a rule are of the rated torque.
        """
        rated, (low, high) = self.subject.rated, self.speeds.ends
        if rated is None or not low * (1 - 1e-9) <= rated <= high * (1 + 1e-9):
            return {}
        return self._working_at(rated)

    def _working_at(self, speed: float) -> dict[Sensor, float]:
        """Mean value in SI units by sensor at a speed in rad/s with all cylinders working."""
        means, _ = _means(self.drivetrain, self.subject, self._here, np.array([speed]), all_working=True)
        return {sensor: float(values[0]) for sensor, values in means.items()}

    @cached_property
    def _idle(self) -> frozenset[Sensor]:
        """Sensors whose mean value is zero in this condition at rated or the highest speed, as nothing drives there."""
        known = self._rated or self._working_at(self.speeds.ends[1])
        return frozenset(sensor for sensor, value in known.items() if not value)

    @cached_property
    def _full_load(self) -> dict[Sensor, float]:
        """Mean value in SI units at the rated speed and full load by sensor, to which shares of a rule refer.

        That of this condition, or of the model as written where it is larger: at zero pitch or with one engine of two
        a mesh transmits less than it is made for, and may not reach rated speed.
        """
        shares = [limit for limit in self._here if limit.of_full_load]
        if not shares or self.subject.rated is None or not self.drivetrain.configuration:
            return self._rated
        try:
            written = self.drivetrain.as_written()
        except ModelError:
            return self._rated
        means, _ = _means(written, self.subject, shares, np.array([self.subject.rated]), all_working=True)
        larger = {
            sensor: max(self._rated.get(sensor, 0.0), float(values[0]), key=abs) for sensor, values in means.items()
        }
        return self._rated | larger

    def examined(self, speeds: FloatArray) -> tuple[_Examined, tuple[LimitVerdict, ...]]:
        """Curves and settled verdicts over the speeds (n,) in rad/s, and over those that resolve the curves."""
        curves = self.resolved(self.at(speeds))
        verdicts = self.verdicts(curves)
        top = highest_permitted(verdicts, curves.run.speeds)
        bands = [verdict.running for verdict in verdicts if verdict.running]
        # Where no speed remains, limits keep their bands.
        remains = top is not None and top > curves.run.speeds[0] * (1 + 1e-9)
        if top is not None and remains and bands and all(band.low >= top * (1 - 1e-9) for band in bands):
            # No speed of a band is permitted: the machine runs below, where its limits are judged, too.
            below = replace(self, run_below=top)
            curves = below.resolved(below.judged_by(replace(curves.evidence, run_below=top)))
            verdicts = below.verdicts(curves)
        return curves, without_contradictions(verdicts, curves.run.speeds)

    def resolved(self, curves: _Examined) -> _Examined:
        """Curves at further speeds, so many that peaks and ends of ranges are known, if that is asked for."""
        return refine_speeds(curves, self.wanted, self.with_more) if self.speeds.refine else curves

    def verdicts(self, curves: _Examined) -> tuple[LimitVerdict, ...]:
        """Verdicts of all limits on their curves, each by itself."""
        limits = zip(self.limits.items(), curves.lines, strict=True)
        every = tuple(
            verdict for (name, limit), lines in limits for verdict in limit.verdicts(name, curves.evidence, lines)
        )
        # A limit that only motions keep that are not met is not known to hold.
        unmet = curves.run.unmet.any()
        known = [
            replace(verdict, verdict=OPEN, remarks=(*verdict.remarks, phrase(NOT_MET)))
            if unmet and verdict.verdict == PASS
            else verdict
            for verdict in every
        ]
        kept = [self.subject.rated, *(limit.kept_free(self.subject) for limit in self._here)]
        return without_narrow_windows(known, curves.run.speeds, kept)

    def wanted(self, curves: _Examined) -> FloatArray:
        """Speeds (n,) in rad/s to add where the curves of the limits are not resolved yet."""
        lines = [line for group in curves.lines for line in group if not line.why_not]
        if not lines:
            return np.empty(0)
        used = np.stack([line.utilisation for line in lines], axis=1)
        tops = [column for line in lines for column in _tops(curves.run.speeds, line)]
        # Utilisation 1 is where a range to be barred begins and ends; its top decides how wide it is usually barred.
        by_level = speeds_to_refine(curves.run.speeds, used, 1.0)
        by_top = speeds_to_refine(curves.run.speeds, np.stack(tops, axis=1)) if tops else np.empty(0)
        return np.unique(np.concatenate([by_level, by_top]))

    def with_more(self, curves: _Examined, speeds: FloatArray) -> _Examined:
        """Responses and limit curves at the speeds known so far and at further ``speeds`` in rad/s, sorted by speed."""
        if self.speeds.periodic:  # all together along the same branches
            return self.at(np.union1d(curves.run.speeds, speeds))
        more = self.at(speeds)
        run, order = merged_responses(curves.run, more.run)
        means = {
            sensor: np.concatenate([values, more.evidence.means[sensor]])[order]
            for sensor, values in curves.evidence.means.items()
        }
        evidence = replace(curves.evidence, run=run, means=means)
        lines = tuple(
            tuple(merged_line(pair, order) for pair in zip(*groups, strict=True))
            for groups in zip(curves.lines, more.lines, strict=True)
        )
        return _Examined(evidence, lines)


def _tops(speeds: FloatArray, line: LimitLine) -> list[FloatArray]:
    """Curves (n_speeds,) of a limit, one for each range of speeds above the allowed value, NaN outside that range."""
    if line.in_passing:
        return []
    return [
        np.where((speeds >= span.low) & (speeds <= span.high), values, np.nan)
        for values in line.each.T
        for span in spans_above(speeds, values, line.allowed)
    ]


def _chosen_limits(known: Mapping[str, Limit], names: str | Iterable[str] | None) -> dict[str, Limit]:
    if not known:
        rules = ", ".join(limit_rules())
        raise UsageError(
            f"the model has no limits; give them in its entry limits: {{name: {{rule: ...}}}}, rules are {rules}",
            kind="missing-entry",
        )
    wanted = list(known) if names is None else [names] if isinstance(names, str) else list(names)
    for name in wanted:
        if name not in known:
            hint = suggestion_or(name, known, f"there are {', '.join(known)}")
            raise UsageError(f'no limit is named "{name}"{hint}', kind="unknown-name")
    return {name: known[name] for name in wanted}


def _seen(subject: LimitSubject, limits: Sequence[Limit]) -> list[Sensor]:
    """Sensors of torques, twists and stresses that the limits need, each once."""
    sensors_needed = [sensor for limit in limits for sensor in limit.order_sensors(subject)]
    for limit in limits:
        for name in limit.power_elements():
            sensors_needed += power_sensors(power_flows(subject.active[name], Values(subject.values)))
    if not sensors_needed:
        text = "all elements with limits are switched off in this condition"
        raise UsageError(f"{text}; check limits in a configuration that has them on", kind="switched-off")
    return list(dict.fromkeys(sensors_needed))


def _means(
    drivetrain: AssembledModel,
    subject: LimitSubject,
    limits: Sequence[Limit],
    speeds: FloatArray,
    *,
    all_working: bool = False,
) -> tuple[dict[Sensor, FloatArray], str]:
    """Mean values (n_speeds,) in SI units by sensor that the limits need, and why some are unknown ("" if none is)."""
    sensors = list(dict.fromkeys(sensor for limit in limits for sensor in limit.mean_sensors(subject)))
    try:
        values = means_of(drivetrain, sensors, speeds, all_working=all_working).values if sensors else np.empty((0, 0))
    except UsageError as error:
        if len(sensors) == 1:
            return {}, str(error)
        return _one_by_one(drivetrain, sensors, speeds, all_working=all_working)
    return dict(zip(sensors, values.T, strict=False)), ""


def _one_by_one(
    drivetrain: AssembledModel, sensors: Sequence[Sensor], speeds: FloatArray, *, all_working: bool
) -> tuple[dict[Sensor, FloatArray], str]:
    """Mean values (n_speeds,) in SI units by sensor, and why some are unknown, asked sensor by sensor.

    See :func:`_means`.
    """
    means: dict[Sensor, FloatArray] = {}
    why = ""
    for sensor in sensors:
        try:
            means[sensor] = means_of(drivetrain, sensor, speeds, all_working=all_working).values[:, 0]
        except UsageError as error:
            why = str(error)
    return means, why
