"""A pump on a motor, its order by hand, and orders tracked at it."""

import numpy as np

from torsionnet.signals.orders.tracked_orders import TrackedOrders

RPM = np.pi / 30
PLANT = """torsionnet: 1
name: pump on a motor
elements:
  motor: {type: inertia, node: m, inertia: 0.5 kg*m^2}
  shaft: {type: spring, nodes: [m, f], stiffness: 40 kN*m/rad, damping: 20 N*m*s/rad}
  pump: {type: inertia, node: f, inertia: 2 kg*m^2}
sensors: {T: {torque: shaft}}
speeds: {of: m, range: 300..900 rpm, step: 5 rpm}
excitations: {motor: {type: harmonic, node: m, orders: {6: {amplitude: 20 N*m}}}}
limits: {shaft: {rule: curve, output: torque(shaft), value: 100 N*m, source: own}}
"""


def torque(rpm, lower=1.0):
    """Of the shaft by order 6, at a natural frequency lower by a factor; two masses on a spring, by hand."""
    s = 6j * np.asarray(rpm) * RPM / lower
    kappa = 4e4 + 20 * s
    return kappa * 20 / 0.5 / (s**2 + kappa * (1 / 0.5 + 1 / 2))


def tracked(rpm, values, name="T", quantity="torque", half_range=True):
    size = np.abs(values) if half_range else None
    return TrackedOrders(
        name, quantity, np.array([6.0]), np.arange(len(rpm)) * 0.1, rpm * RPM, values[None], np.full((1, len(rpm)), 0.5),
        size, reference="a pulse",
    )  # fmt: skip
