"""
Tolerances of a dual-mass flywheel
==================================

Parts scatter. How far does that move the response at the torque meter? Some hundred drivetrains with stiffness, damping
and inertia drawn from their tolerances are solved together by :meth:`~torsionnet.Drivetrain.frequency_responses`, and
the band that holds 90 % of them is drawn around the nominal one. The tolerances here are examples.
"""

import matplotlib.pyplot as plt
import numpy as np

import torsionnet as tn
from torsionnet import plot

plt.style.use(plot.STYLE)

rig = tn.load("dmf_rig")
f = np.geomspace(0.5, 30, 300)
rng = np.random.default_rng(1)
spread = {"k_2": 0.05, "c_2": 0.20, "I_1": 0.02}  # one standard deviation, as a share of the nominal value
variants = {name: rig.parameters[name] * (1 + share * rng.standard_normal(300)) for name, share in spread.items()}

family = rig.frequency_responses("theta_1", "T_T", f, variants)
nominal = rig.frequency_response("theta_1", "T_T", f)
receptance = np.degrees(family.magnitude[:, :, 0, 0])
low, high = np.percentile(receptance, [5, 95], axis=0)

figure, axes = plt.subplots()
axes.fill_between(f, low, high, alpha=0.3, label="90 % of 300 drivetrains")
axes.loglog(f, np.degrees(nominal.magnitude[:, 0, 0]), label="nominal")
axes.set_xlabel("frequency [Hz]")
axes.set_ylabel(r"$|\theta_1 / T_T|$ [deg/(N m)]")
axes.legend()

# %%
# Which parameter is behind it? The height of the peak scatters with the damping of the flywheel, its frequency with
# damping and stiffness. The inertia on the motor's side of the torque meter has no influence: what is left of its
# correlation is chance.

peaks = receptance.max(axis=1)
at = f[receptance.argmax(axis=1)]
print(f"nominal peak {np.degrees(nominal.magnitude).max():.3f} deg/(N m)")
print(f"peaks of 90 %: {np.percentile(peaks, 5):.3f} to {np.percentile(peaks, 95):.3f} deg/(N m)")
for name, values in family.parameters.items():
    height, place = (np.corrcoef(values, result)[0, 1] for result in (peaks, at))
    print(f"correlation of {name} with the height of the peak {height:+.2f}, with its frequency {place:+.2f}")
