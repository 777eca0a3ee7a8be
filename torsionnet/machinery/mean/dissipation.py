"""Mean power in W that vibration dissipates in elements, as torque times rate summed over frequencies.

Power is quadratic: orders of one frequency are added as complex amplitudes first, then the mean powers of all
frequencies are added.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.packages import SavedResult
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.mean.power_flow import mean_power, power_flows, power_sensors
from torsionnet.machinery.orders.order_solution import orders_at_speeds
from torsionnet.model.elements import Values

# Mean power that the vibration of running machinery dissipates, by speed and element.

FORMULA = "P = sum over frequencies of Re(T conj(dgamma/dt))/2, T the whole torque of the element, elastic and damping"


@dataclass(frozen=True, eq=False, repr=False)
class DissipatedPower(SavedResult):
    """Mean power in W that the vibration of running machinery dissipates, by speed and element.

    Attributes
    ----------
    speeds : (n_speeds,) array
        Speeds of the reference shaft, rad/s.
    reference : str
        Node of the reference shaft.
    elements : tuple of str
    values : (n_speeds, n_elements) array
        Mean power, W.
    title : str
        Name of the model with its configuration.
    """

    speeds: FloatArray
    reference: str
    elements: tuple[str, ...]
    values: FloatArray
    title: str = ""

    @property
    def rpm(self) -> FloatArray:
        """Speeds of the reference shaft in r/min, shape (n_speeds,)."""
        return np.asarray(self.speeds * RPM)

    def of(self, element: str) -> FloatArray:
        """Mean power that an element dissipates over speed in W, shape (n_speeds,).

        Raises
        ------
        UsageError
            No power of this element was calculated.
        """
        if element not in self.elements:
            hint = did_you_mean(element, self.elements)
            raise UsageError(
                f'no power of "{element}"{hint}; there is {", ".join(self.elements)}', kind="unknown-element"
            )
        return np.asarray(self.values[:, self.elements.index(element)])

    def table(self) -> Table:
        """Table of dissipated power in W with a row for each speed in rpm and a column for each element."""
        columns = (Column("speed", "rpm"), *(Column(name, "W") for name in self.elements))
        rows = tuple((rpm, *row) for rpm, row in zip(self.rpm.tolist(), self.values.tolist(), strict=True))
        notes = (f"speeds of {self.reference}; {FORMULA}", "heat of a steady slip is not in it")
        return Table(f"{self.title}: dissipated power", columns, rows, notes)


def dissipated_power(
    drivetrain: AssembledModel,
    elements: str | Iterable[str],
    *,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitation: str | Iterable[str] | None = None,
) -> DissipatedPower:
    """Mean power in W that vibration dissipates in elements, over speed.

    P = sum over frequencies of Re(T conj(dgamma/dt))/2: orders of one frequency are added as complex amplitudes
    first. T is the whole torque of the element, with its elastic and its damping part. Heat of a steady slip
    (a damper to ground in a turning machine) is not in it.

    Parameters
    ----------
    elements : str or iterable of str
        Springs, dampers, shafts, viscous dampers, compliant gears, ...
    speeds, speed_of, excitations
        As for :meth:`order_response`.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2),
    ...     tn.HystereticSpring("rubber", nodes=("a", "ground"), stiffness=1e4, loss_factor=0.2)]
    >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["600 rpm"]},
    ...     excitations={"blades": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": "10 N*m"}}}})
    >>> twist = abs(fan.order_response("twist(rubber)").values[0, 0, 0])
    >>> w = 600 * 6.283185307179586 / 60
    >>> bool(abs(fan.dissipated_power("rubber").values[0, 0] - w * 0.2 * 1e4 * twist**2 / 2) < 1e-12)
    True
    """
    names = [elements] if isinstance(elements, str) else list(elements)
    for name in names:
        if name not in drivetrain.elements:
            raise UsageError(
                f'no element is named "{name}"{did_you_mean(name, drivetrain.elements)}', kind="unknown-element"
            )
    values = Values(drivetrain.exact_values)
    flows = {name: power_flows(drivetrain.elements[name], values) for name in names}
    outputs = list(dict.fromkeys(sensor for flow in flows.values() for sensor in power_sensors(flow)))
    run = orders_at_speeds(drivetrain, outputs, speeds=speeds, speed_of=speed_of, excitations=excitation)
    power = np.stack([mean_power(run, flow) for flow in flows.values()], axis=1)
    return DissipatedPower(run.speeds, run.reference, tuple(names), power, run.title)
