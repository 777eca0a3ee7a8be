"""
Where a mode lives: energy shares
=================================

Which inertia swings, which spring strains, which damper takes the energy: the shares of every element in one mode of
the AMT rig in 5th gear.
"""

import matplotlib.pyplot as plt
import numpy as np

import torsionnet as tn
from torsionnet import plot

plt.style.use(plot.STYLE)

modes = tn.load("amt_rig").configured("V").modes()
print(modes.table())

# %%
# Strain shares say which stiffness moves the frequency, dissipation shares which damper changes the damping ratio.
names = [name for name, shares in modes.energy_shares(0).items() if any(shares)]
height = np.arange(len(names))
figure, panels = plt.subplots(1, len(modes), sharey=True)
for mode, panel in enumerate(panels):
    shares = modes.energy_shares(mode)
    for offset, kind in enumerate(("kinetic", "strain", "dissipated")):
        values = [100 * shares[name][offset] for name in names]
        panel.barh(height + 0.27 * (offset - 1), values, height=0.25, label=kind)
    panel.set_title(f"{modes.natural_frequencies[mode]:.2f} Hz, {modes.damping_ratios[mode]:.0%} damping")
    panel.set_xlabel("share [%]")
panels[0].set_yticks(height, names)
panels[0].invert_yaxis()
panels[-1].legend()
