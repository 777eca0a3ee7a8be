"""
A car in all gears, from parts and components
=============================================

Two half shafts with wheel and tyre are one part, used twice; clutch, gearbox, final drive and vehicle are elements. A
configuration says which gear is engaged.
"""

import numpy as np

import torsionnet as tn
from torsionnet import plot

car = tn.loads(
    """
torsionnet: 1
name: car
use:
  left: {part: half_shaft, at: {inner: dl, road: road}, parameters: {k: 9.2 kN*m/rad}}
  right: {part: half_shaft, at: {inner: dr, road: road}, parameters: {k: 6.1 kN*m/rad}}
elements:
  engine: {type: inertia, node: crank, inertia: 0.28 kg*m^2}
  clutch: {type: clutch, nodes: [crank, inp], stiffness: 1.1 kN*m/rad, damping: 2, disc_inertia: 0.0045 kg*m^2}
  box: {type: gearbox, input: inp, output: out, ratios: {I: -3.769, II: -1.958, III: -1.257, IV: -0.870}, engaged: I,
        wheel_inertias: {I: 0.0041, II: 0.0026, III: 0.0016, IV: 0.0011}, input_inertia: 0.0021, output_inertia: 0.0032}
  axle: {type: final_drive, pinion: out, left: dl, right: dr, ratio: -3.45, cage_inertia: 0.028 kg*m^2}
  body: {type: vehicle, node: road, mass: 1550 kg, wheel_radius: 0.312 m}
inputs: {T_E: {torque: crank}}
sensors: {a_body: {acceleration: road}, T_left: {torque: left.shaft}}
configurations:
  gear: {I: {}, II: {box.engaged: II}, III: {box.engaged: III}, IV: {box.engaged: IV}}
"""
)
frequencies = np.geomspace(1, 60, 500)
gears = [car.configured(name) for name in car.configurations]
figure = plot.bode([gear.frequency_response("T_left", "T_E", frequencies) for gear in gears], title="left half shaft")

# %%
# The frequency of the surge follows the ratio: the lower the gear, the heavier the engine as the wheels feel it.
for gear in gears:
    modes = gear.modes()
    surge = modes.kinds.index("oscillatory")
    print(f"{gear.configuration:4s} {modes.natural_frequencies[surge]:6.3f} Hz, {modes.damping_ratios[surge]:.4f}")

# %%
# The same with each part as one box:
schematic = plot.schematic(car, boxes=True)
