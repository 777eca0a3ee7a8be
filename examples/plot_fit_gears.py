"""
Drag of a gearbox from tests in three gears
===========================================

The paper behind the library's rigs finds c_O and c_B of its transmission from sweeps in gears II, III and IV. Here the
sweeps are virtual, so the values found can be held against the true ones. Each fit predicts the angle from the measured
torque and estimates prediction and test alike, so the windows' leakage does not bias the damping.
"""

from dataclasses import replace

import torsionnet as tn
from torsionnet import plot, sensitivity
from torsionnet.bench import Encoder
from torsionnet.signals import PAPER

bench = tn.load_bench("amt_bench")
fine = Encoder(lines=1024, quadrature=True)
bench = replace(bench, plan=replace(bench.plan, channels={**bench.plan.channels, "theta_1": fine}))
tests = [
    tn.Measurement(bench.configured(gear).run(), "theta_1", "T_T", gear, settings=PAPER) for gear in ("II", "III", "IV")
]
rig = tn.load("amt_rig")
fit = tn.identify(rig, tests, {"c_O": 80, "c_B": 4})
print(fit.table(true={"c_O": 170, "c_B": 1.5}).to_text())
figure = plot.fit(fit, conventions=tn.Conventions(angle="deg"))

# %%
# In one gear alone the two cannot be told apart, and the fit says so: only c_B + c_O/tau^2 acts on the response.
print(*tn.identify(rig, tests[0], {"c_O": 80, "c_B": 4}).verdicts, sep="\n")
matrix = plot.correlation(fit)

# %%
# A test in gear V of a rig with twice the drag: fitted with the others it is named as the one that does not belong.
odd = tn.Measurement(bench.configured("V", c_O=360).run(), "theta_1", "T_T", "V", settings=PAPER)
print(*tn.identify(rig, [*tests, odd], ["c_O", "c_B"]).verdicts, sep="\n")
print(tn.identify(rig, odd, ["c_O"]).values)

# %%
# What else moves the first mode in gear V: the exact derivatives, as a tornado plot.
tornado = plot.tornado(sensitivity.mode_sensitivities(rig.configured("V")), mode=[1])
