"""
A long drill string, continuous and in segments
===============================================

3 km of pipe between a heavy top drive and the bit. The exact solution of the wave equation has all modes, none of them
by segments; twenty segments hold for the first few.
"""

import matplotlib.pyplot as plt
import numpy as np

import torsionnet as tn
from torsionnet import plot

plt.style.use(plot.STYLE)

OUTER, INNER, LENGTH = "127 mm", "108.6 mm", "3 km"


def string(pipe: tn.Element) -> tn.Drivetrain:
    top = tn.Inertia("top_drive", node="top", inertia="2000 kg*m^2")
    hold = tn.Damper("drive", nodes=("top", "ground"), damping="500 N*m*s/rad")
    collars = tn.Inertia("collars", node="bit", inertia="300 kg*m^2")
    cutting = tn.Damper("mud", nodes=("bit", "ground"), damping="20 N*m*s/rad")
    return tn.Drivetrain("drill string", [top, hold, pipe, collars, cutting])


exact = string(tn.ContinuousShaft("pipe", ("top", "bit"), OUTER, LENGTH, inner_diameter=INNER))
frequencies = np.linspace(0.02, 3.4, 4000)
figure, axes = plt.subplots()
for segments in (5, 20):
    model = string(tn.Shaft("pipe", ("top", "bit"), OUTER, LENGTH, inner_diameter=INNER, segments=segments))
    response = model.frequency_response("velocity(bit)", "bit", frequencies)
    axes.semilogy(frequencies, np.abs(response.values[:, 0, 0]), lw=1, label=f"{segments} segments")
response = exact.frequency_response("velocity(bit)", "bit", frequencies)
axes.semilogy(frequencies, np.abs(response.values[:, 0, 0]), lw=1, label="continuous")
axes.set(xlabel="frequency [Hz]", ylabel="speed of the bit over its torque [rad/s/(N m)]")
axes.legend()
