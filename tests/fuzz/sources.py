"""The sound files that are damaged: those that ship, and small ones of every format."""

from __future__ import annotations

import json
import wave
from functools import cache
from pathlib import Path

import numpy as np
from support.foreign_files import matlab_73, record, written
from support.tors_models import THRUSTER

import torsionnet as tn
from fuzz import reuse, running
from torsionnet.io import write_frequency_response
from torsionnet.io.tors_writing import to_tors
from torsionnet.model.files.library import library_models
from torsionnet.signals import write_recording

RIG = """\
torsionnet: 1
name: disc
elements:
  rotor: {type: inertia, node: a, inertia: J}
  shaft: {type: spring, nodes: [a, ground], stiffness: k, damping: c}
  sleeve: {type: tabulated_spring, nodes: [a, b], table: [[1 Hz, 100, 10], [50 Hz, 200, 20]]}
  wheel: {type: inertia, node: b, inertia: 0.2 kg*m^2}
parameters: {J: 0.1, k: 400 N*m/rad, c: 1}
inputs: {T: {torque: a}}
sensors: {phi: {angle: a}, M: {torque: shaft}}
configurations: {soft: {k: 200 N*m/rad}, hard: {k: 800 N*m/rad}}
operating_point: {speed: {a: 1500 rpm}}
"""
BENCH = """\
torsionnet: 1
name: bench
model: rig.yaml
configuration: soft
bench:
  drive: T
  excitation: {type: linear chirp, start: 0.5 Hz, stop: 40 Hz, duration: 4 s, amplitude: 15 N*m}
  exciter:    {bandwidth: 60 Hz, harmonics: {2: 2 %, 3: 1.3 %}, limit: 110 N*m, bits: 13, full_scale: 110 N*m}
  channels:
    M:   {type: transducer, range: 230 N*m, noise: 0.23 N*m}
    phi: {type: encoder, lines: 1024}
  acquisition: {rate: 200 Hz, bits: 16}
  seed: 1
"""
EXCITATIONS = (
    "{type: multisine, low: 1 Hz, high: 40 Hz, duration: 4 s, amplitude: 5 N*m}",
    "{type: burst random, low: 1 Hz, high: 40 Hz, duration: 4 s, amplitude: 5 N*m}",
    "{type: stepped sine, frequencies: [1 Hz, 5 Hz], amplitude: 5 N*m}",
    "{type: logarithmic sweep, start: 0.5 Hz, stop: 40 Hz, duration: 4 s, amplitude: 15 N*m}",
)
FIT = """\
torsionnet: 1
model: rig.yaml
parameters:
  k: {start: 0.3 kN*m/rad, bounds: [50, 2 kN*m/rad]}
  c: {prior: [1, 0.5 N*m*s/rad]}
measurements:
  soft: {record: run.npz, output: phi, input: T_set, model_input: T, band: [1 Hz, 25 Hz], excluded: [[5 Hz, 6 Hz]]}
  other: {response: frf.csv, output: phi, input: T, configuration: hard, delay: true, error: 2 %}
settings: {window: hann, seconds: 1 s, overlap: 50 %, detrend: linear, decimation: 2}
residual: log
loss: huber
starts: 1
"""
STUDY = """\
torsionnet: 1
name: spread
model: rig.yaml
configurations: [soft, hard]
vary:
  k: {type: normal, deviation: 4 %, low: 0}
  J: {type: lognormal, deviation: 10 %}
  c: {type: list, values: [0.5, 2 N*m*s/rad]}
correlation:
  - {between: [k, J], coefficient: 0.4}
sampling: {method: latin_hypercube, count: 5, seed: 3}
quantities:
  f_1: {type: natural_frequency, mode: 1}
  z: {type: damping_ratio, mode: 1}
  H: {type: response, output: phi, input: T, band: 1..20 Hz, points: 5}
  top: {type: peak, output: phi, input: T, band: 1..40 Hz}
  e: {type: expression, of: 2*f_1/z}
limits: {z: {above: 1 %}, f_1: {below: 9 Hz, above: 2 Hz}}
answers:
  share: {type: yield}
  most: {type: scatter, quantities: [f_1, z]}
  bands: {type: percentile_bands, quantity: H}
"""
REPORT = """\
report:
  title: A disc
  author: A. Engineer
  transfer_functions: [phi/T]
  band: 1..200 Hz
  angle: deg
  sections: [summary, parameters, kinematics, modes, responses, validity]
  notes: Nothing.
"""

WHOLE_REPORT = f"{RIG}report:\n  transfer_functions: [phi/T]\n"
"""With every section, so that all modules are loaded."""


def furnish(folder: Path) -> None:
    """What bench and fit files refer to."""
    (folder / "rig.yaml").write_text(RIG)
    (folder / "bench.yaml").write_text(BENCH)
    write_recording(tn.load_bench(folder / "bench.yaml").run(), folder / "run.npz")
    response = tn.load(folder / "rig.yaml").configured("hard").frequency_response("phi", "T", np.linspace(1, 25, 25))
    write_frequency_response(response, folder / "frf.csv")
    running.furnish(folder)
    reuse.furnish(folder)


@cache
def models() -> tuple[str, ...]:
    return (RIG, *(path.read_text(encoding="utf-8") for path in library_models().values()))


@cache
def tors() -> tuple[str, ...]:
    return (json.dumps(THRUSTER), *(json.dumps(to_tors(tn.load(name))) for name in ("geared_branch", "oil_engine")))


LABVIEW = b"""LabVIEW Measurement\t
Separator\tTab
Decimal_Separator\t.
***End_of_Header***\t
Channels\t2
Samples\t2\t2
Time\t10:12:13.001\t10:12:13.001
Y_Unit_Label\tNm\tdeg
X0\t0.0\t0.0
Delta_X\t0.001\t0.001
***End_of_Header***\t\t
X_Value\tM\tphi\tComment
\t1.0\t2.0
\t1.5\t2.5
"""


@cache
def records(folder: Path, ending: str) -> tuple[bytes, ...]:
    """Records of one format, with several forms where it has them."""
    if ending == ".wav":  # read only
        with wave.open(str(folder / "r.wav"), "wb") as file:
            file.setparams((2, 2, 1000, 60, "NONE", ""))
            file.writeframes(np.int16(1000 * record(120)["T_T"].values).tobytes())
        return ((folder / "r.wav").read_bytes(),)
    found = [written(folder, ending, 60).read_bytes()]
    if ending == ".mat":
        from scipy.io import savemat

        values = record(60)["T_T"].values
        content = {"x": values, "s": {"time": np.arange(60) / 1e3, "y": values}, "c": np.array(["a", 1], dtype=object)}
        savemat(folder / "packed.mat", content, do_compression=True)
        found.append((folder / "packed.mat").read_bytes())
    if ending in {".mat", ".h5"}:
        found.append(matlab_73(folder / "new.mat").read_bytes())
    if ending == ".csv":
        found += [
            b"t [s];M [Nm]\n0,0;1,0\n0,1;2,5\n0,2;2,5\n",
            b"# rig\nzeit\tphi / deg\n0.00\t1.5\n0.01\t2.5\n0.02\t2.6\n",
            b"time;M [Nm]\n03.05.2024 23:59:59,99;1,0\n04.05.2024 00:00:00,00;2,5\n04.05.2024 00:00:00,01;2,5\n",
            LABVIEW,
            b"Time,Channel A\n(ms),(V)\n\n0.0,1.0\n0.1,2.5\n0.2,2.6\n",
            b"X,CH1,Start,Increment,\nSequence,Volt,-1E-03,1E-04,\n0,1.5,,\n1,2.5,,\n2,2.6,,\n",
        ]
    return tuple(found)


@cache
def responses(folder: Path, ending: str) -> tuple[bytes, ...]:
    response = tn.load("dmf_rig").frequency_response(["theta_1", "T_T"], "T_M", np.linspace(1, 25, 12))
    path = folder / f"response{ending}"
    write_frequency_response(response, path)
    if ending != ".csv":
        return (path.read_bytes(),)
    response.to_csv(folder / "table.csv")
    return path.read_bytes(), (folder / "table.csv").read_bytes()
