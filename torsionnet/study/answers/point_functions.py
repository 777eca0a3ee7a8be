"""What answers take for a model: a function of many points, or of many variants, at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from torsionnet.assembly.rows import FloatArray

OfPoints = Callable[[FloatArray], FloatArray]
"""Values (n,) at points (n, d): of the unit cube, or of standard normal space."""

OfVariants = Callable[[Mapping[str, FloatArray]], FloatArray]
"""Values (n,) of variants with parameters (n,) by name."""
