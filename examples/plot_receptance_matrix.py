"""
Receptance matrix and reciprocity
=================================

Every node can be an output and an input. A drivetrain of springs, dampers and gears is reciprocal: the angle at one
place per torque at another is the same the other way round, across a gear stage too.
"""

import numpy as np

import torsionnet as tn
from torsionnet import plot

line = tn.Drivetrain(
    "geared line",
    [
        tn.Inertia("motor", node="motor", inertia=0.2),
        tn.Spring("shaft", nodes=("motor", "pinion"), stiffness=9e3, damping={"zeta": 0.02, "at": "30 Hz"}),
        tn.Inertia("pinion", node="pinion", inertia=0.02),
        tn.Gear("stage", nodes=("pinion", "wheel"), teeth=(17, -61), stiffness=4e5, damping=30),
        tn.Inertia("wheel", node="wheel", inertia=0.9),
        tn.Spring("output", nodes=("wheel", "ground"), stiffness=5e4, damping=40),
    ],
)
nodes = ["motor", "wheel"]
response = line.frequency_response(nodes, nodes, np.geomspace(3, 300, 600))
print(abs(response.values[:, 0, 1] - response.values[:, 1, 0]).max() / response.magnitude.max())
figure = plot.bode(response, title="Receptances of a geared line")

# %%
# Mobility and accelerance are the same data, and the dynamic stiffness is the inverse of the matrix.
print(response.mobility().kind(), response.mobility().unit())
print(response.dynamic_stiffness().kind(), response.dynamic_stiffness().unit())
