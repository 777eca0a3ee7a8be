"""A table over frequency that ends before it is read is noted, with both numbers, by every command and result."""

import json
import re

import pytest
from support.command_line import run

import torsionnet as tn
from torsionnet.study.run.answering import answer_study

ROWS = (2.0, 20.0)
MODEL = """torsionnet: 1
name: plant on a table
parameters: {k: 40 kN*m/rad, c: 10 N*m*s/rad}
elements:
  engine: {type: inertia, node: fly, inertia: 3}
  bush: {type: tabulated_spring, nodes: [fly, load], table: [[2, 30 kN*m/rad, 30], [20, 35 kN*m/rad, 20]]}
  shaft: {type: spring, nodes: [load, end], stiffness: k, damping: c}
  load: {type: inertia, node: load, inertia: 2}
  hold: {type: spring, nodes: [end, ground], stiffness: 5 kN*m/rad, damping: 5}
  end: {type: inertia, node: end, inertia: 1}
inputs: {T: {torque: fly}}
sensors: {th: {angle: fly}, w: {velocity: fly}, tq: {torque: shaft}}
speeds: {of: fly, range: 600..1500 rpm, step: 50 rpm, rated: 1500 rpm}
load: {absorbed_at: end, power: 10 kW, torque_exponent: 2, driven_by: {fly: 1}}
excitations:
  misfire: {type: harmonic, node: fly, orders: {0.5: {amplitude: 100 N*m}, 3: {amplitude: 50 N*m}}}
limits: {sh: {rule: curve, output: torque(shaft), value: 4 kN*m, source: maker}}
scenarios:
  step: {type: torques, duration: 0.2 s, rate: 1 kHz, torque: {fly: 10 N*m}}
bench:
  drive: T
  excitation: {type: linear chirp, start: 1 Hz, stop: 80 Hz, duration: 4 s, amplitude: 15 N*m}
  channels:
    w: {type: transducer, range: 230 rad/s, noise: 0.0001 rad/s}
    tq: {type: transducer, range: 230 N*m, noise: 0.01 N*m}
  acquisition: {rate: 400 Hz, bits: 24}
  seed: 1
"""
STUDY = """torsionnet: 1
name: study
model: plant.yaml
vary: {k: {type: list, values: [30 kN*m/rad, 40 kN*m/rad]}}
quantities: {p: {type: peak, output: th, input: T, band: 5..60 Hz}}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("tables")
    (place / "plant.yaml").write_text(MODEL, encoding="utf-8")
    (place / "study.yaml").write_text(STUDY, encoding="utf-8")
    fit = "torsionnet: 1\nmodel: plant.yaml\nparameters: {k: {start: 38 kN*m/rad}}\nmeasurements:\n"
    record = "  a: {record: rec.npz, output: w, input: tq, band: 5..60 Hz}\n"
    (place / "fit.yaml").write_text(fit + record, encoding="utf-8")
    return place


@pytest.fixture(scope="module")
def recorded(folder):
    """Output of the bench, which writes the record that others read."""
    return run("bench", folder / "plant.yaml", "-o", folder / "rec.npz").output


def read_beyond(text):
    """Lowest and highest frequency in Hz at which notes of a text say that the table is read beyond its rows."""
    first, last = (
        r"from ([\d.e+-]+) Hz, where the first row is kept",
        r"at up to ([\d.e+-]+) Hz, where the last row is kept",
    )
    note = rf"[Bb]ush: the rows of its table go from 2 to 20 Hz, and it is read (?:{first})?(?:, and )?(?:{last})?"
    notes = re.findall(note, " ".join(text.split()))
    assert notes, text
    numbers = [float(found) for pair in notes for found in pair if found]
    low, high = min(numbers), max(numbers)
    return (low if low < ROWS[0] else None), (high if high > ROWS[1] else None)


def highest_mode(folder):
    return max(mode["damped_frequency_Hz"] for mode in modes_of(folder))


def modes_of(folder):
    (found,) = json.loads(run("modes", folder / "plant.yaml", "--json").stdout)
    return found["modes"]


@pytest.mark.parametrize(
    ("command", "low", "high"),
    [
        ("modes", None, highest_mode),
        ("sensitivity", None, highest_mode),
        ("critical-speeds", None, highest_mode),
        ("holzer --at 50", None, 50),
        ("frf --output th --input T --frequencies 5,50", 0, 50),  # the static value, too
        ("frf --output th --input tq --full --frequencies 1,50", 1, 50),
        ("orders --output tq", None, 75),  # order 3 at 1500 rpm
        ("limits", None, 75),
        ("static", 0, None),
        ("simulate step", 0, 500),
        ("damper --vary c=1..100 --output tq", None, 75),
        pytest.param("damper --vary c=1..100 --output tq --input T --band 5 60", None, 60, marks=pytest.mark.slow),
        ("export --viscous-at 50 -o plant.m", None, 50),
    ],
)
def test_every_command_notes_it(command, low, high, folder):
    name, *options = command.split()
    options = [folder / one if one == "plant.m" else one for one in options]
    scenario = [options.pop(0)] if name == "simulate" else []
    found = run(name, folder / "plant.yaml", *scenario, *options)
    expected = high(folder) if callable(high) else high
    lowest, highest = read_beyond(found.output)
    assert lowest == low
    assert highest == (expected and pytest.approx(expected, rel=1e-5))


def test_tests_of_it_note_it(recorded, folder):
    assert read_beyond(recorded) == (0, 200)  # half the rate of the record
    compared = run(
        "compare", folder / "rec.npz", folder / "plant.yaml", "--output", "w", "--input", "tq", "--band", 5, "inf"
    )
    assert read_beyond(compared.stdout) == (None, 200)
    assert read_beyond(run("fit", folder / "fit.yaml").output) == (None, pytest.approx(60))


def test_a_report_notes_the_widest_of_all_its_sections(folder):
    """The scenario is read up to half its rate; without it order 3 at 1500 rpm."""
    for sections, high in ((), 500), (("modes", "orders", "limits", "validity"), 75):
        file = folder / "report.md"
        run("report", folder / "plant.yaml", "-o", file, *(part for one in sections for part in ("--section", one)))
        validity = file.read_text(encoding="utf-8").rpartition("Validity")[2]
        assert read_beyond(validity)[1] == high


ANSWERS = {
    "best_damper": {"output": "tq", "design": {"c": ["1 N*m*s/rad", "100 N*m*s/rad"]}},
    "optimum": {"minimise": "p", "design": {"k": ["30 kN*m/rad", "50 kN*m/rad"]}},
    "tornado": {},
    "worst_case": {"quantity": "p", "tried": 20},
}


@pytest.mark.parametrize(("kind", "high"), [("best_damper", 75), ("optimum", 60), ("tornado", 60), ("worst_case", 60)])
def test_answers_of_studies_note_what_their_own_variants_read(kind, high, folder, tmp_path):
    vary = {"k": {"type": "uniform", "low": "30 kN*m/rad", "high": "40 kN*m/rad"}}
    peak = {"p": {"type": "peak", "output": "th", "input": "T", "band": "5..60 Hz"}}
    model = tn.load(folder / "plant.yaml")
    study = tn.study.define(model, vary, peak, answers={kind: {"type": kind, **ANSWERS[kind]}})
    for place in (None, tmp_path / "kept", tmp_path / "kept"):  # calculated, written, read back
        answered = answer_study(study, place)
        assert read_beyond(" ".join(answered.sentences(kind))) == (None, high)


def test_a_study_with_answers_prints_their_notes(folder):
    file = folder / "damped.yaml"
    file.write_text(f"{STUDY}answers: {{d: {json.dumps({'type': 'best_damper', **ANSWERS['best_damper']})}}}\n")
    assert read_beyond(run("study", file).output) == (None, 75)
    answers = json.loads(run("study", file, "--json").stdout)["answers"]
    assert read_beyond(" ".join(answers["d"]["sentences"])) == (None, 75)


def at_50(rig):
    return abs(rig.frequency_response("th", "T", [50.0]).values[0, 0, 0])


def static_twist(rig):
    return rig.mean_response("twist(bush)").values[0, 0]


@pytest.mark.parametrize(("of", "low", "high"), [(at_50, None, 50), (static_twist, 0, None)])
def test_functions_of_users_in_studies_note_it(of, low, high, folder):
    vary = {"k": {"type": "list", "values": [3e4, 4e4]}}
    study = tn.study.define(tn.load(folder / "plant.yaml"), vary, {"q": tn.study.function(of)})
    assert read_beyond(" ".join(tn.study.run_study(study).notes)) == (low, high)
