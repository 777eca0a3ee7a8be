"""
Natural frequencies over a parameter
====================================

A chart in the manner of Campbell's, over the gear ratio instead of the speed: how the poles of the AMT rig move, and
where the second vibration becomes overdamped.
"""

import matplotlib.pyplot as plt
import numpy as np

import torsionnet as tn
from torsionnet import plot

plt.style.use(plot.STYLE)

rig = tn.load("amt_rig")
ratios = np.linspace(2, 9, 71)
figure, (upper, lower) = plt.subplots(2, 1, sharex=True, figsize=(7.2, 5.5))
for drag, color in ((170, "#0072B2"), (360, "#D55E00")):
    for tau in ratios:
        modes = rig.configured(tau=tau, c_O=drag).modes()
        for kind, f, zeta in zip(modes.kinds, modes.natural_frequencies, modes.damping_ratios, strict=True):
            filled = color if kind == "oscillatory" else "none"
            upper.plot(tau, f, "o", markersize=3, markeredgecolor=color, markerfacecolor=filled)
            lower.plot(tau, zeta, "o", markersize=3, markeredgecolor=color, markerfacecolor=filled)
    upper.plot([], [], "o", color=color, label=f"c_O = {drag} N m s/rad")
upper.plot([], [], "o", markeredgecolor="#444444", markerfacecolor="none", label="real pole")
upper.set(yscale="log", ylabel="|lambda|/2pi [Hz]")
upper.legend()
lower.set(xlabel="gear ratio tau [-]", ylabel="damping ratio [-]", ylim=(0, 1.05))
for gear in ("II", "III", "IV", "V"):
    lower.axvline(rig.configured(gear).parameters["tau"], color="#bbbbbb", linewidth=0.8, zorder=0)
