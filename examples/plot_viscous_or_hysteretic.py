"""
Viscous or hysteretic damper
============================

The arc springs of a dual-mass flywheel rub. A viscous damper forgets its losses towards zero frequency, a hysteretic
spring keeps them: the phase at low frequency tells which one it is.
"""

import matplotlib.pyplot as plt
import numpy as np

import torsionnet as tn
from torsionnet import plot

plt.style.use(plot.STYLE)

rig = tn.load("dmf_rig")


def with_spring(spring: tn.Element, title: str) -> tn.Drivetrain:
    """The rig with another spring between the flywheel's masses."""
    elements = [spring if name == "dmf" else element for name, element in rig.elements.items()]
    parameters = {name: p for name, p in rig.parameter_definitions.items() if name != "c_2" or title == "both"}
    return tn.Drivetrain(title, elements, parameters=parameters, inputs=rig.inputs, sensors=rig.sensors)


ends = ("primary", "secondary")
hysteretic = tn.HystereticSpring("dmf", nodes=ends, stiffness="k_2", loss_factor=0.4)
mixed = tn.HystereticSpring("dmf", nodes=ends, stiffness="k_2", loss_factor=0.2, damping="c_2/2")
models = {
    "viscous, 4 N m s/rad": rig,
    "hysteretic, eta = 0.4": with_spring(hysteretic, "hysteretic"),
    "half of each": with_spring(mixed, "both"),
}
frequencies = np.geomspace(0.3, 30, 500)
responses = [model.frequency_response("theta_1", "T_T", frequencies) for model in models.values()]
deg = tn.Conventions(angle="deg")
figure = plot.bode(responses, conventions=deg, labels=list(models), title="DMF rig, angle over measured torque")

# %%
# On a linear scale of frequency the difference is plain: with hysteresis a lag remains down to 0 Hz.
low, axes = plt.subplots()
for label, response in zip(models, responses, strict=True):
    axes.plot(frequencies, response.phase[:, 0, 0], label=label)
axes.set(xlim=(0, 10), ylim=(-100, 5), xlabel="frequency [Hz]", ylabel="phase [deg]")
axes.legend()

# %%
# The test of the rig has its peak at 8 Hz with -64 deg, and lags at low frequency as no viscous model does.
for label, response in zip(models, responses, strict=True):
    peak = response.magnitude[:, 0, 0].argmax()
    at_peak = f"{response.phase[peak, 0, 0]:.0f} deg at the peak, {frequencies[peak]:.2f} Hz"
    print(f"{label:22s} {response.phase[0, 0, 0]:6.1f} deg at 0.3 Hz, {at_peak}")
