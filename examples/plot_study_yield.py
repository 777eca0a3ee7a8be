"""
How many ships keep their limits
================================

A ship's plant is examined with the values in its drawings. Rubber, damper and propeller scatter around these; how many
plants keep the limit of the crankshaft with 5 % and that of hammering teeth with 10 % in reserve, with one cylinder
without injection or without gas? With all cylinders firing both are used less. The study is a file of the library,
``torsionnet study marine_yield``; every variant is a synthesis of all orders over the speeds that matter to a limit.
"""

import torsionnet as tn

study = tn.load_study("marine_yield")
result = tn.study.run_study(study)
share = study.answers["yield"].conclude(study, result)
figure = share.figure(units=study.shown_units())
print("\n".join(share.sentences))

# %%
# Each limit has a condition of its own in which it is lost: the crankshaft without injection, the teeth without gas.
# Twenty draws are few: the interval says so. What belongs to the largest value is a variant like any other,
# and a model.

names = list(study.space.names)
worst = result.summary("crankshaft", "firing=misfire")
index = int(worst.moments.largest_at[0])
values = result.parameters("firing=misfire")
print(f"crankshaft used to {worst.moments.largest[0]:.1%} in variant {index}:")
for name in names:
    print(f"  {name} = {values[name][index]:.4g}, in the drawing {study.model.parameters[name]:.4g}")
