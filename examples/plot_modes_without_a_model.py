"""
Modes without a model
=====================

An engine's crankshaft is excited at the damper and measured in four places. Natural frequencies, damping ratios and
shapes follow from the noisy responses alone: poles that stay where they are while the order of the fit grows are modes,
the others follow the noise. Here the responses come from a model, so that the truth is known.
"""

from dataclasses import replace

import numpy as np

import torsionnet as tn
from torsionnet import modal, plot

engine = tn.load("six_cylinder_diesel")
places = [engine.nodes[index] for index in (0, 2, 4, -1)]
clean = engine.frequency_response(places, places[0], np.arange(100.0, 2000.0, 1.0)).mobility()
rng = np.random.default_rng(1)
scatter = rng.standard_normal((2, *clean.values.shape)) * 0.02 * np.median(clean.magnitude)
test = replace(clean, values=clean.values + scatter[0] + 1j * scatter[1], title="Crankshaft, 2 % noise")

diagram = modal.stabilisation(test, modal.Settings("lscf", highest_order=40))
modes = modal.identify_modes(diagram)
figure = plot.stabilisation(diagram, modes)

# %%
# Against the modes of the model: natural frequency, damping ratio, and the likeness of the shapes (MAC). The mode at
# 1794 Hz is there, but its damping still changes with the order: it is left out. The flywheel hardly moves in any.
print(modal.match(modes, engine.modes()).table())
