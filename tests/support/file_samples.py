"""Small files of every kind, as this version writes them.

``PYTHONPATH=.:tests python -m support.file_samples FOLDER`` wrote ``tests/samples_1_0`` with version 1.0. Those files never change: every
later 1.x reads them. A later version that writes something new writes a folder of its own beside it.
"""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import torsionnet as tn
from support.models import EVERY_ELEMENT
from torsionnet.app.cli import main
from torsionnet.study import Workers, answer_study, load_study

LIBRARY = Path(__file__).parents[2] / "library"
MODELS = ("amt_rig", "engine_generator_set", "front_wheel_drive_car", "two_stroke_ship", "wind_turbine_3mw")
RESPONSES = ("csv", "npz", "mat", "uff")
RECORDS = ("csv", "npz", "mat", "uff", "tdms", "h5", "parquet")
RIG = """\
torsionnet: 1
name: two discs
elements:
  rotor: {type: inertia, node: a, inertia: 0.1}
  shaft: {type: spring, nodes: [a, ground], stiffness: k, damping: 1}
parameters: {k: 400 N*m/rad}
inputs: {T: {torque: a}}
sensors: {phi: {angle: a}, M: {torque: shaft}}
configurations: {soft: {k: 200 N*m/rad}, hard: {k: 800 N*m/rad}}
bench:
  excitation: {type: linear chirp, start: 1 Hz, stop: 30 Hz, duration: 2 s, amplitude: 5 N*m}
  channels: {M: {type: transducer, noise: 0.01 N*m}, phi: {type: encoder, lines: 5000, quadrature: true}}
  acquisition: {rate: 100 Hz}
"""
BENCH = """\
torsionnet: 1
model: rig.yaml
configuration: soft
bench:
  excitation: {type: multisine, start: 1 Hz, stop: 20 Hz, period: 2 s, periods: 2, amplitude: 5 N*m}
  channels: {phi: {type: encoder, lines: 5000, quadrature: true}}
  acquisition: {rate: 100 Hz, bits: 16}
"""
FIT = """\
torsionnet: 1
model: rig.yaml
parameters: {k: {start: 300 N*m/rad, bounds: [50, 2000]}, shaft.damping: {start: 2 N*m*s/rad}}
measurements: {soft: {response: response.csv, output: phi, input: T, configuration: soft, band: [1 Hz, 25 Hz]}}
true: {k: 200 N*m/rad, shaft.damping: 1}
"""
STUDY = """\
torsionnet: 1
name: spread of the rig
model: rig.yaml
configurations: [hard]
vary: {k: {type: normal, deviation: 5 %}, shaft.damping: {type: uniform, low: 0.8, high: 1.2}}
sampling: {method: latin_hypercube, count: 12, seed: 3}
quantities:
  f_1: {type: natural_frequency, mode: 1}
  H: {type: response, output: phi, input: T, band: 1..20 Hz, points: 3}
limits: {f_1: {below: 14.6}}
answers: {yield: {type: yield}}
"""


def write_samples(folder: Path) -> None:
    """Write all files into a folder, models and plans as text, results by the package."""
    for name in MODELS:
        (folder / f"{name}.yaml").write_text((LIBRARY / f"{name}.yaml").read_text(encoding="utf-8"), encoding="utf-8")
        tn.load(name).to_yaml(folder / f"{name}_written.yaml")
    elements = {kind: one.to_data() for kind, one in EVERY_ELEMENT.items()}
    (folder / "elements.json").write_text(json.dumps(elements, indent=1) + "\n", encoding="utf-8")
    for name, text in {"rig": RIG, "bench": BENCH, "fit": FIT, "study": STUDY}.items():
        (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    rig = tn.load(folder / "rig.yaml")
    response = rig.configured("soft").frequency_response("phi", "T", np.linspace(1, 25, 25))
    noise = 0.01 * np.random.default_rng(1).standard_normal(response.values.shape)
    measured = replace(response, values=response.values * (1 + noise))
    for ending in RESPONSES:
        tn.io.write_frequency_response(measured, folder / f"response.{ending}")
    record = tn.load_bench(folder / "rig.yaml").configured("soft").run()
    for ending in RECORDS:
        tn.io.write_recording(record, folder / f"record.{ending}")
    tn.io.write_tors(tn.load("oil_engine"), folder / "oil_engine.json")
    tn.io.write_mass_elastic(tn.load("marine_steam_turbine"), folder / "marine_steam_turbine.csv")
    fitted = ["fit", str(folder / "fit.yaml"), "-o", str(folder / "fit_result.yaml")]
    if main(fitted):
        raise SystemExit(fitted)
    answer_study(load_study(folder / "study.yaml"), folder / "study_folder", workers=Workers())


if __name__ == "__main__":
    Path(sys.argv[1]).mkdir()
    write_samples(Path(sys.argv[1]))
