"""Plot of a check of limits, orders and their sum over speed, with the limits and the speed ranges to be barred."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.equal_remarks import condition_words
from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_verdict import LimitVerdict
from torsionnet.machinery.verdicts.measured_range import MeasuredRange
from torsionnet.machinery.verdicts.order_peaks import vibratory_verdicts
from torsionnet.plot.drawing.labels import axis_label, axis_unit, speed_label, symbol
from torsionnet.plot.drawing.style import GivenAxes

MOST_LINES = 4
"""Largest number of orders drawn in a panel, those of largest amplitude; more would not fit beside it in the legend."""
LABEL_WIDTH = 34
"""Largest number of characters in a line of an axis label: as many as fit the height of a panel."""
LIMIT_DASHES = ("-", (0, (6, 2)), (0, (2, 1.5)))

DOTS: dict[str, Any] = {
    "linestyle": "none", "marker": "o", "markersize": 3.5, "color": style.INK, "markerfacecolor": "white",
}  # fmt: skip
"""Look of measured half ranges, told from the calculated line by being open dots."""


def limit_check(
    result: LimitCheck,
    limits: str | Sequence[str] | None = None,
    *,
    most: int = MOST_LINES,
    conventions: Conventions = SI,
    title: str | None = None,
    measured: Sequence[MeasuredRange] = (),
    ax: GivenAxes = None,
) -> Figure:
    """Figure of limited quantities over speed, with the largest orders in colours, their sum in black, limits in red.

    Ranges to be barred are shaded; measured half ranges are dots.

    Parameters
    ----------
    result : LimitCheck
    limits : str or sequence of str, optional
        By default all that were judged, one below the other.
    most : int
        Orders drawn.
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the check.
    measured : sequence of MeasuredRange, optional
        Half ranges of a test, each drawn where its limit is.
    ax : sequence of Axes, optional
        Axes to draw into, one for each limited quantity; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        No such limit, or none was judged.
    """
    names = [limits] if isinstance(limits, str) else limits
    panels = _panels(result, names)
    shows = [f"{verdicts[0].limit}, {verdicts[0].quantity}" for verdicts in panels]
    sheet, axes = style.stacked_panels(0.8 + 2.6 * len(panels), shows, ax)
    for panel, verdicts in zip(axes, panels, strict=True):
        own = [test for test in measured if any(test.limited is verdict for verdict in verdicts)]
        _draw(panel, result, verdicts, most, conventions, own)
    axes[-1].set_xlabel(speed_label(result.reference))
    if len(result.rpm) > 1:
        axes[-1].set_xlim(result.rpm[0], result.rpm[-1])
    return sheet.titled(result.title if title is None else title)


def _panels(check: LimitCheck, names: Sequence[str] | None) -> list[list[LimitVerdict]]:
    """List with the verdicts on limits of each panel, as a list of all verdicts of one limit on one quantity."""
    known = {verdict.limit for verdict in check.verdicts}
    for name in names or ():
        if name not in known:
            raise UsageError(
                f'no limit "{name}" was checked; there are {", ".join(sorted(known))}', kind="unknown-name"
            )
    panels: dict[tuple[str, str], list[LimitVerdict]] = {}
    for verdict in check.verdicts:
        if len(verdict.values) and (names is None or verdict.limit in names):
            panels.setdefault((verdict.limit, verdict.quantity), []).append(verdict)
    if not panels:
        raise UsageError(
            "nothing to draw: none of these limits could be judged; the table of limits says why",
            kind="missing-data",
        )
    return list(panels.values())


def _draw(
    panel: Axes,
    check: LimitCheck,
    verdicts: Sequence[LimitVerdict],
    most: int,
    conventions: Conventions,
    measured: Sequence[MeasuredRange],
) -> None:
    first = verdicts[0]
    known = [np.nanmax(verdict.allowed) for verdict in verdicts if np.isfinite(verdict.allowed).any()]
    sizes = [float(test.measured.max()) for test in measured]
    # One scale for values, limits and tests, by the largest of all.
    scale, unit = axis_unit(first.unit, float(max([*known, first.values.max(), *sizes])), conventions)
    for number, span in enumerate(span for verdict in verdicts for span in verdict.barred):
        # All spans are one entry of the legend.
        label = None if number else "to be barred"
        panel.axvspan(span.low * RPM, span.high * RPM, color=style.LIMIT_COLOR, alpha=0.12, linewidth=0, label=label)
    panel.plot(
        check.rpm,
        first.values * scale,
        color=style.INK,
        linewidth=2.0,
        label=first.quantity if first.orders is None else "all orders",
    )
    if first.orders is not None:
        for number, line in enumerate(np.argsort(-first.orders.max(axis=0), kind="stable")[:most].tolist()):
            amplitudes = first.orders[:, line] * scale
            panel.plot(check.rpm, amplitudes, label=check.lines[line], **style.line_style(number))
    for number, verdict in enumerate(verdicts):
        dashes = LIMIT_DASHES[number % len(LIMIT_DASHES)]
        panel.plot(
            check.rpm,
            verdict.allowed * scale,
            color=style.LIMIT_COLOR,
            linestyle=dashes,
            linewidth=1.6,
            label=verdict.criterion,
        )
    # A test that several criteria judge is drawn once.
    for test in {test.channel: test for test in measured}.values():
        panel.plot(test.speeds * RPM, test.measured * scale, label=f"test, {test.channel}", **DOTS)
    panel.set_title(f"{first.limit}: {first.of}, {first.quantity}", fontsize=style.FONT, color=style.INK, loc="left")
    panel.set_ylabel(axis_label(quantity_label(first), unit, LABEL_WIDTH))
    panel.set_ylim(bottom=0)
    style.legend_beside(panel)


def quantity_label(verdict: LimitVerdict) -> str:
    """Text with the name of the quantity that a limit restricts, with the output if the name does not tell it."""
    says = any(word in verdict.quantity for word in ("torque", "stress", "angle", "power"))
    return verdict.quantity if says else f"{verdict.of}, {verdict.quantity}"


# Plot of limited quantities over speed in all conditions, the worst one in black, others in grey, limits in red.

PANEL_HEIGHT = 2.1
"""Height in inches of the panel of one limited quantity: three rows of panels leave room for another picture on the
page."""
FAMILY_LABEL_WIDTH = 30
"""Largest number of characters in a line of an axis label: as many as fit the height of a panel."""
HEADROOM = 1.12
"""Factor from the largest value or limit drawn to the upper end of the axis."""
FARTHEST_LIMIT = 2.5
"""Ratio of a limit to the largest value, or to the lowest limit if that is higher, up to which its line is drawn; one
further away would flatten the curves, and its value stands at the upper edge instead."""


@dataclass(frozen=True, eq=False)
class LimitFamily:
    """Limited quantity in all conditions, as pairs of a condition's check of limits and verdicts on the quantity."""

    members: tuple[tuple[LimitCheck, tuple[LimitVerdict, ...]], ...]

    @property
    def worst(self) -> int:
        """Index, from 0, of the condition with the largest utilisation of the limit."""
        return int(np.argmax([max(map(_use, verdicts)) for _, verdicts in self.members]))


def limit_families(
    checks: Sequence[LimitCheck],
    limits: str | Sequence[str] | None = None,
    *,
    conventions: Conventions = SI,
    title: str = "",
    ax: GivenAxes = None,
) -> Figure:
    """Figure of vibratory stress or torque over speed in every condition with limit lines, a panel for each component.

    The condition with the largest value over the value allowed is black, the others are grey; limits are those of that
    condition, in red, and speed ranges that it bars are shaded.

    Parameters
    ----------
    checks : sequence of LimitCheck
        One for each condition.
    limits : str or sequence of str, optional
        Names of limits; default: all on vibration that were judged.
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
    ax : sequence of Axes, optional
        Axes to draw into, one for each limited quantity; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        None of these limits was judged by the orders of a vibration.

    Examples
    --------
    >>> import torsionnet as tn
    >>> ship = tn.load("bulk_carrier")
    >>> checks = [ship.configured(name).check_limits() for name in ship.configurations]
    >>> [axes.get_title(loc="left") for axes in limit_families(checks).axes]
    ['intermediate', 'propeller shaft', 'crank']
    """
    names = {limits} if isinstance(limits, str) else None if limits is None else set(limits)
    families = families_of(checks, names)
    if not families:
        raise UsageError(
            "nothing to draw: no limit on vibration could be judged; the table of limits says why",
            kind="missing-data",
        )
    columns = min(2, len(families))
    height = 0.3 * bool(title) + (PANEL_HEIGHT if columns > 1 else 3.0) * math.ceil(len(families) / columns)
    shows = [f"{first.limit}, {first.quantity}" for first in (family.members[0][1][0] for family in families)]
    sheet, _ = style.grid_panels(style.WIDTH, height, shows, ax, columns=columns)
    for panel, family in zip(sheet.panels, families, strict=True):
        _draw_family(panel, family, conventions)
    return sheet.titled(title)


def families_of(checks: Sequence[LimitCheck], names: set[str] | None = None) -> list[LimitFamily]:
    """List of curve families of limits on vibration, one for each limit and quantity, in the order of the model."""
    families: dict[tuple[str, str], dict[int, list[LimitVerdict]]] = {}
    for place, check in enumerate(checks):
        for verdict in vibratory_verdicts(check):
            if (names is None or verdict.limit in names) and verdict.worst is not None:
                families.setdefault((verdict.limit, verdict.quantity), {}).setdefault(place, []).append(verdict)
    return [
        LimitFamily(tuple((checks[place], tuple(verdicts)) for place, verdicts in members.items()))
        for members in families.values()
    ]


def _use(verdict: LimitVerdict) -> float:
    return -1.0 if verdict.worst is None else float(verdict.utilisation[verdict.worst])


def _draw_family(panel: Axes, family: LimitFamily, conventions: Conventions) -> None:
    check, verdicts = family.members[family.worst]
    first = verdicts[0]
    largest = max(float(np.nanmax(some[0].values)) for _, some in family.members)
    tops = [float(np.nanmax(verdict.allowed)) for verdict in verdicts]
    scale, unit = axis_unit(first.unit, max(largest, min(tops)), conventions)
    near = [top for top in tops if top <= FARTHEST_LIMIT * max(largest, min(tops))]
    top = HEADROOM * max([largest, *near]) * scale
    style.style_axes(panel)
    for span in (span for verdict in verdicts for span in verdict.barred):
        panel.axvspan(span.low * RPM, span.high * RPM, color=style.LIMIT_COLOR, alpha=0.08, linewidth=0)
    others = [member for place, member in enumerate(family.members) if place != family.worst]
    for number, (other, some) in enumerate(others):
        label = f"{len(others)} other condition{'s' * (len(others) > 1)}" if not number else None
        panel.plot(other.rpm, some[0].values * scale, color="#b3b3b3", linewidth=0.8, label=label, zorder=1.8)
    name = condition_words(check.configuration) or "all orders together"
    panel.plot(check.rpm, first.values * scale, color=style.INK, linewidth=1.8, label=name, zorder=2.5)
    for verdict in verdicts:
        _limit_line(panel, check, verdict, scale, top)
    panel.set_title(first.limit.replace("_", " "), fontsize=style.FONT, color=style.INK, loc="left", pad=25)
    panel.set_ylabel(axis_label(quantity_label(first), unit, FAMILY_LABEL_WIDTH), fontsize=style.SMALL)
    panel.set_xlabel(speed_label(check.reference), fontsize=style.SMALL)
    panel.set_ylim(0, top)
    if len(check.rpm) > 1:
        panel.set_xlim(check.rpm[0], check.rpm[-1])
    handles, labels = panel.get_legend_handles_labels()
    # The worst condition is named first.
    panel.legend(handles[::-1], labels[::-1], fontsize=style.SMALL - 1, frameon=False, loc="lower left",
                 bbox_to_anchor=(-0.02, 0.98), ncols=1, borderpad=0.2, labelspacing=0.2)  # fmt: skip


def _limit_line(panel: Axes, check: LimitCheck, verdict: LimitVerdict, scale: float, top: float) -> None:
    """Draw the line of a limit over speed in red, with its symbol where the line is farthest from the curve."""
    allowed = verdict.allowed * scale
    panel.plot(check.rpm, allowed, color=style.LIMIT_COLOR, linewidth=1.3, zorder=2.2)
    shown = np.flatnonzero(np.isfinite(allowed) & (allowed < top))
    if len(shown):
        at = int(shown[np.argmax(np.abs(allowed - verdict.values * scale)[shown])])
        right = check.rpm[at] > check.rpm.mean()
        place, text = (float(check.rpm[at]), float(allowed[at])), symbol(verdict.criterion)
    else:
        right = True
        lowest = float(np.nanmin(allowed))
        place, text = (float(check.rpm[-1]), top), f"{symbol(verdict.criterion)} from {lowest:.3g} on"
    above = place[1] < 0.9 * top
    panel.annotate(text, place, xytext=(-3 if right else 3, 2 if above else -2), textcoords="offset points",
                   ha="right" if right else "left", va="bottom" if above else "top", color=style.LIMIT_COLOR,
                   fontsize=style.SMALL)  # fmt: skip
