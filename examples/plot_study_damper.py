"""
One damper for all conditions of an in-line six
===============================================

A viscous damper is chosen once and has to do for normal firing, for a cylinder without injection, for a warm and for a
cold coupling. The best film for one of these is not the best for all: sought is the one with which the torque in the
crankshaft is smallest in the worst of them, ``torsionnet study inline_six_damper``.
"""

import matplotlib.pyplot as plt

import torsionnet as tn
from torsionnet import plot
from torsionnet.study import DamperOverConditions

plt.style.use(plot.STYLE)

study = tn.load_study("inline_six_damper")
result = tn.study.run_study(study)
best = study.answers["damper"].conclude(study, result)
assert isinstance(best, DamperOverConditions)  # for type checkers: what an answer finds depends on its type
figure = best.figure()
print("\n".join(best.sentences))

# %%
# The study also has the torque over a range of films, to see how narrow the valley is.

figure, axes = plt.subplots()
for configuration in study.configurations:
    film = result.parameters(configuration)["c_dmp"]
    axes.plot(film / 1e3, result.values("crankshaft", configuration) / 1e3, label=configuration)
axes.axvline(best.values["c_dmp"] / 1e3, color="black", linewidth=1, label="best for all")
axes.set_xlabel("c_dmp [kN m s/rad]")
axes.set_ylabel("half range of T_crank [kN m]")
axes.legend()
