"""Responses of one condition over speed, by which the rules of limits judge."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.mean.power_flow import mean_power, power_flows
from torsionnet.machinery.orders.order_amplitudes import OrderAmplitudes
from torsionnet.machinery.orders.order_line import summed_sizes
from torsionnet.machinery.orders.order_response import OrderResponse, half_ranges_of
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import GROUND, Element, Values

# View of a model in one condition for its limits, apart from the definition, which itself holds limits.


@dataclass(frozen=True, eq=False)
class LimitSubject:
    """Model in one condition, with the elements, nodes, sensors and values that limits need.

    Attributes
    ----------
    elements, active : mapping
        All elements by name, and those that are switched on.
    nodes, active_nodes : tuple of str
        Of these.
    sensors : mapping
        As declared, by name.
    speeds : tuple of float
        At which it is examined, rad/s of the reference shaft; empty where the model does not say.
    rated : float, optional
        Rated speed of that shaft, rad/s.
    misfiring : bool
        Whether a cylinder does not fire.
    values : mapping
        Exact value of every parameter.
    is_generating_set : bool
        Whether a piston engine drives a generator and no propeller.
    cranks : frozenset of str
        Nodes of the throws of engines.
    propels : bool
        Whether the machinery propels a ship.
    fixed_pitch : bool
        Whether all propellers that excite it are of fixed pitch.
    """

    elements: Mapping[str, Element]
    active: Mapping[str, Element]
    nodes: tuple[str, ...]
    active_nodes: tuple[str, ...]
    sensors: Mapping[str, Sensor]
    speeds: tuple[float, ...]
    rated: float | None
    misfiring: bool
    values: Mapping[str, Any]
    is_generating_set: bool = False
    cranks: frozenset[str] = frozenset()
    propels: bool = False
    fixed_pitch: bool = False


@dataclass(frozen=True, eq=False)
class Evidence:
    """Responses of one condition over speed, with the mean values and the model in that condition.

    Attributes
    ----------
    run : OrderResponse
        With all that the rules of the model want to see.
    means : mapping
        Sensor -> (n_speeds,) mean values; those that are not known are missing.
    why_no_mean : str
        Why they are.
    subject : LimitSubject
        The model in this condition.
    rated_means : mapping
        Sensor -> mean value at the rated speed, where that is examined and it is known: that of full load, which is
        the model as written where nothing drives the sensor's element in this condition.
    idle : frozenset of Sensor
        Those that nothing drives, as in the gear of an engine that is declutched.
    run_below : float, optional
        Highest speed in rad/s that a condition permits below the speed bands of its limits, so that it is run there.
    """

    run: OrderResponse
    means: Mapping[Sensor, FloatArray]
    why_no_mean: str
    subject: LimitSubject
    rated_means: Mapping[Sensor, float] = field(default_factory=dict)
    idle: frozenset[Sensor] = frozenset()
    run_below: float | None = None

    @property
    def speeds(self) -> FloatArray:
        """Speeds of the reference shaft in rad/s, shape (n_speeds,)."""
        return self.run.speeds

    @property
    def examined(self) -> SpeedSpan:
        """Speeds from the lowest to the highest one examined, in rad/s."""
        return SpeedSpan(float(self.speeds[0]), float(self.speeds[-1]))

    def size(self, sensors: Sequence[Sensor]) -> FloatArray:
        """Half range of the sum of all orders, the largest of the sensors, in SI units, shape (n_speeds,)."""
        return np.asarray(half_ranges_of(self.run, [self._place(sensor) for sensor in sensors]).max(axis=1))

    def size_by_case(self, sensors: Sequence[Sensor]) -> FloatArray | None:
        """Half range in each case of excitation, the largest of the sensors, in SI units, shape (n_speeds, n_cases).

        None where there are no cases.
        """
        if not isinstance(self.run, WorstResponse) or len(self.run.each) < 2:
            return None
        places = [self._place(sensor) for sensor in sensors]
        return np.stack([half_ranges_of(case, places).max(axis=1) for case in self.run.each], axis=1)

    def largest_of(self, sensors: Sequence[Sensor], at: int) -> Sensor:
        """Sensor with the largest half range of the sum of all orders at a speed, given by its index."""
        return max(sensors, key=lambda sensor: float(half_ranges_of(self.run, [self._place(sensor)])[at, 0]))

    def orders(self, sensors: Sequence[Sensor]) -> OrderAmplitudes:
        """Amplitudes of every order in SI units, those of the sensor with the largest half range at each speed."""
        return OrderAmplitudes.of(self.run, [self._place(sensor) for sensor in sensors])

    def summed_orders(self, sensor: Sensor) -> FloatArray:
        """Amplitudes of a sensor by frequency in SI units, shape (n_speeds, n_frequencies).

        Lines of one frequency are added with their phases.
        """
        return summed_sizes(self.run)[:, :, self._place(sensor)]

    def weighted(self, sensor: Sensor, weights: FloatArray) -> tuple[FloatArray, OrderAmplitudes]:
        """Half range (n_speeds,) of the sum of a sensor's lines times their weights, and the lines in that case.

        The largest of all cases at each speed.
        """
        place, half_ranges, values = self._place(sensor), [], []
        for case in self._cases:
            values.append(case.values[:, :, place] * weights)
            # Weights belong to lines before they are added: each case is summed over its cycle anew.
            weighted = OrderResponse(
                case.speeds, case.reference, case.lines, values[-1][:, :, None], (case.outputs[place],)
            )
            half_ranges.append(weighted.half_range[:, 0])
        worst, speeds = np.argmax(half_ranges, axis=0), np.arange(len(self.speeds))
        plain = self.orders([sensor]).times(weights)
        # The first of the responses is the worst combination, which has cases of its own at each speed.
        cases = np.where(worst == 0, plain.cases, worst - 1)
        return np.max(half_ranges, axis=0), OrderAmplitudes(plain.largest, np.array(values)[worst, speeds], cases)

    @property
    def _cases(self) -> tuple[OrderResponse, ...]:
        """Responses over speed of the worst combination and of each case alone."""
        return (self.run, *self.run.case_responses) if isinstance(self.run, WorstResponse) else (self.run,)

    def worst_case(self, sensor: Sensor, at: int) -> str:
        """Name of the case of excitation that is worst for a sensor at a speed, given by index.

        Empty where there is one case.
        """
        return self.run.case_at(at, str(sensor)) if isinstance(self.run, WorstResponse) else ""

    def mean(self, sensor: Sensor) -> FloatArray | None:
        """Mean value of a sensor in SI units, shape (n_speeds,); None where it is not known."""
        return self.means.get(sensor)

    def power(self, element: str) -> FloatArray:
        """Mean power in W that vibration dissipates in an element, shape (n_speeds,)."""
        return mean_power(self.run, power_flows(self.subject.active[element], Values(self.subject.values)))

    def _place(self, sensor: Sensor) -> int:
        return self.run.output(str(sensor))


def torques_of(element: Element) -> list[Sensor]:
    """Sensors of the torque at every port of an element that is not on ground.

    Of one port where no inertia lies between the ports.
    """
    ports = [port for port, node in element.ports.items() if node != GROUND]
    if element.diameters is None or len(ports) < 2:
        return [Sensor("torque", element.name)]
    return [Sensor("torque", element.name, port) for port in ports]
