"""
A measured hammer test
======================

A blow with an instrumented hammer on a beam, recorded by a signal analyser in 2014: 3.2 s of force and acceleration at
1280 Hz, and the response that the analyser averaged itself. The file ``case1.mat`` belongs to J. C. Slater's package
``vibrationtesting`` (``pip install vibrationtesting``); his ``vibration_toolbox`` has the same file under a licence
that lets anybody use and pass it on with its notice. The beam bends, it does not twist; for the estimation a force is
what a torque is.
"""

from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from scipy.io import loadmat

from torsionnet import plot, signals

package = find_spec("vibrationtesting")
assert package is not None
assert package.origin is not None
file = Path(package.origin).parent / "data" / "case1.mat"
names = {"Time_chan_1": "force", "Time_chan_2": "acceleration"}
quantities = {"Time_chan_1": "torque", "Time_chan_2": "acceleration"}
record = signals.read_recording(file, quantities, names)
for fault in signals.check_recording(record, seconds=3.2):
    print(fault)

# %%
# The hammer has left the beam after 8 ms; what its channel shows then is the decay of its amplifier. The acceleration
# rings for the whole record, so no window is laid over it: the response is one quotient of spectra.
contact = record.time < 8e-3
force = record["force"].values
blow = np.where(contact, force - force[~contact][:50].mean(), 0)
record = record.with_signals(replace(record["force"], values=blow))
histories = plot.time_histories(record, title="One blow: force as a torque, acceleration")

# %%
settings = signals.Welch(window="boxcar", seconds=3.2, overlap=0, detrend="none")
measured = signals.estimate(record, "acceleration", "force", settings=settings).between(10, 380)
for note in measured.notes:
    print(note)

# %%
# The analyser's own response is an average over several blows. It is 1.41 times smaller throughout, a matter of its
# calibration; apart from that factor the two agree, and at the resonances to the line. Above 380 Hz the blow has too
# little power to say anything.
stored = loadmat(file)
theirs = stored["Hf_chan_2"].ravel()[np.isin(stored["Freq_domain"].ravel(), measured.frequencies)]
scale = np.median(np.abs(measured.values[:, 0, 0] / theirs))
analyser = replace(measured, values=scale * theirs[:, None, None], coherence=None, notes=(), title="analyser")
figure = plot.bode(
    [analyser, replace(measured, coherence=None)],
    labels=[f"analyser, times {scale:.2f}", "estimated from the record"],
    title="Hammer test of a beam",
    x_log=False,
)

# %%
apart = signals.difference(measured, analyser)
typical = np.median(np.abs(apart.decibels)), np.median(np.abs(apart.degrees))
print(f"typical difference {typical[0]:.1f} dB, {typical[1]:.1f} degrees")
for low, high in ((20, 60), (150, 300)):
    one, other = (response.between(low, high) for response in (measured, analyser))
    ours, stated = (part.frequencies[part.magnitude[:, 0, 0].argmax()] for part in (one, other))
    print(f"resonance at {ours:.2f} Hz, analyser {stated:.2f} Hz")
