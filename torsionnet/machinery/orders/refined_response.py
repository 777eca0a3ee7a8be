"""Order responses with speeds added between the given ones until half ranges and orders have their peaks."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.errors import UsageError, unfit_word
from torsionnet.base.packages import imported
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.criticals.line_meetings import around_resonances
from torsionnet.machinery.excitations.speed_range import NONLINEAR
from torsionnet.machinery.orders.order_line import summed_sizes
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.order_solution import OrderRequest, orders_at_speeds
from torsionnet.machinery.orders.speed_refinement import fill_speed_gaps, new_speeds, refine_speeds, speeds_to_refine
from torsionnet.machinery.orders.worst_response import join_responses
from torsionnet.model.channels import Channels
from torsionnet.model.sections import PERIODIC_ORDERS


def is_periodic(drivetrain: AssembledModel, nonlinear: str | None) -> bool:
    """Whether laws of motion act in full, in periodic motion: as asked for, else as ``speeds:`` of the model says.

    Raises
    ------
    UsageError
        An unknown word, or periodic motion is asked of a drivetrain without laws of motion.
    """
    if nonlinear not in (None, *NONLINEAR):
        text = f"nonlinear is {' or '.join(NONLINEAR)}, got {nonlinear!r}"
        raise UsageError(unfit_word(text, str(nonlinear), NONLINEAR))
    given = drivetrain.definition.speeds
    if (nonlinear or (given and given.nonlinear)) != "periodic":
        return False
    if drivetrain.definition.tangents is None and nonlinear:
        text = "the drivetrain has no laws of motion: its linear response is exact"
        raise UsageError(f"{text}; leave out nonlinear", kind="no-effect")
    # A model that asks for it may have configurations in which all laws of motion are switched off.
    return drivetrain.definition.tangents is not None


# Speeds at which a running drivetrain is examined first, and whether speeds are added between them.


@dataclass(frozen=True, eq=False)
class ExaminedSpeeds:
    """Speeds in rad/s of a reference shaft that are examined, and whether more are added between them.

    Attributes
    ----------
    request : OrderRequest
        Excitations, and the speeds that the caller or the model gives.
    refine : bool
        Whether speeds are added between these: in a range, not in a list of speeds.
    periodic : bool
        Whether laws of motion act in full: then the speeds are added at which branches turn or outputs have peaks.
    """

    request: OrderRequest
    refine: bool
    periodic: bool = False

    @classmethod
    def of(
        cls,
        drivetrain: AssembledModel,
        speeds: ArrayLike | None = None,
        *,
        speed_of: str | None = None,
        excitations: Iterable[str] | None = None,
        refine: bool | None = None,
        nonlinear: str | None = "linear",
    ) -> ExaminedSpeeds:
        """Speeds in rad/s to examine, taken from the arguments of an order response and else from the model.

        ``refine`` None: speeds are added between them unless the model lists speeds. ``nonlinear`` None: as the model
        says.
        """
        given = drivetrain.definition.speeds
        is_list = speeds is None and given is not None and bool(given.list)
        request = OrderRequest.of(drivetrain, speeds, speed_of, excitations)
        rising = len(request.speeds) > 1 and bool((np.diff(request.speeds) > 0).all())
        more = (not is_list if refine is None else refine) and rising
        return cls(request, more, is_periodic(drivetrain, nonlinear))

    @property
    def reference(self) -> str:
        """Name of the node whose speeds are examined."""
        return self.request.reference

    @property
    def nonlinear(self) -> str:
        """Word for the laws of motion, "linear" or "periodic"."""
        return "periodic" if self.periodic else "linear"

    @property
    def ends(self) -> tuple[float, float]:
        """Lowest and highest speed of the reference shaft that is examined, in rad/s."""
        return float(self.request.speeds.min()), float(self.request.speeds.max())

    def response(
        self, drivetrain: AssembledModel, output: Channels, speeds: FloatArray, excitation: Iterable[str] | None
    ) -> OrderResponse:
        """Order response at speeds in rad/s of the reference, and of periodic motion where it turns or has peaks."""
        if self.periodic:
            response: OrderResponse = imported(PERIODIC_ORDERS)(
                drivetrain, output, speeds=speeds, speed_of=self.reference, excitation=excitation, between=self.refine
            )
            return response
        return orders_at_speeds(drivetrain, output, speeds=speeds, speed_of=self.reference, excitations=excitation)

    def first(self, breaks: FloatArray) -> FloatArray:
        """Speeds (n_speeds,) of the first pass in rad/s, rising, with more near narrow resonances, and ``breaks``.

        Gaps are filled.
        """
        if self.periodic and self.refine:
            low, high = self.ends
            return np.unique(np.concatenate([self.request.speeds, breaks[(breaks > low) & (breaks < high)]]))
        if not self.refine:
            return self.request.speeds
        speeds = fill_speed_gaps(self.request.speeds)
        lines = self.request.loads(self.request.speeds[:1]).lines
        # A lightly damped resonance may be narrower than any step: its speed follows from the poles and no grid
        # shows it.
        around = around_resonances(self.request.drivetrain, self.reference, lines, speeds)
        more = new_speeds(speeds, np.concatenate([around, breaks[np.isfinite(breaks)]]))
        return np.sort(np.concatenate([speeds, more]))


SMALLEST_ORDER_REFINED = 0.05
"""Amplitude of an order, over the largest half range of its output, below which its peak gets no more speeds.

A smaller value resolves peaks of orders that hardly matter, at the cost of more speeds.
"""


def order_response(
    drivetrain: AssembledModel,
    output: Channels,
    *,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitation: str | Iterable[str] | None = None,
    refine: bool = False,
    nonlinear: str | None = None,
) -> OrderResponse:
    """Response of running machinery as complex amplitudes of every order of the outputs at every speed.

    Parameters
    ----------
    output : str, Sensor or sequence of these
        As for :meth:`frequency_response`.
    speeds : (n_speeds,) array, optional
        rad/s, above 0; default: those of the model.
    speed_of : str, optional
        The node they belong to; default: that of the model.
    excitation : str or iterable of str, optional
        Which of the model's excitations act; default: all.
    refine : bool
        Whether the result has more speeds between these, until the largest half range and the largest amplitudes
        are known to 0.1 %; between the speeds of a list is nothing. Of periodic motion those are added at which its
        branches turn or outputs have peaks.
    nonlinear : {"linear", "periodic"}, optional
        Whether laws of motion are linear about the operating point, or act in full, as in :meth:`periodic_response`;
        then every output has the largest motion that is stable, and ``motions`` of the result are all that were found.
        Default: that of the model, else linear.

    Raises
    ------
    UsageError
        Unknown names, no excitations or speeds, or a shaft without a fixed ratio to the reference.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...     tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)]
    >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["600 rpm"]},
    ...     excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}})
    >>> run = fan.order_response("torque(shaft)")
    >>> w = 2 * run.speeds[0]
    >>> bool(abs(run.of_order(2)[0] - -10 * 2e4 / (3e4 - 2 * w**2)) < 1e-9)
    True
    """
    acting = excitation if excitation is None or isinstance(excitation, str) else tuple(excitation)
    if not refine and not is_periodic(drivetrain, nonlinear):
        return orders_at_speeds(drivetrain, output, speeds=speeds, speed_of=speed_of, excitations=acting)
    examined = ExaminedSpeeds.of(
        drivetrain, speeds, speed_of=speed_of, excitations=acting, refine=None if refine else False, nonlinear=nonlinear
    )

    def at(those: FloatArray) -> _Sized:
        run = examined.response(drivetrain, output, those, acting)
        # Sums of lines of one frequency peak at other speeds than their parts.
        return _Sized(run, run.half_range, np.concatenate([run.sizes, summed_sizes(run)], axis=1))

    if examined.periodic or not examined.refine:
        return examined.response(drivetrain, output, examined.request.speeds, acting)
    return refine_speeds(at(examined.first(np.empty(0))), _wanted, lambda known, more: known.with_more(at(more))).run


def merged_responses(first: OrderResponse, second: OrderResponse) -> tuple[OrderResponse, NDArray[np.intp]]:
    """Order response joined from two and sorted by speed, and the indices (n_speeds,) that sort both speeds."""
    both = np.concatenate([first.speeds, second.speeds])
    order = np.argsort(both, kind="stable")
    places = np.argsort(order, kind="stable")
    parts = [(first, places[: len(first.speeds)]), (second, places[len(first.speeds) :])]
    return join_responses(parts, both[order], first.title), order


@dataclass(frozen=True, eq=False)
class _Sized:
    """Order response with half ranges (n_speeds, n_out) and amplitudes (n_speeds, n, n_out) of lines and sums."""

    run: OrderResponse
    half_range: FloatArray
    sizes: FloatArray

    def with_more(self, other: _Sized) -> _Sized:
        """Order response at the speeds of both, sorted by speed, with its half ranges and amplitudes."""
        run, order = merged_responses(self.run, other.run)
        half_range, sizes = (
            np.concatenate([getattr(sized, name) for sized in (self, other)])[order] for name in ("half_range", "sizes")
        )
        return _Sized(run, half_range, sizes)


def _wanted(sized: _Sized) -> FloatArray:
    large = sized.sizes.max(axis=0) > SMALLEST_ORDER_REFINED * sized.half_range.max(axis=0)
    return speeds_to_refine(sized.run.speeds, np.concatenate([sized.half_range, sized.sizes[:, large]], axis=1))
