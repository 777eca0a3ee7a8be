"""
Tolerances of a gearbox in all gears
====================================

How much damping has the first mode of the AMT rig, if springs, bearings and oil scatter as they do in series? The study
is a file of the library; on the command line it is one line:

.. code-block:: sh

    torsionnet study amt_tolerances --plot damping.png

The file says what varies, in which gears, what is asked of every variant and what is to be concluded: here 4096
variants in each of four gears, drawn by a Sobol sequence.
"""

import torsionnet as tn

study = tn.load_study("amt_tolerances")
result = tn.study.run_study(study)
print(result.table())

# %%
# The response at the motor, with the bands in which half and 95 % of the rigs lie. At the resonance the
# largest of these responses are twice the smallest ones in every gear.

bands = study.answers["resonance"].conclude(study, result)
figure = bands.figure(units=study.shown_units())
print("\n".join(bands.sentences))

# %%
# Which share of the rigs turns more than 0.5 deg/(N m) at 5 Hz? Third gear has its resonance there.

share = study.answers["yield"].conclude(study, result)
print("\n".join(share.sentences))

# %%
# One parameter at a time over its tolerance: the oil decides in the lower gears, the dual-mass flywheel in fifth.

influence = study.answers["influence"].conclude(study, result)
figure = influence.figure(units=study.shown_units())
