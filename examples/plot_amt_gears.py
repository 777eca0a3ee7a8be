"""
One model, every gear
=====================

The automated manual transmission of Galvagno et al. (2015), their Fig. 13: the gear ratio moves the resonance and the
static angle. Gears are configurations of one model file.
"""

import numpy as np

import torsionnet as tn
from torsionnet import plot

rig = tn.load("amt_rig")
frequencies = np.geomspace(0.5, 30, 500)
gears = [rig.configured(name) for name in ("II", "III", "IV", "V")]
responses = [gear.frequency_response("theta_1", "T_T", frequencies) for gear in gears]
figure = plot.bode(responses, conventions=tn.Conventions(angle="deg"), title="AMT rig, angle over measured torque")

# %%
# The static angle follows :math:`1/k_1 + \tau^2/k_2`, not the ratio alone.
for gear in gears:
    p = gear.parameters
    static = np.degrees(1 / p["k_1"] + p["tau"] ** 2 / p["k_2"])
    model = np.degrees(gear.frequency_response("theta_1", "T_T", [0]).values.item().real)
    print(f"{gear.configuration:4s} tau = {p['tau']:.2f}: {model:.4f} deg/(N m), by hand {static:.4f}")
