"""Numbers as the page takes them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.response import Conventions

SHOWN = {angle: Conventions(angle=angle) for angle in ("rad", "deg")}
"""Conventions by the unit of angles that is chosen on the page."""


def numbers(values: NDArray[np.float64]) -> list[float | None]:
    """A list for JSON, which has neither nan nor inf."""
    if np.isfinite(values).all():
        return list(values.tolist())
    return [float(value) if np.isfinite(value) else None for value in values]
