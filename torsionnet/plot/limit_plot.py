"""Plot of a check of limits, orders and their sum over speed, with the limits and the speed ranges to be barred."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.machinery.verdicts.limit_check import LimitCheck, LimitVerdict
from torsionnet.machinery.verdicts.measured_range import MeasuredRange
from torsionnet.plot.drawing.torque_units import axis_label, axis_unit, speed_label

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
    check: LimitCheck,
    limits: str | Sequence[str] | None = None,
    *,
    most: int = MOST_LINES,
    conventions: Conventions = SI,
    title: str | None = None,
    measured: Sequence[MeasuredRange] = (),
) -> Figure:
    """Figure of limited quantities over speed, with the largest orders in colours, their sum in black, limits in red.

    Ranges to be barred are shaded; measured half ranges are dots.

    Parameters
    ----------
    check : LimitCheck
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

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        No such limit, or none was judged.
    """
    names = [limits] if isinstance(limits, str) else limits
    panels = _panels(check, names)
    figure = style.new_figure(style.WIDTH, 0.8 + 2.6 * len(panels))
    axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for panel, verdicts in zip(axes, panels, strict=True):
        own = [one for one in measured if any(one.limited is verdict for verdict in verdicts)]
        _draw(panel, check, verdicts, most, conventions, own)
    axes[-1].set_xlabel(speed_label(check.reference))
    if len(check.rpm) > 1:
        axes[-1].set_xlim(check.rpm[0], check.rpm[-1])
    style.set_title(figure, check.title if title is None else title)
    return figure


def _panels(check: LimitCheck, names: Sequence[str] | None) -> list[list[LimitVerdict]]:
    """List with the verdicts on limits of each panel, as a list of all verdicts of one limit on one quantity."""
    known = {one.limit for one in check.verdicts}
    for name in names or ():
        if name not in known:
            raise UsageError(f'no limit "{name}" was checked; there are {", ".join(sorted(known))}')
    found: dict[tuple[str, str], list[LimitVerdict]] = {}
    for one in check.verdicts:
        if len(one.values) and (names is None or one.limit in names):
            found.setdefault((one.limit, one.quantity), []).append(one)
    if not found:
        raise UsageError("nothing to draw: none of these limits could be judged; the table of limits says why")
    return list(found.values())


def _draw(
    panel: Axes,
    check: LimitCheck,
    verdicts: Sequence[LimitVerdict],
    most: int,
    conventions: Conventions,
    measured: Sequence[MeasuredRange],
) -> None:
    first = verdicts[0]
    known = [np.nanmax(one.allowed) for one in verdicts if np.isfinite(one.allowed).any()]
    sizes = [float(one.measured.max()) for one in measured]
    scale, unit = axis_unit(first.unit, float(max([*known, first.values.max(), *sizes])), conventions)
    style.style_axes(panel)
    for number, span in enumerate(span for one in verdicts for span in one.barred):
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
            panel.plot(check.rpm, first.orders[:, line] * scale, label=check.lines[line], **style.line_style(number))
    for number, one in enumerate(verdicts):
        dashes = LIMIT_DASHES[number % len(LIMIT_DASHES)]
        panel.plot(
            check.rpm,
            one.allowed * scale,
            color=style.LIMIT_COLOR,
            linestyle=dashes,
            linewidth=1.6,
            label=one.criterion,
        )
    for test in {one.channel: one for one in measured}.values():
        panel.plot(test.speeds * RPM, test.measured * scale, label=f"test, {test.channel}", **DOTS)
    panel.set_title(f"{first.limit}: {first.of}, {first.quantity}", fontsize=style.FONT, color=style.INK, loc="left")
    panel.set_ylabel(axis_label(quantity_label(first), unit, LABEL_WIDTH))
    panel.set_ylim(bottom=0)
    panel.legend(fontsize=style.SMALL, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def quantity_label(one: LimitVerdict) -> str:
    """Text with the name of the quantity that a limit restricts, with the output if the name does not tell it."""
    says = any(word in one.quantity for word in ("torque", "stress", "angle", "power"))
    return one.quantity if says else f"{one.of}, {one.quantity}"
