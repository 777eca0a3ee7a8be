"""A tanker of two masses with a pitch that is set, and the torque in its tail shaft by hand."""

import math

import numpy as np

RPM = math.pi / 30

TANKER = """torsionnet: 1
name: tanker
parameters:
  c_prop: {value: 20000, description: "propeller, full pitch"}
elements:
  engine: {type: inertia, node: e, inertia: 9000}
  tail: {type: shaft, nodes: [e, p], outer_diameter: 300 mm, length: 6 m, inertia: none}
  screw: {type: inertia, node: p, inertia: 6000}
  water: {type: damper, nodes: [p, ground], damping: c_prop}
sensors: {T_tail: {torque: tail}}
speeds: {of: e, range: 20..120 rpm, step: 2 rpm, rated: 110 rpm}
excitations:
  gas: {type: harmonic, node: e, orders: {8: {amplitude: 10 kN*m}}}
  blades: {type: propeller, node: p, blades: 3, blade_orders: {1: {share: 0 %}}, torque: 80 kN*m, rated: 110 rpm}
limits:
  flange: {rule: curve, output: T_tail, value: 50 kN*m, source: own}
  tail: {rule: curve, output: T_tail, value: 60 kN*m, transient_factor: 2, source: own}
configurations:
  pitch:
    full: {}
    zero: {title: propeller at zero pitch, c_prop: 9000}
  firing:
    normal: {}
    uneven: {gas.orders: {8: {amplitude: 10.5 kN*m}}}
report: {kind: approval, measure: [T_tail]}
"""


def torque(rpm, damping, amplitude):
    """Amplitude in the tail shaft in N m by order 8: two masses on a spring, one with water, by hand."""
    stiffness = 79.3e9 * math.pi * 0.3**4 / 32 / 6
    s = 8j * np.asarray(rpm) * RPM
    one, two = 9000 * s**2 + stiffness, 6000 * s**2 + damping * s + stiffness
    first = amplitude * two / (one * two - stiffness**2)
    return np.abs(stiffness * (first - first * stiffness / two))
