"""
Which parameter moves which mode
================================

Exact derivatives of natural frequencies and damping ratios: percent per percent. On a rig this says which parameter a
test can find, and in a design which one to change.
"""

import torsionnet as tn
from torsionnet import plot

gear = tn.load("amt_rig").configured("V")
sensitivities = tn.sensitivity.mode_sensitivities(gear)
figure = plot.tornado(sensitivities)

# %%
# In fifth gear the first mode is the motor's inertia on both springs, damped by the flywheel (c_1) and by the oil (c_O)
# alike. What the ratio does to it follows from the reflected half-shaft.
print(*sensitivities.words(), sep="\n")

# %%
# The rule of thumb that stiffness counts by half: scaling every spring scales all undamped frequencies with the root.
springs = [sensitivities.parameters.index(name) for name in ("k_1", "k_2")]
print(sensitivities.relative_frequencies[:, springs].sum(axis=1))

# %%
# A torque meter sees the rig cut where it measures: less inertia in front of the springs, which then counts for more.
cut = tn.sensitivity.mode_sensitivities(gear, measured_input="T_T")
print(*cut.words(), sep="\n")
