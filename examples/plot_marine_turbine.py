"""
A branched drivetrain
=====================

Two steam turbines drive one propeller through two reductions each (Gunter and Chen 2001, Example 8.1). Gears are
constraints: the shapes show every node, also those the gears eliminate.
"""

import torsionnet as tn
from torsionnet import plot

ship = tn.load("marine_steam_turbine").configured("undamped")
drawing = plot.schematic(ship)

# %%
# The first natural frequencies are printed in the book as 177.7, 220.2 and 1282.6 per minute.
modes = ship.modes()
print(modes.table(tn.Conventions(frequency="cpm")))

# %%
# Turbines turn up to 78 times as fast as the propeller, and in a mode they move accordingly. Referred to the propeller,
# all shafts can be compared: a slope is a twist, a gear makes no jump.
figure = plot.mode_shapes(modes, ship, mode=[2, 3, 4], conventions=tn.Conventions(frequency="cpm"))
