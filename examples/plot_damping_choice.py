"""
Viscous or hysteretic? Let the record decide
============================================

A dual-mass flywheel with arc springs loses energy by friction, at a rate that does not depend on frequency. Here a
virtual record is made with such a hysteretic spring, and three models are fitted to it: a viscous damper, a hysteretic
spring, and both. Akaike's criterion weighs the fit against the number of parameters.
"""

from dataclasses import replace

import numpy as np

import torsionnet as tn
from torsionnet import plot
from torsionnet.bench import Encoder
from torsionnet.identification import Candidate, choose_model
from torsionnet.signals import PAPER


def rig(eta: float, c_2: float) -> tn.Drivetrain:
    """The DMF rig with a hysteretic spring and a viscous damper in its flywheel."""
    paper = tn.load("dmf_rig")
    elements = [element for name, element in paper.definition.elements.items() if name != "dmf"]
    ends = ("primary", "secondary")
    elements.append(tn.HystereticSpring("dmf", nodes=ends, stiffness="k_2", loss_factor="eta"))
    elements.append(tn.Damper("oil", nodes=ends, damping="c_2"))
    return tn.Drivetrain(
        "DMF rig",
        elements,
        parameters=dict(paper.parameters) | {"eta": eta, "c_2": c_2},
        inputs={"T_M": {"torque": "motor"}},
        sensors={"theta_1": {"angle": "motor"}, "T_T": {"torque": "torque_meter"}},
    )


bench = tn.load_bench("dmf_bench")
fine = Encoder(lines=1024, quadrature=True)
plan = replace(bench.plan, channels={**bench.plan.channels, "theta_1": fine})
record = tn.Bench(rig(eta=0.4, c_2=0.0), plan).run()

# %%
# The three models, all begun at values that are not the true ones.
candidates = {
    "viscous": Candidate(rig(0.0, 2.0), ["c_2", "k_2"]),
    "hysteretic": Candidate(rig(0.2, 0.0), ["eta", "k_2"]),
    "both": Candidate(rig(0.2, 2.0), ["eta", "c_2", "k_2"]),
}
test = tn.Measurement(record, "theta_1", "T_T", settings=PAPER, band=(0.5, 17), name="sweep")
choice = choose_model(candidates, test)
print(choice.table().to_text())

# %%
# The residuals show what the viscous model lacks: at low frequency the test lags, and no viscous damper does there.
deg = tn.Conventions(angle="deg")
viscous = plot.fit(choice.fits["viscous"], conventions=deg, title="viscous damper")
hysteretic = plot.fit(choice.fits["hysteretic"], conventions=deg, title="hysteretic spring")

# %%
one = choice.fits["viscous"].comparisons[0]
lag = np.degrees(np.angle(one.measured / one.fitted))
print(f"at {one.frequencies[0]:g} Hz the test lags the viscous model by {-lag[0]:.1f} degrees")
