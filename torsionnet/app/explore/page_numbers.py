"""Numbers and units as the explore page shows them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.conventions import Conventions

CONVENTIONS_BY_ANGLE = {angle: Conventions(angle=angle) for angle in ("rad", "deg")}
"""Conventions by the unit of angles that is chosen on the page."""


def json_numbers(values: NDArray[np.float64]) -> list[float | None]:
    """List of numbers for JSON, with None for nan and inf, which JSON lacks."""
    if np.isfinite(values).all():
        return list(values.tolist())
    return [float(value) if np.isfinite(value) else None for value in values]
