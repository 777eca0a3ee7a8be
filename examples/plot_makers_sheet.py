"""
A maker's sheet becomes a model
===============================

A mass-elastic sheet as makers of engines send it, with decimal commas and units in the headings, is read as it comes.
"""

import tempfile
from pathlib import Path

import torsionnet as tn
from torsionnet import plot

SHEET = """\
# all values are real
No.;Description;Inertia [kgm²];Stiffness [MNm/rad];Abs. damping [Nms/rad];Outer diameter [mm];Speed ratio [-]
1;Damper ring;145,0;2,2;;;1
2;Damper housing;38;48;;320;1
3;Cyl.;52;36;120;320;1
4;Cyl.;52;42;120;320;1
5;Flywheel;780;0,30;;;1
6;Pinion;14;;;;1
7;Wheel;640;20;;300;0,25
8;Propeller;6200;;37300;;0,25
"""

file = Path(tempfile.mkdtemp()) / "engine.csv"
file.write_text(SHEET, encoding="utf-8")
print(tn.io.mass_elastic_report(file).report())

# %%
# Where the speed ratio changes there is a gear; all else are inertias, springs and dampers with the names of the sheet.
engine = tn.io.read_mass_elastic(file)
print(engine.modes())
figure = plot.mode_shapes(engine.modes(), engine)
