"""Small models as users write them, and one file for a fit, which several files of tests use."""

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
