"""
A map of the first mode over two stiffnesses
============================================

Where does the first mode of the drive lie, and how well is it damped, if the arc springs of the dual-mass flywheel and
the half-shaft may be chosen? The study ``torsionnet study amt_two_stiffnesses`` solves 41 times 41 rigs at once, in
fifth gear.
"""

import torsionnet as tn

study = tn.load_study("amt_two_stiffnesses")
result = tn.study.run_study(study)
figure = study.answers["frequency"].conclude(study, result).figure(units=study.shown_units())

# %%
# The damping ratio falls with the stiffness of the half-shaft.

figure = study.answers["damping"].conclude(study, result).figure(units=study.shown_units())

# %%
# The same numbers as an array, k_1 along the first axis: the rigs whose first mode stays below 6 Hz with a damping
# ratio of 0.3 or more.

frequency, damping = (result.values(name).reshape(41, 41) for name in ("f_1", "zeta_1"))
chosen = (frequency < 6) & (damping >= 0.3)
k_1, k_2 = (column.reshape(41, 41)[chosen] for column in result.parameters().values())
print(f"{chosen.sum()} of {chosen.size} rigs: k_1 from {k_1.min():.0f} to {k_1.max():.0f} N m/rad,")
print(f"k_2 from {k_2.min():.0f} to {k_2.max():.0f} N m/rad")
