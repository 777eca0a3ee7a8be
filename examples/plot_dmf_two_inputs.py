"""
Applied and measured torque
===========================

The dual-mass flywheel rig of Galvagno et al. (2015), their Fig. 10: angle of the motor over the torque the motor
applies, and over the torque the meter behind it reads.
"""

import numpy as np

import torsionnet as tn
from torsionnet import plot

rig = tn.load("dmf_rig")
drawing = plot.schematic(rig)

# %%
# ``T_M`` is an input of the model, ``T_T`` a sensor. A sensor as input means: as measured.
frequencies = np.geomspace(0.5, 40, 600)
responses = [rig.frequency_response("theta_1", torque, frequencies) for torque in ("T_M", "T_T")]
figure = plot.bode(responses, conventions=tn.Conventions(angle="deg"), title="DMF rig")

# %%
# The peaks are those of different systems: with the rotor, and without it.
for response, modes in zip(responses, (rig.modes(), rig.modes(measured_input="T_T")), strict=True):
    peak = response.magnitude[:, 0, 0].argmax()
    height = np.degrees(response.magnitude[peak, 0, 0])
    print(f"{response.inputs[0].name}: peak {height:.4f} deg/(N m) at {frequencies[peak]:.2f} Hz,", end=" ")
    print(f"pole {modes.natural_frequencies[0]:.3f} Hz, {modes.damping_ratios[0]:.1%}")
