"""Speeds at which a running drivetrain is examined first, and whether speeds are added between them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.criticals.resonant_speeds import around_resonances
from torsionnet.machinery.orders.order_solution import OrderRequest
from torsionnet.machinery.orders.speed_refinement import fill_speed_gaps, new_speeds


@dataclass(frozen=True, eq=False)
class ExaminedSpeeds:
    """Speeds in rad/s of a reference shaft that are examined, and whether more are added between them.

    Attributes
    ----------
    request : OrderRequest
        Excitations, and the speeds that the caller or the model gives.
    refine : bool
        Whether speeds are added between these: in a range, not in a list of speeds.
    """

    request: OrderRequest
    refine: bool

    @classmethod
    def of(
        cls,
        drivetrain: AssembledModel,
        speeds: ArrayLike | None = None,
        *,
        speed_of: str | None = None,
        excitations: Iterable[str] | None = None,
        refine: bool | None = None,
    ) -> ExaminedSpeeds:
        """Speeds in rad/s to examine, taken from the arguments of an order response and else from the model.

        ``refine`` None: speeds are added between them unless the model lists speeds.
        """
        given = drivetrain.definition.speeds
        is_list = speeds is None and given is not None and bool(given.list)
        request = OrderRequest.of(drivetrain, speeds, speed_of, excitations)
        rising = len(request.speeds) > 1 and bool((np.diff(request.speeds) > 0).all())
        return cls(request, (not is_list if refine is None else refine) and rising)

    @property
    def reference(self) -> str:
        """Name of the node whose speeds are examined."""
        return self.request.reference

    @property
    def ends(self) -> tuple[float, float]:
        """Lowest and highest speed of the reference shaft that is examined, in rad/s."""
        return float(self.request.speeds.min()), float(self.request.speeds.max())

    def first(self, breaks: FloatArray) -> FloatArray:
        """Speeds (n_speeds,) of the first pass in rad/s, rising, with more near narrow resonances, and ``breaks``.

        Gaps are filled.
        """
        if not self.refine:
            return self.request.speeds
        speeds = fill_speed_gaps(self.request.speeds)
        lines = self.request.loads(self.request.speeds[:1]).lines
        around = around_resonances(self.request.drivetrain, self.reference, lines, speeds)
        more = new_speeds(speeds, np.concatenate([around, breaks[np.isfinite(breaks)]]))
        return np.sort(np.concatenate([speeds, more]))
