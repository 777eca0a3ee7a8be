"""Vibration of an output over the speed of machinery on the explore page, and tests that the page lays over results."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.app.explore.state import State
from torsionnet.base.conventions import Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.frequency_response import DERIVATIVE_ORDERS, Channel, FloatArray, FrequencyResponse
from torsionnet.machinery.checks.section_checks import limit_subject
from torsionnet.machinery.limits import Limit
from torsionnet.machinery.limits.evidence import LimitSubject
from torsionnet.machinery.limits.shaft_limit import RoundSection
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.refined_response import is_periodic
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.machinery.verdicts.limit_verdict import FAIL, LimitVerdict
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan
from torsionnet.model.channels import Sensor, named_sensor
from torsionnet.model.elements import Values

if TYPE_CHECKING:
    from torsionnet.signals.orders.tracked_orders import MeasuredOrder


# Measured response that the explore page lays over the calculated one, and the misfit between both.

MOST_LINES = 4000
"""Largest number of measured frequencies that are drawn and compared; a screen has fewer columns of pixels."""


def matching_response(overlay: FrequencyResponse | None, state: State) -> FrequencyResponse | None:
    """Measured response of the output and input shown, in the quantity shown; None if the test holds no such pair."""
    if overlay is None:
        return None
    try:
        pair = overlay.select(state.output, state.input)
    except UsageError:
        return None
    is_motion = pair.outputs[0].unit in DERIVATIVE_ORDERS
    pair = getattr(pair, state.quantity)() if state.quantity and is_motion else pair
    return pair.between(np.nextafter(0, 1), np.inf)


def overlay_data(overlay: FrequencyResponse | None, state: State) -> dict[str, Any] | None:
    """Measured frequencies in Hz, magnitude in SI, phase in degrees and trust, at most :data:`MOST_LINES` of each."""
    pair = matching_response(overlay, state)
    if pair is None:
        return None
    step = -(-len(pair.frequencies) // MOST_LINES) or 1
    values, kept = pair.values[::step, 0, 0], slice(None, None, step)
    good = np.isfinite(values) & (values != 0)
    return {
        "frequencies": pair.frequencies[kept][good].tolist(),
        "magnitude": np.abs(values[good]).tolist(),
        "phase": np.degrees(np.angle(values[good])).tolist(),
        "trusted": _trusted(pair)[kept][good].tolist(),
        "unit": pair.unit(),
        "notes": list(map(str, pair.notes)),
    }


def _trusted(pair: FrequencyResponse) -> FloatArray:
    from torsionnet.signals.uncertainty import LEAST_COHERENCE  # loads what a page without a test can do without

    good = np.ones(len(pair.frequencies), dtype=bool)
    if pair.coherence is not None:
        good &= pair.coherence[:, 0, 0] >= LEAST_COHERENCE
    if pair.usable_up_to is not None:
        good &= pair.frequencies <= pair.usable_up_to
    return np.asarray(good)


def misfit(
    overlay: FrequencyResponse | None,
    state: State,
    respond: Callable[[FloatArray], FrequencyResponse],
    band: tuple[float, float],
) -> dict[str, Any] | None:
    """RMS difference in dB and degrees and the FRAC over the trusted lines of a test in the band.

    None where there is no test of this response, or no line that can be trusted.
    """
    pair = matching_response(overlay, state)
    if pair is None:
        return None
    from torsionnet.signals.comparison import difference, frac

    values = pair.values[:, 0, 0]
    good = _trusted(pair).astype(bool) & np.isfinite(values) & (values != 0)
    good &= (pair.frequencies >= band[0]) & (pair.frequencies <= band[1])
    lines = np.flatnonzero(good)
    lines = lines[:: -(-len(lines) // MOST_LINES) or 1]
    if not lines.size:
        return None
    test = FrequencyResponse(pair.frequencies[lines], pair.values[lines], pair.outputs, pair.inputs)
    model = respond(test.frequencies)
    if test.unit() != model.unit():
        return None
    apart = difference(test, model)
    return {
        "decibels": float(np.sqrt(np.mean(apart.decibels**2))),
        "degrees": float(np.sqrt(np.mean(apart.degrees**2))),
        "frac": float(frac(test, model)[0, 0]),
        "lines": int(lines.size),
    }


# Numbers and units as the explore page shows them.

CONVENTIONS_BY_ANGLE = {angle: Conventions(angle=angle) for angle in ("rad", "deg")}
"""Conventions by the unit of angles that is chosen on the page."""


def json_numbers(values: NDArray[np.float64]) -> list[float | None]:
    """List of numbers for JSON, with None for nan and inf, which JSON lacks."""
    if np.isfinite(values).all():
        return list(values.tolist())
    return [float(value) if np.isfinite(value) else None for value in values]


# Measured orders of a test that the explore page draws over the calculated ones while parameters slide.

MOST_DOTS = 1000
"""Largest number of measured speeds drawn of an order; a screen has about as many columns of pixels."""


def orders_of_test(path: str | os.PathLike[str] | None, output: Channel) -> tuple[MeasuredOrder, ...]:
    """Measured orders (SI) of an output in a file; empty without a file, or where it holds no such output."""
    if path is None:
        return ()
    from torsionnet.io.tracked_order_tables import read_orders  # loads what a page without a test can do without

    try:
        return read_orders(path, output)
    except UsageError:
        return ()


def tested_orders(run: OrderResponse, measured: Sequence[MeasuredOrder], most: int) -> list[dict[str, Any]]:
    """Measured orders as JSON data, amplitudes and half widths in SI over rpm, with the calculated curve and a verdict.

    Those of largest measured amplitude, at most ``most``; empty where none of them is calculated.
    """
    if not measured:
        return []
    from torsionnet.machinery.orders.order_comparison import (
        NO_INTERVAL,
        compared_orders,
    )  # loads what a page without a test does without

    try:
        pairs = compared_orders(run, None, measured)
    except UsageError:
        return []
    largest = sorted(pairs, key=lambda tested: -float(tested.measured.amplitude.max()))[:most]
    orders = []
    for tested in largest:
        step = -(-len(tested.measured.speeds) // MOST_DOTS)
        agreement, widths = tested.agreement, tested.pair.half_widths
        known = agreement.verdict != NO_INTERVAL and agreement.sentence
        phase = "" if agreement.phase_rms is None else f", phase {agreement.phase_rms:.3g}° RMS"
        apart = f"amplitude {agreement.peak:+.3g} %{phase}"
        orders.append({
            "name": f"order {tested.measured.order:g}",
            "curve": json_numbers(tested.curve),
            "rpm": json_numbers(tested.measured.speeds[::step] * RPM),
            "magnitude": json_numbers(tested.measured.amplitude[::step]),
            "half_widths": None if widths is None else json_numbers(np.asarray(widths[::step])),
            "verdict": f"{agreement.verdict}: {apart}" + (f"; {agreement.sentence}" if known else ""),
        })  # fmt: skip
    return orders


# Limits of a model on an output over speed, for the explore page: values allowed and ranges to be barred.

FEW_SPEEDS = 25
"""Number of speeds at which limits of a model with many cases of excitation are asked, to draw their curves alone."""
ROUGH_ENDS = "ends of barred ranges are found at the speeds of the plot; torsionnet limits finds them between these"
"""Note on barred ranges of the page, which are not refined as those of the command are."""
CURVES_ALONE = "ranges to be barred follow once nothing moves"
"""Note on limits of a model with several cases of excitation, whose barred ranges would hold up a slider."""


def speed_limits(rig: Drivetrain, run: OrderResponse, *, rough: bool = False) -> dict[str, Any]:
    """Allowed half ranges of the first output at the speeds of its run, and ranges to be barred, as JSON data.

    Allowed values are in the SI unit of the output: of a limit of stress, the torque that causes that stress. Ranges
    are barred by the limits of any output: a machine passes through all of them. No speeds are added to those of the
    run. With several cases of excitation a range is of the worst case at each speed, and named after the worst of all.

    Parameters
    ----------
    rig : Drivetrain
    run : OrderResponse
    rough : bool
        Only the limits of the first output, with several cases of excitation their curves alone.
    """
    subject, active = _active_limits(rig)
    output = run.outputs[0].name
    shown = named_sensor(output, rig.definition.sensors) or Sensor("angle", output)
    concerned = {
        name: limit
        for name, limit in active.items()
        if _factor(shown, limit.order_sensors(subject), 1.0, subject) is not None
    }
    cheap = rough and isinstance(run, WorstResponse)
    asked = concerned if rough else active
    if not asked:
        return {"limits": [], "barred": [], "limit_notes": []}
    speeds = _few(run.speeds, concerned.values(), subject) if cheap else run.speeds
    try:
        check = rig.check_limits(list(asked), speeds=speeds, refine=False)
    except UsageError as error:
        return {"limits": [], "barred": [], "limit_notes": [str(error)]}
    every = check.verdicts
    verdicts = [verdict for verdict in every if verdict.limit in concerned]
    curves = [
        {"name": _name(verdict), "allowed": json_numbers(np.interp(run.speeds, speeds, verdict.allowed / factor)),
         "in_passing": verdict.in_passing}
        for verdict, factor in _drawn(verdicts, concerned, shown, subject)
    ]  # fmt: skip
    drawn = {curve["name"] for curve in curves}
    others = [_name(verdict) for verdict in verdicts if _name(verdict) not in drawn]
    also = [f"torsionnet limits judges also {', '.join(others)}"] if others else []
    if cheap:
        return {"limits": curves, "barred": [], "limit_notes": [CURVES_ALONE, *also]}
    barred = [
        {
            "name": _name(verdict),
            "case": _case(verdict, span, check.cases),
            "from": span.low * RPM,
            "to": span.high * RPM,
        }
        for verdict in every
        for span in verdict.barred
    ]
    return {"limits": curves, "barred": barred, "limit_notes": [*_failures(every), *[ROUGH_ENDS][: len(barred)], *also]}


def _case(verdict: LimitVerdict, span: SpeedSpan, cases: Sequence[str]) -> str:
    """Name of the case of excitation that uses most of the value allowed in a barred range, empty of a single one."""
    if verdict.amplitudes is None or not cases:
        return ""
    inside = np.array([span.holds(speed) for speed in verdict.speeds])
    used = np.where(inside, np.nan_to_num(verdict.values / verdict.allowed, nan=-1.0), -np.inf)
    return cases[int(verdict.amplitudes.cases[int(np.argmax(used))])]


def _active_limits(rig: Drivetrain) -> tuple[LimitSubject, dict[str, Limit]]:
    """Subject that limits judge, and the limits that are not switched off."""
    subject = limit_subject(rig.definition, rig.exact_values)
    fitted = {name: limit.fitted(rig.definition.elements) for name, limit in rig.definition.limits.items()}
    return subject, {name: limit for name, limit in fitted.items() if not limit.switched_off(subject)}


def limited_output(rig: Drivetrain) -> str:
    """Name of the first stress or torque that a limit of the model judges over its speeds, empty where there is none.

    A torque that a limit of stress judges is shown as the stress.

    Examples
    --------
    >>> import torsionnet as tn
    >>> limited_output(tn.load("bulk_carrier")), limited_output(tn.load("amt_rig"))
    ('stress(int_shaft)', '')
    """
    if not runs(rig) or not rig.definition.limits:
        return ""
    subject, active = _active_limits(rig)
    judged = [sensor for limit in active.values() for sensor in limit.order_sensors(subject)]
    first = next((sensor for sensor in judged if sensor.quantity in ("stress", "torque")), None)
    if first is None:
        return ""
    stress = Sensor("stress", first.of)
    output = stress if _factor(stress, [first], 1.0, subject) is not None else first
    return next((name for name, sensor in rig.sensors.items() if sensor == output), str(output))


def _few(speeds: FloatArray, limits: Iterable[Limit], subject: LimitSubject) -> FloatArray:
    """Few speeds in rad/s from the first to the last, with those at which the limits' curves bend."""
    bends = np.array([speed for limit in limits for speed in limit.breaks(subject)])
    inside = bends[(bends > speeds[0]) & (bends < speeds[-1])]
    return np.unique(np.concatenate([np.linspace(speeds[0], speeds[-1], min(FEW_SPEEDS, len(speeds))), inside]))


def _drawn(
    verdicts: Sequence[LimitVerdict], limits: Mapping[str, Limit], shown: Sensor, subject: LimitSubject
) -> list[tuple[LimitVerdict, float]]:
    """Verdicts that judge the half range of the output, each with the factor from it to the judged value."""
    known: dict[tuple[str, str], float] = {}
    with_factors = []
    for verdict in verdicts:
        judged = limits[verdict.limit].vibratory_sensors(verdict.criterion, subject) if len(verdict.values) else None
        factor = None if judged is None else _factor(shown, *judged, subject)
        if verdict.in_passing:  # what may be reached in passing is of the same quantity as what is permitted for long
            factor = factor or known.get((verdict.limit, verdict.quantity))
        if factor is not None:
            known[verdict.limit, verdict.quantity] = factor
            with_factors.append((verdict, factor))
    return with_factors


def _failures(verdicts: Iterable[LimitVerdict]) -> list[str]:
    """Sentences on the limits that fail or hold up to a highest speed."""
    failing = [
        f"{_name(verdict)}: {verdict.remarks[0]}" for verdict in verdicts if verdict.verdict == FAIL and verdict.remarks
    ]
    return failing + [
        f"{_name(verdict)}: holds up to {verdict.highest * RPM:.4g} r/min"
        for verdict in verdicts
        if verdict.highest is not None
    ]


def _name(verdict: LimitVerdict) -> str:
    """Name of a limit with the symbol of its criterion, if it has one."""
    return verdict.limit if verdict.criterion in ("continuous", "all") else f"{verdict.limit} {verdict.criterion}"


def _factor(shown: Sensor, judged: Sequence[Sensor], factor: float, subject: LimitSubject) -> float | None:
    """Factor from the shown output to the judged value, None where it is something else.

    ``factor`` leads from the judged sensors to that value.
    """
    if shown in judged or shown in [replace(sensor, at=None) for sensor in judged]:
        return factor
    torque = any(sensor.of == shown.of and sensor.quantity == "torque" for sensor in judged)
    diameters = subject.elements[shown.of].diameters if shown.quantity == "stress" and torque else None
    if diameters is None:
        return None
    value = Values(subject.values)
    return factor * RoundSection(*(float(value(diameter)) for diameter in diameters)).modulus


MOST_ORDERS = 5
"""Largest number of orders over speed that are drawn beside their sum; more lines cannot be told apart."""
ROUGH_SPEEDS = 120
"""Number of speeds that are calculated while a slider moves; a plot has a few pixels for each."""


def runs(rig: Drivetrain) -> bool:
    """Whether the model has speeds and excitations."""
    return rig.definition.speeds is not None and bool(rig.definition.excitations)


def over_speed(
    rig: Drivetrain, output: str, *, rough: bool = False, test: str | os.PathLike[str] | None = None
) -> dict[str, Any]:
    """Half range of all orders and amplitudes of the largest ones over speed, as JSON data in SI with their units.

    With them the limits of the model that hold for the output, see :func:`.speed_limits`.

    Parameters
    ----------
    rig : Drivetrain
    output : str
    rough : bool
        At most :data:`ROUGH_SPEEDS` of the model's speeds.
    test : path, optional
        A file of measured orders, which are drawn instead of the largest ones.

    Raises
    ------
    UsageError
        The model has no speeds or excitations, or none act in this configuration.
    """
    given = rig.definition.speeds
    if given is None:
        raise UsageError(
            "over speed the page needs the entries speeds: and excitations: of the model", kind="missing-entry"
        )
    speeds, thinned = _thinned(np.array(given.values), ROUGH_SPEEDS if rough else len(given.values))
    # Periodic motion has the speeds at which it jumps besides, where ranges end.
    run = rig.order_response(output, speeds=speeds, refine=is_periodic(rig, None))
    unit = run.outputs[0].unit
    tested = tested_orders(run, orders_of_test(test, run.outputs[0]), MOST_ORDERS)
    return {
        "output": run.outputs[0].name,
        "units": {angle: shown.unit(unit) for angle, shown in CONVENTIONS_BY_ANGLE.items()},
        "scales": {angle: shown.scale(unit) for angle, shown in CONVENTIONS_BY_ANGLE.items()},
        "reference": run.reference,
        "rated": float(given.rated) * RPM if given.rated else None,
        "range": [min(given.values) * RPM, max(given.values) * RPM],
        "rpm": json_numbers(run.rpm),
        "total": run.sum_label,
        "half_range": json_numbers(run.half_range[:, 0]),
        "orders": [{"name": order["name"], "magnitude": order.pop("curve")} for order in tested] or _largest(run),
        "tested": tested,
        "count": len(run.lines),
        "lines": [{"name": str(line), "slope": float(line.relative) / 60, "fixed": line.fixed} for line in run.lines],
        "thinned": thinned or (rough and bool(rig.definition.limits)),
        "notes": list(map(str, run.notes)),
        **speed_limits(rig, run, rough=rough),
    }


def _thinned(speeds: FloatArray, most: int) -> tuple[FloatArray, bool]:
    """Selection of at most ``most`` speeds in rad/s, first and last among them, and whether any were left out."""
    if len(speeds) <= most:
        return speeds, False
    return speeds[np.linspace(0, len(speeds) - 1, most).round().astype(int)], True


def _largest(run: OrderResponse) -> list[dict[str, Any]]:
    """Names of the orders with the largest amplitudes and these over speed, in SI, the largest one first."""
    sizes = np.abs(run.values[:, :, 0])
    chosen = np.argsort(-sizes.max(axis=0), kind="stable")[:MOST_ORDERS]
    return [{"name": str(run.lines[line]), "magnitude": json_numbers(sizes[:, line])} for line in chosen.tolist()]
