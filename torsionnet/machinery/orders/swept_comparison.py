"""Orders of a model beside those of a run-up, along its speed over time where it is too fast for steady peaks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.modes.natural_modes import modes
from torsionnet.machinery.orders.calculated_order import largest_amplitudes
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.swept_orders import swept_orders
from torsionnet.model.channels import Sensor
from torsionnet.signals.orders.tracked_orders import MeasuredOrder, TrackedOrders
from torsionnet.signals.sweep_loss import sweep_remarks


@dataclass(frozen=True, eq=False)
class SweptComparison:
    """Orders of a model along the measured speed over time, with remarks on peaks that the run-up did not reach.

    Attributes
    ----------
    orders : mapping of str to tuple of MeasuredOrder
        By output, SI; empty where the steady response is compared.
    remarks : tuple of str
        Loss of each peak passed too fast, and why the steady response is compared nevertheless.
    """

    orders: Mapping[str, tuple[MeasuredOrder, ...]] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()


def swept_comparison(
    drivetrain: AssembledModel,
    run: OrderResponse,
    outputs: Sequence[str | Sensor],
    tracked: TrackedOrders,
    excitations: Iterable[str] | None = None,
) -> SweptComparison:
    """Orders (SI) to compare with a run-up, empty where no peak loses anything or the model has no single phase.

    Parameters
    ----------
    drivetrain : Drivetrain
        In the configuration that was tested.
    run : OrderResponse
        Of its steady speeds, with these outputs.
    outputs : sequence of str or Sensor
    tracked : TrackedOrders
        Of the test, which gives times, speeds and orders.
    excitations : iterable of str, optional
        Those that act; by default all.
    """
    remarks = sweep_remarks(tracked.times, tracked.speeds, tracked.orders.tolist(), modes(drivetrain))
    if not remarks or largest_amplitudes(run, range(len(run.lines)), 0) is not None:
        return SweptComparison(remarks=remarks)
    try:
        found = swept_orders(drivetrain, outputs, tracked, excitations)
    except UsageError as error:
        return SweptComparison(remarks=(*remarks, phrase("compared with steady peaks: {reason}", reason=error)))
    by_output = {channel.name: one.measured() for channel, one in zip(run.outputs, found, strict=True)}
    return SweptComparison(by_output, remarks)
