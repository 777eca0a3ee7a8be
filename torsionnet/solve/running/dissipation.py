"""Mean power in W that vibration dissipates in elements, as torque times rate summed over frequencies.

Power is quadratic: orders of one frequency are added as complex amplitudes first, then the mean powers of all
frequencies are added.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import UsageError, did_you_mean
from torsionnet.model.elements import Values
from torsionnet.model.power_flow import mean_power, power_flows, power_sensors
from torsionnet.response.dissipated_power import DissipatedPower
from torsionnet.solve.running.order_response import order_response


def dissipated_power(
    drivetrain: AssembledModel,
    elements: str | Iterable[str],
    *,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitations: Iterable[str] | None = None,
) -> DissipatedPower:
    """Mean power in W that vibration dissipates in elements, over speed.

    See :meth:`torsionnet.Drivetrain.dissipated_power`.
    """
    names = [elements] if isinstance(elements, str) else list(elements)
    for name in names:
        if name not in drivetrain.elements:
            raise UsageError(f'no element is named "{name}"{did_you_mean(name, drivetrain.elements)}')
    values = Values(drivetrain.exact_values)
    flows = {name: power_flows(drivetrain.elements[name], values) for name in names}
    outputs = list(dict.fromkeys(sensor for flow in flows.values() for sensor in power_sensors(flow)))
    run = order_response(drivetrain, outputs, speeds=speeds, speed_of=speed_of, excitations=excitations)
    found = np.stack([mean_power(run, flow) for flow in flows.values()], axis=1)
    return DissipatedPower(run.speeds, run.reference, tuple(names), found, run.title)
