"""
A sweep on a simulated bench
============================

What would the test bench of the AMT rig measure? A torque chirp drives the model; the angle is read in steps of an
encoder, the torque with the noise of its meter. The frequency response estimated from these two records is laid over
that of the model. Amplitude, duration and noise are our choice where the source paper does not state them.
"""

from dataclasses import replace

import numpy as np

import torsionnet as tn
from torsionnet import plot, signals

rig = tn.load("amt_rig").configured("III")
rate, step = 10e3, 2 * np.pi / 4096  # 1024 lines in quadrature
chirp = signals.LinearChirp(start=0.1, stop=80, duration=100, amplitude=15)
record = rig.simulate(["theta_1", "T_T"], {"T_M": chirp.samples(rate)}, rate)

angle, torque = record["theta_1"], record["T_T"]
noise = 0.23 * np.random.default_rng(0).standard_normal(len(record))  # 0.1 % of 230 N m
record = record.with_signals(
    replace(angle, values=step * np.round(angle.values / step)), replace(torque, values=torque.values + noise)
)

# %%
# Estimate with the settings of the source paper: decimated to 200 Hz, Hamming windows of 2 s, 80 % overlap, H2.
# The angle gets small with frequency, until the encoder cannot resolve it: below four steps at the dotted line.
test = signals.estimate(record, "theta_1", "T_T", settings=signals.PAPER).between(0.5, 40)
model = rig.frequency_response("theta_1", "T_T", test.frequencies)
amplitude = 15 * np.abs(rig.frequency_response("theta_1", "T_M", test.frequencies).values[:, 0, 0])
limit = signals.resolution_limit(test.frequencies, amplitude, step)

deg = tn.Conventions(angle="deg")
figure = plot.bode([test, model], conventions=deg, labels=["estimated, H2", "model"], title="AMT rig, gear III")
for axes in figure.axes:
    axes.axvline(limit, color="#888888", linestyle=":")

# %%
# Beyond it the steps bias the magnitude by decibels while the coherence still looks well: a coarse encoder answers to
# the torque, only not in proportion. Coherence alone does not tell how far an estimate can be trusted.
trusted = test.frequencies <= limit
apart = signals.difference(test, model)
for name, part in (("up to", trusted), ("beyond", ~trusted)):
    worst = [np.abs(values[part]).max() for values in (apart.decibels, apart.degrees)]
    print(f"{name} {limit:.1f} Hz: within {worst[0]:.2f} dB and {worst[1]:.1f} degrees")
