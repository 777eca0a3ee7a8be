"""Small models as users write them, and a fit to records of one of them."""

import numpy as np

CLUTCH = """\
torsionnet: 1
elements:
  a: {type: inertia, node: a, inertia: 1}
  clutch: {type: spring, nodes: [a, b], stiffness: 100}
  b: {type: inertia, node: b, inertia: 1}
inputs: {T: {torque: a}}
sensors: {T_c: {torque: clutch}}
configurations:
  closed: {on: [clutch]}
  open: {off: [clutch, b]}
"""
TWO_DISCS = """\
torsionnet: 1
name: two discs
elements:
  rotor: {type: inertia, node: a, inertia: 0.1}
  shaft: {type: spring, nodes: [a, ground], stiffness: k, damping: 1}
parameters: {k: 400 N*m/rad}
inputs: {T: {torque: a}}
sensors: {phi: {angle: a}, M: {torque: shaft}}
configurations: {soft: {k: 200 N*m/rad}, hard: {k: 800 N*m/rad}}
bench:
  excitation: {type: linear chirp, start: 1 Hz, stop: 30 Hz, duration: 30 s, amplitude: 5 N*m}
  channels: {M: {type: transducer, noise: 0.01 N*m}, phi: {type: encoder, lines: 5000, quadrature: true}}
  acquisition: {rate: 500 Hz}
"""
FIT_OF_TWO_DISCS = """\
torsionnet: 1
model: rig.yaml
parameters:
  k: {start: 300 N*m/rad, bounds: [50, 2000]}
  shaft.damping: {start: 2 N*m*s/rad}
measurements:
  soft: {record: run_soft.npz, output: phi, input: T_set, model_input: T, configuration: soft, band: [1 Hz, 25 Hz]}
settings: {window: hamming, seconds: 2 s, overlap: 80 %}
true: {k: 200 N*m/rad, shaft.damping: 1}
"""
FAN = """torsionnet: 1
name: fan
elements:
  motor: {type: inertia, node: a, inertia: 0.28}
  shaft: {type: spring, nodes: [a, b], stiffness: 5000, damping: 4}
  fan: {type: inertia, node: b, inertia: 1.2}
"""
TWO_FANS = """torsionnet: 1
name: two fans on a motor
elements:
  motor: {type: inertia, node: m, inertia: 0.5 kg*m^2}
  shaft: {type: spring, nodes: [m, f], stiffness: 40 kN*m/rad, damping: 20 N*m*s/rad}
  fan: {type: inertia, node: f, inertia: 2 kg*m^2}
speeds: {of: m, range: 300..1500 rpm, step: 10 rpm}
excitations:
  motor: {type: harmonic, node: m, orders: {6: {amplitude: 20 N*m}}}
  fan: {type: harmonic, node: f, orders: {5: {amplitude: 12 N*m, phase: 20 deg}}}
configurations: {motor: {smooth: {motor.orders: {6: {amplitude: 5 N*m}}}, rough: {}}}
"""
SHIP_SHAFTING = """torsionnet: 1
name: ship
elements:
  engine: {type: inertia, node: e, inertia: 5000}
  front: {type: shaft, nodes: [e, f], outer_diameter: 300 mm, length: 3 m, inertia: none}
  flange: {type: inertia, node: f, inertia: 100}
  tail: {type: shaft, nodes: [f, p], outer_diameter: 300 mm, length: 4 m, inertia: none}
  screw: {type: inertia, node: p, inertia: 3000}
  water: {type: damper, nodes: [p, ground], damping: 4000}
  slip: {type: damper, nodes: [f, p], damping: 20000}
speeds: {of: e, range: 40..120 rpm, step: 4 rpm, rated: 110 rpm}
excitations:
  gas: {type: harmonic, node: e, orders: {6: {amplitude: 9 kN*m}}}
limits:
  tail: {rule: curve, output: torque(tail), value: 60 kN*m, source: own}
  front_torque: {rule: curve, output: torque(front), value: 90 kN*m, source: own}
configurations:
  firing:
    normal: {}
    weak: {gas.orders: {6: {amplitude: 5 kN*m}}}
"""
PRESSURES = 3e5 + 150e5 * np.exp(-np.linspace(0, 6, 36))
TWO_CYLINDERS = {
    "type": "reciprocating_engine", "speed_of": "crank", "cycle": 4, "cylinders": {1: "crank", 2: "crank"},
    "firing_order": [1, 2], "bore": "300 mm", "stroke": "400 mm", "rod_length": "800 mm", "misfire": "each",
    "gas": {"fired": PRESSURES.tolist(), "motored": (0.3 * PRESSURES).tolist(), "reference": "absolute", "crankcase": "1 bar"},
}  # fmt: skip
TWO_CYLINDER_PLANT = {
    "torsionnet": 1,
    "name": "plant",
    "elements": {
        "throw": {"type": "inertia", "node": "crank", "inertia": 100},
        "rubber": {"type": "spring", "nodes": ["crank", "screw"], "stiffness": "2 MN*m/rad", "damping": 2e3},
        "wheel": {"type": "inertia", "node": "screw", "inertia": 400},
    },
    "speeds": {"of": "crank", "range": "500..600 rpm", "step": "20 rpm", "rated": "600 rpm"},
    "load": {"absorbed_at": "screw", "power": "500 kW", "torque_exponent": 2, "driven_by": {"crank": 1}},
    "excitations": {"engine": TWO_CYLINDERS},
    "limits": {"rubber": {"rule": "coupling", "element": "rubber", "T_KN": "20 kN*m", "T_KW": "900 kN*m"}},
}
