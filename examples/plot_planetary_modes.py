"""
Repeated modes of a planetary set
=================================

Three equal planets: where sun and carrier move, all planets do the same; in the other modes sun and carrier stand still
and the planets move among themselves. There are two such modes with one frequency (Kahraman 1994).
"""

import matplotlib.pyplot as plt
import numpy as np

import torsionnet as tn
from torsionnet import plot

plt.style.use(plot.STYLE)

gearset = tn.load("planetary_set")
modes = gearset.modes()
print(modes.table())

# %%
# Sun and ring mesh with planets that turn by themselves: each mesh is a gear whose housing is the carrier, with a
# stiffness of its own. The schematic finds such a set by its planets and draws it as one.
drawing = plot.schematic(gearset)

# %%
# Any combination of two shapes with one frequency is a shape as well; what does not depend on the choice is that sun
# and carrier stand still in both.
figure, panels = plt.subplots(1, len(modes), sharey=True, figsize=(7.2, 3))
moving = [node for node in gearset.nodes if np.abs(modes.shape_at(node)).max() > 1e-9]
for mode, panel in enumerate(panels):
    panel.bar(moving, [modes.shape_at(node)[mode].real for node in moving])
    panel.axhline(0, color="#444444", linewidth=0.8)
    panel.set_title(f"{modes.natural_frequencies[mode]:.4f} Hz")
    panel.tick_params(axis="x", rotation=90)
panels[0].set_ylabel("relative angle [-]")
