"""Functional mock-up units, run by FMPy: against the exact motion of Drivetrain.simulate, step by step."""

import warnings
import zipfile

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.errors import MissingExtraError, UsageError
from torsionnet.interchange import write_fmu
from torsionnet.signals.files import extras

pytest.importorskip("pythonfmu")
with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    fmpy = pytest.importorskip("fmpy")
    fmi2 = pytest.importorskip("fmpy.fmi2")
    validation = pytest.importorskip("fmpy.validation")


def run(path, inputs, step):
    """Outputs at every communication point, inputs held from each to the next: (n, n_in) -> (n, n_out)."""
    about = fmpy.read_model_description(str(path))
    references = {variable.name: variable.valueReference for variable in about.modelVariables}
    names = {side: [v.name for v in about.modelVariables if v.causality == side] for side in ("input", "output")}
    unit = fmi2.FMU2Slave(
        guid=about.guid, unzipDirectory=fmpy.extract(str(path), str(path.with_suffix(""))), instanceName="rig",
        modelIdentifier=about.coSimulation.modelIdentifier,
    )  # fmt: skip
    unit.instantiate()
    unit.setupExperiment(startTime=0.0)
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    outputs = []
    for number, row in enumerate(inputs):
        unit.setReal([references[name] for name in names["input"]], [float(value) for value in row])
        outputs.append(unit.getReal([references[name] for name in names["output"]]))
        unit.doStep(currentCommunicationPoint=number * step, communicationStepSize=step)
    unit.terminate()
    unit.freeInstance()
    return names, np.array(outputs)


def staircase(rig, names, inputs, step, finer=1):
    """The exact answer to held inputs: answers to steps by ``simulate``, shifted and added up."""
    total = np.zeros((len(inputs), len(names["output"])))
    for column, name in enumerate(names["input"]):
        record = rig.simulate(names["output"], {name: np.ones(len(inputs) * finer)}, finer / step)
        answers = np.array([record[output].values[::finer] for output in names["output"]])
        rises = np.diff(inputs[:, column], prepend=0)
        total += np.array([np.convolve(rises, answer)[: len(inputs)] for answer in answers]).T
    return total


@pytest.mark.parametrize(
    ("name", "configuration", "step"),
    [
        ("dmf_rig", "", 1e-3),
        ("amt_rig", "V", 2e-3),
        ("drill_string", "", 5e-3),
        ("wind_turbine_5mw", "", 1e-2),
    ],
)
def test_steps_exactly(tmp_path, name, configuration, step):
    rig = tn.load(name).configured(configuration) if configuration else tn.load(name)
    write_fmu(rig, tmp_path / "rig.fmu", step)
    inputs = np.random.default_rng(1).normal(size=(400, len(rig.inputs))) * 100
    names, found = run(tmp_path / "rig.fmu", inputs, step)
    assert (names["input"], names["output"]) == (list(rig.inputs), list(rig.sensors))
    expected = staircase(rig, names, inputs, step)
    np.testing.assert_allclose(found / np.abs(expected).max(axis=0), expected / np.abs(expected).max(axis=0), atol=1e-9)


@pytest.mark.parametrize("multiple", [2, 3, 7])
def test_whole_multiples_of_the_step(tmp_path, multiple):
    rig = tn.load("dmf_rig")
    write_fmu(rig, tmp_path / "rig.fmu", 1e-3)
    inputs = np.random.default_rng(1).normal(size=(50, 1))
    names, found = run(tmp_path / "rig.fmu", inputs, multiple * 1e-3)
    expected = staircase(rig, names, inputs, multiple * 1e-3, finer=multiple)
    np.testing.assert_allclose(found, expected, atol=1e-11 * np.abs(expected).max())


def test_another_step_is_refused(tmp_path):
    write_fmu(tn.load("dmf_rig"), tmp_path / "rig.fmu", 1e-3)
    with pytest.raises(Exception, match=r"(?i)doStep|discard"):
        run(tmp_path / "rig.fmu", np.ones((3, 1)), 1.5e-3)


def test_fmpy_finds_no_fault_in_it(tmp_path):
    write_fmu(tn.load("drill_string"), tmp_path / "rig.fmu", 1e-3)
    assert validation.validate_fmu(str(tmp_path / "rig.fmu")) == []
    about = fmpy.read_model_description(str(tmp_path / "rig.fmu"))
    assert (about.fmiVersion, about.modelName, about.description) == ("2.0", "Drill_string", "Drill string")
    units = {variable.name: variable.unit for variable in about.modelVariables}
    assert units == {
        "T_T": "N.m", "T_B": "N.m", "table_speed": "rad/s", "bit_speed": "rad/s", "pipe_torque": "N.m",
        "pipe_twist": "rad",
    }  # fmt: skip


def test_simulate_fmu_runs_it(tmp_path):
    rig = tn.load("dmf_rig")
    write_fmu(rig, tmp_path / "rig.fmu", 1e-3)
    result = fmpy.simulate_fmu(
        str(tmp_path / "rig.fmu"), stop_time=0.5, output_interval=1e-3, start_values={"T_M": 10.0}
    )
    record = rig.simulate("theta_1", {"T_M": np.full(len(result), 10.0)}, 1e3)
    np.testing.assert_allclose(result["theta_1"], record["theta_1"].values, atol=1e-12)


def test_equal_models_give_equal_bytes_and_others_do_not(tmp_path):
    for name, value in (("a", 460), ("b", 460), ("c", 461)):
        write_fmu(tn.load("dmf_rig").configured(k_2=value), tmp_path / f"{name}.fmu")
    a, b, c = ((tmp_path / f"{name}.fmu").read_bytes() for name in "abc")
    assert a == b
    guids = {fmpy.read_model_description(str(tmp_path / f"{name}.fmu")).guid for name in "abc"}
    assert len(guids) == 2
    assert c != a
    with zipfile.ZipFile(tmp_path / "a.fmu") as archive:
        assert b'generationDateAndTime="1980-01-01T00:00:00Z"' in archive.read("modelDescription.xml")
        assert {entry.date_time[0] for entry in archive.infolist()} == {1980}


def test_needs_only_numpy_where_it_runs(tmp_path):
    write_fmu(tn.load("dmf_rig"), tmp_path / "rig.fmu")
    with zipfile.ZipFile(tmp_path / "rig.fmu") as archive:
        source = archive.read("resources/torsionnet_slave.py").decode()
    imported = {line.split()[1].split(".")[0] for line in source.splitlines() if line.startswith(("import ", "from "))}
    assert imported == {"__future__", "collections", "json", "numpy", "pathlib", "pythonfmu", "typing", "xml"}


def test_leaves_no_trace_in_the_program(tmp_path):
    import sys

    before = (list(sys.path), "torsionnet_slave" in sys.modules)
    write_fmu(tn.load("dmf_rig"), tmp_path / "rig.fmu")
    assert (list(sys.path), "torsionnet_slave" in sys.modules) == before
    assert [path.name for path in tmp_path.iterdir()] == ["rig.fmu"]


@pytest.mark.parametrize(
    ("rig", "name", "step", "text"),
    [
        (lambda: tn.load("dmf_rig"), "rig.zip", 1e-3, "ending in .fmu"),
        (lambda: tn.load("dmf_rig"), "rig.fmu", 0, "positive time in s"),
        (lambda: tn.load("dmf_rig"), "rig.fmu", float("nan"), "positive time in s"),
        (
            lambda: tn.Drivetrain("x", [tn.Inertia("i", node="a", inertia=2)]),
            "rig.fmu",
            1e-3,
            "one input and one sensor",
        ),
        (
            lambda: tn.load("six_cylinder_diesel").configured("viscous_and_hysteretic"),
            "rig.fmu",
            1e-3,
            "depends on frequency",
        ),
    ],
)
def test_refusals(tmp_path, rig, name, step, text):
    with pytest.raises(UsageError, match=text):
        write_fmu(rig(), tmp_path / name, step)
    assert list(tmp_path.iterdir()) == []


def test_missing_extra_names_the_command(tmp_path, monkeypatch):
    monkeypatch.setitem(extras.PACKAGES, "fmu", ("no_such_module", "pythonfmu", "FMU"))
    with pytest.raises(MissingExtraError, match=r'pip install "torsionnet\[fmu\]"'):
        write_fmu(tn.load("dmf_rig"), tmp_path / "rig.fmu")
