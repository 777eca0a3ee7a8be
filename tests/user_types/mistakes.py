"""Programs that fail when they run, one a line: a type checker has to say so."""

import torsionnet as tn
from torsionnet import Drivetrian  # wrong
from torsionnet.io import read_recordings  # wrong

tn.Inertia("motor")  # wrong
tn.Inertia("motor", 0.078, "a")  # wrong
tn.Inertia("motor", "a", inertai=0.078)  # wrong
tn.Inertia("motor", "a", ["0.078"])  # wrong
tn.Inertia("motor", "a", None)  # wrong
tn.Inertia("motor", "a", 0.078, "text")  # wrong
tn.Inertai("motor", "a", 0.078)  # wrong
tn.Spring("shaft", "ab", 4e3)  # wrong
tn.Spring("shaft", ("a", "b", "c"), 4e3)  # wrong
tn.Spring(nodes=("a", "b"), stiffness=4e3)  # wrong
tn.Gear("stage", ("a", "b"), teeth=(17.5, 61))  # wrong
tn.Clutch("clutch", ("a", "b"), "shut")  # wrong
tn.Gearbox("box", "a", "b", ratios=[3.77, 1.96])  # wrong
tn.Planetary("set", "sun", "ring", "carrier", planets=2.5)  # wrong
tn.Spring("shaft", ("a", "b"), 4e3).stifness  # wrong
tn.load()  # wrong
tn.load(3)  # wrong
tn.laod("dmf_rig")  # wrong
tn.load("dmf_rig").mode()  # wrong
tn.load("dmf_rig").modes().natural_freqs  # wrong
tn.load("dmf_rig").frequency_response("twist", "T", [1.0], loadd=1)  # wrong
tn.plot.bod(tn.load("dmf_rig").frequency_response("twist", "T", [1.0]))  # wrong
tn.plot.bode("twist")  # wrong
tn.signals.Welch(second=4)  # wrong
tn.document  # wrong
tn.interchange  # wrong
tn.Spring("shaft", ("a", "b"), 4e3)
tn.load("dmf_rig").modes()
