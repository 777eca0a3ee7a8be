"""Measured orders of a fit from files, and what a model cannot compare in them."""

from __future__ import annotations

from pathlib import Path

from torsionnet.base.errors import Fault, ModelError, UsageError, did_you_mean
from torsionnet.identification.orders.order_lines import OrderData, order_faults
from torsionnet.identification.orders.parametric_orders import excited_orders
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.io.order_tables import read_orders
from torsionnet.io.tracked_order_tables import is_tracked_table, read_tracked_orders
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.dynamic_stiffness.transfer_request import named_output
from torsionnet.linear.frequency_response import Channel


def read_order_data(
    file: Path, output: str, model_output: str, model: AssembledModel | None, configuration: str
) -> OrderData | None:
    """Orders of one channel of a file, SI: tracked orders, or a table by speed and order; None without a model.

    Raises
    ------
    UsageError
        The file has no such channel or columns, or the model no such output.
    ModelError
        Cells without a number.
    """
    if is_tracked_table(file):
        channels = {one.name: one for one in read_tracked_orders(file)}
        if output not in channels:
            hint = did_you_mean(output, channels) or f"; there are {', '.join(channels)}"
            raise UsageError(f'{file.name} has no channel "{output}"{hint}')
        return channels[output]
    if model is None:
        return None
    rig = model.configured(configuration) if configuration else model
    return read_orders(file, Channel(output, named_output(rig, model_output or output).unit), configuration)


def faults_of_orders(model: AssembledModel, measurement: Measurement) -> list[Fault]:
    """Faults of a measurement of orders by the model it is to be compared with, with the entry that each is in."""
    try:
        rig = model.configured(measurement.configuration) if measurement.configuration else model
        excited = excited_orders(rig, measurement.speed_of)
    except (UsageError, ModelError) as error:
        return [Fault(str(error), ("orders",))]
    return [Fault(text, (key,)) for key, text in order_faults(measurement, excited)]
