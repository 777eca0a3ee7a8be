"""Measured orders of a test that the explore page draws over the calculated ones while parameters slide."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from torsionnet.app.explore.page_numbers import json_numbers
from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import Channel
from torsionnet.machinery.orders.order_response import OrderResponse

if TYPE_CHECKING:
    from torsionnet.signals.orders.tracked_orders import MeasuredOrder

MOST_DOTS = 1000
"""Largest number of measured speeds drawn of an order; a screen has about as many columns of pixels."""


def orders_of_test(path: str | os.PathLike[str] | None, output: Channel) -> tuple[MeasuredOrder, ...]:
    """Measured orders (SI) of an output in a file; empty without a file, or where it holds no such output."""
    if path is None:
        return ()
    from torsionnet.io.order_tables import read_orders  # loads what a page without a test can do without

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
    from torsionnet.machinery.orders.order_agreement import (
        NO_INTERVAL,
    )  # loads what a page without a test does without
    from torsionnet.machinery.orders.order_comparison import compared_orders

    try:
        pairs = compared_orders(run, None, measured)
    except UsageError:
        return []
    largest = sorted(pairs, key=lambda one: -float(one.measured.amplitude.max()))[:most]
    found = []
    for one in largest:
        step = -(-len(one.measured.speeds) // MOST_DOTS)
        agreement, widths = one.agreement, one.pair.half_widths
        known = agreement.verdict != NO_INTERVAL and agreement.sentence
        phase = "" if agreement.phase_rms is None else f", phase {agreement.phase_rms:.3g}° RMS"
        apart = f"amplitude {agreement.peak:+.3g} %{phase}"
        found.append({
            "name": f"order {one.measured.order:g}",
            "curve": json_numbers(one.curve),
            "rpm": json_numbers(one.measured.speeds[::step] * RPM),
            "magnitude": json_numbers(one.measured.amplitude[::step]),
            "half_widths": None if widths is None else json_numbers(np.asarray(widths[::step])),
            "verdict": f"{agreement.verdict}: {apart}" + (f"; {agreement.sentence}" if known else ""),
        })  # fmt: skip
    return found
