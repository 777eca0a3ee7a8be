"""
From a TDMS file to a response against the model
================================================

The whole way of a test engineer: a record in a file, a look at it, the response with its coherence, the model over it.
The file is written here by the virtual bench of the AMT rig with the sensors of Galvagno et al. (2015); with a file of
your own begin at the second step. TDMS needs ``pip install "torsionnet[tdms]"``.
"""

import tempfile
from pathlib import Path

import torsionnet as tn
from torsionnet import plot, signals

file = Path(tempfile.mkdtemp(), "gear_IV.tdms")
bench = tn.load_bench("amt_bench").configured("IV")
signals.write_recording(bench.run(), file)

# %%
# Read it. Every channel has a quantity and is in SI; what was assumed is in the notes, what is wrong is listed.
record = signals.read_recording(file)
print(record)
for note in record.notes:
    print(note)
for fault in signals.check_recording(record):
    print(fault)

# %%
# The torque of the motor falls with frequency, and the torque meter shows twice and three times the frequency as well.
deg = tn.Conventions(angle="deg")
histories = plot.time_histories(record, ["T_T", "theta_1"], conventions=deg)
torque = signals.spectrogram(record, "T_T", signals.Welch(decimation=50))
spectrogram = plot.spectrogram(torque)

# %%
# Estimate with the paper's settings: decimated to 200 Hz, Hamming windows of 2 s, 80 % overlap, H2. The notes say up to
# where the encoder resolves the motion.
test = signals.estimate(record, "theta_1", "T_T", settings=signals.PAPER).between(0.5, 40)
for note in test.notes:
    print(note)

# %%
# Ask the model for the same response at the same frequencies. A measured torque as input cuts the drivetrain there, so
# the rotor before the torque meter plays no part.
model = bench.drivetrain.frequency_response("theta_1", "T_T", test.frequencies)
figure = plot.comparison(test, model, conventions=deg)

# %%
trusted = [response.between(0.5, test.usable_up_to) for response in (test, model)]
apart = signals.difference(*trusted)
print(f"up to {test.usable_up_to:.1f} Hz within {abs(apart.decibels).max():.2f} dB, {abs(apart.degrees).max():.1f} deg")
print(f"FRAC {signals.frac(*trusted)[0, 0]:.4f}")
