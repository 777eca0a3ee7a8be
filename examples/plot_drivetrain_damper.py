"""
A drivetrain damper and its margins
===================================

A generator that keeps its power takes damping from the first torsional mode of a wind turbine; a band-pass from
generator speed to generator torque gives it back. How much gain and delay does the loop bear?
"""

import torsionnet as tn
from torsionnet import plot

turbine = tn.loads(
    """
torsionnet: 1
name: drivetrain damper of a wind turbine
parameters: {P: 5 MW, w: 122.9 rad/s, w_d: 13.9 rad/s, g: 2000 N*m*s/rad}
elements:
  rotor: {type: inertia, node: hub, inertia: 3.87e7 kg*m^2}
  wind: {type: damper, nodes: [hub, ground], damping: 6e6 N*m*s/rad}
  shaft: {type: spring, nodes: [hub, low], stiffness: 8.68e8 N*m/rad, damping: 6.2e6 N*m*s/rad}
  gearbox: {type: gear, nodes: [high, low], ratio: 97}
  generator: {type: inertia, node: high, inertia: 534 kg*m^2}
  constant_power: {type: constant_power_load, node: high, power: P, speed: w}
  damper: {type: controller, sense: {velocity: high}, act: high, delay: 20 ms,
           law: {numerator: [-g*w_d, 0], denominator: [1, 0.8*w_d, w_d^2]}}
configurations: {control: {on: {}, without: {off: [damper]}}}
"""
)
for name in turbine.configurations:
    modes = turbine.configured(name).modes()
    first = modes.kinds.index("oscillatory")
    print(f"{name:8s} {modes.natural_frequencies[first]:.3f} Hz, damping ratio {modes.damping_ratios[first]:.4f}")

# %%
# The loop opened at the torque of the damper, all else closed:
margins = turbine.configured("on").loop_margins("damper")
print(margins.table())
figure = plot.nyquist(margins)
