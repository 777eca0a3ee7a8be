r"""
A pendulum that follows the order
=================================

A centrifugal pendulum swings at :math:`\sqrt{R/r}` periods a turn at any speed, so that it takes one order from the
shaft over the whole range; a tuned damper does so at one frequency only.
"""

from collections.abc import Sequence

import matplotlib.pyplot as plt
import numpy as np

import torsionnet as tn
from torsionnet import plot

plt.style.use(plot.STYLE)

ORDER, RADIUS = 2, 0.080  # order to be taken; from the axis of the shaft to the pivots


def drivetrain(elements: Sequence[tn.Element]) -> tn.Drivetrain:
    return tn.Drivetrain(
        "engine and gearbox",
        [
            tn.Inertia("engine", node="crank", inertia="0.25 kg*m^2"),
            tn.Spring("dmf", nodes=("crank", "box"), stiffness="900 N*m/rad", damping="6 N*m*s/rad"),
            tn.Inertia("gearbox", node="box", inertia="0.05 kg*m^2"),
            tn.Spring("shafts", nodes=("box", "car"), stiffness="700 N*m/rad", damping="2 N*m*s/rad"),
            tn.Inertia("vehicle", node="car", inertia="10 kg*m^2"),
            *elements,
        ],
        parameters={"n": "1000 rpm"},
    )


pendulums = tn.PendulumAbsorber(
    "pendulums",
    node="box",
    count=4,
    mass="0.25 kg",
    pivot_radius=RADIUS,
    path_radius=RADIUS / ORDER**2,
    speed="n",
    damping=2e-5,
)
tuned = tn.TunedDamper(
    "tuned", node="box", ring_inertia=4 * 0.25 * RADIUS**2, natural_frequency="50 Hz", damping_ratio=0.02
)
rpm = np.arange(800, 3001, 20)
figure, axes = plt.subplots()
for label, elements in (("nothing", []), ("tuned damper, 50 Hz", [tuned]), ("pendulums", [pendulums])):
    plant = drivetrain(elements)
    size = []
    for n in rpm:
        at_speed = plant.configured(n=f"{n} rpm")
        response = at_speed.frequency_response("acceleration(box)", "crank", [ORDER * n / 60])
        size.append(abs(response.values.item()))
    axes.semilogy(rpm, size, label=label)
axes.set(xlabel="speed [r/min]", ylabel="order 2 of the gearbox [rad/s$^2$/(N m)]")
axes.legend()
