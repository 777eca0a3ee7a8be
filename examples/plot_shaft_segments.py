"""
How many segments has a shaft
=============================

A clamped steel shaft against the continuum, :math:`f_n = (2n - 1)\\,\\sqrt{G/\\rho}/4L`: with consistent inertia the
frequencies come from above, with lumped inertia from below, both with the square of the segment length.
"""

from typing import Literal

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import torsionnet as tn
from torsionnet import plot

plt.style.use(plot.STYLE)

LENGTH, G, RHO = 1.2, 79.3e9, 7850
exact = np.array([1, 3, 5]) * np.sqrt(G / RHO) / (4 * LENGTH)
STYLES: dict[Literal["consistent", "lumped"], str] = {"consistent": "-o", "lumped": "--s"}
counts = np.array([3, 4, 6, 8, 12, 16, 24, 32])


def frequencies(segments: int, inertia: Literal["consistent", "lumped"]) -> NDArray[np.float64]:
    shaft = tn.Shaft("s", nodes=("a", "b"), outer_diameter="60 mm", length=LENGTH, segments=segments, inertia=inertia)
    return tn.Drivetrain("shaft", [shaft, tn.Lock("clamp", node="a")]).modes().natural_frequencies[:3]


figure, axes = plt.subplots()
for inertia, style in STYLES.items():
    errors = np.array([frequencies(int(count), inertia) / exact - 1 for count in counts])
    for mode, color in enumerate(("#0072B2", "#D55E00", "#009E73")):
        label = f"{inertia}, mode {mode + 1}"
        axes.plot(counts, 100 * errors[:, mode], style, color=color, markersize=4, label=label)
    print(inertia, "signs of the errors:", np.sign(errors[-1]))
axes.set_xscale("log")
axes.set_yscale("symlog", linthresh=0.01)
axes.set(xlabel="segments", ylabel="error of the frequency [%]", xticks=counts, xticklabels=counts)
axes.minorticks_off()
axes.legend()
