"""Fits whose values run to a limit, and the units of what is found."""

import json
from dataclasses import replace

import numpy as np
import pytest
from support.command_line import run

import torsionnet as tn
from torsionnet.bench.plan import Acquisition, Plan, Transducer
from torsionnet.identification.plan.fit_entries import parameter_quantity
from torsionnet.signals import LinearChirp, Welch

BAND = (1.5, 30.0)
SHORT = Welch("hamming", 2.0, 0.8, decimation=20)


def rig(**parameters):
    """Two discs on a shaft without damping; the drag of the first one is all there is."""
    return tn.Drivetrain(
        "two discs",
        [
            tn.Inertia("first", node="a", inertia="J_1"),
            tn.Spring("shaft", nodes=("a", "b"), stiffness="k", damping="c"),
            tn.Inertia("second", node="b", inertia="J_2"),
            tn.Damper("drag", nodes=("a", "ground"), damping="d"),
        ],
        {"J_1": 0.1, "J_2": 0.05, "k": 600.0, "c": 0.0, "d": 0.8, **parameters},
        inputs={"T": {"torque": "a"}},
        sensors={"n": {"velocity": "a"}, "T_meter": {"torque": "shaft"}},
    )


@pytest.fixture(scope="module")
def record():
    plan = Plan(
        excitation=LinearChirp(start=0.5, stop=40, duration=30, amplitude=10),
        channels={"n": Transducer(noise="0.02 rad/s")},
        acquisition=Acquisition(rate="2 kHz"),
    )
    return tn.Bench(rig(), plan).run(1)


@pytest.mark.few(1)
@pytest.mark.parametrize("start", [0.5, 5.0])
def test_a_damping_that_is_not_there_is_named(record, start):
    """From torque to speed, where it once ended in numbers beyond all range."""
    test = tn.Measurement(record, "n", "T_set", model_input="T", band=BAND, settings=SHORT)
    fit = tn.identify(rig(), test, {"c": start, "k": 500.0, "d": 0.5})
    assert fit.values["k"] == pytest.approx(600, rel=0.002)
    assert fit.values["d"] == pytest.approx(0.8, rel=0.02)
    assert 0 <= fit.values["c"] < 0.005
    assert [text.partition(":")[0] for text in fit.verdicts] in (["c is hardly determined"], ["c runs to zero"])


@pytest.mark.slow
def test_a_damping_that_would_be_negative_runs_to_zero_and_is_named():
    """There is less damping than the model has without it."""
    f = np.linspace(5, 30, 60)
    test = noisy(rig(d=0.7).frequency_response("n", "T", f), 0.01)
    fit = tn.identify(rig(), tn.Measurement(test, "n", "T"), {"c": 0.5, "k": 500.0})
    assert fit.values["c"] == 0
    assert "c runs to zero: the data do not show this damping; leave it out" in fit.verdicts
    assert not any(text.startswith(("c stands", "c is hardly")) for text in fit.verdicts)


def noisy(response, share):
    noise = np.random.default_rng(5).normal(size=response.values.shape)
    return replace(response, values=response.values * (1 + share * noise))


def test_a_value_that_grows_without_end_is_named():
    """The second disc held fast: however heavy, nothing changes."""
    f = np.linspace(5, 40, 60)
    held = rig(J_2=1e9).frequency_response("n", "T", f)
    fit = tn.identify(rig(), tn.Measurement(noisy(held, -0.002), "n", "T"), {"J_2": 0.5, "k": 500.0})
    assert fit.values["k"] == pytest.approx(600, rel=2e-3)
    assert [text for text in fit.verdicts if "J_2" in text] == [
        "J_2 grows without end: the data do not show that it moves; lock its node"
    ]


NOWHERE = {"J_1": 1e-9, "J_2": 1e7, "k": 1e-6, "d": 1e-9}


@pytest.mark.slow
def test_a_fit_that_leads_nowhere_ends_with_words(record):
    test = tn.Measurement(record, "n", "T_set", model_input="T", band=BAND, settings=SHORT)
    fit = tn.identify(rig(), test, NOWHERE)
    assert fit.lack_of_fit.rejected
    assert fit.verdicts[0].startswith("the model does not fit")


def test_a_fit_of_a_response_that_leads_nowhere_ends_with_words():
    response = rig().frequency_response("n", "T", np.linspace(5, 30, 60))
    fit = tn.identify(rig(), tn.Measurement(noisy(response, 0.01), "n", "T"), NOWHERE)
    assert fit.lack_of_fit.rejected
    assert fit.verdicts[0].startswith("the model does not fit")


@pytest.mark.parametrize(
    ("name", "unit", "bounds"),
    [
        ("k", "N*m/rad", (0, np.inf)),
        ("c", "N*m*s/rad", (0, np.inf)),
        ("J_1", "kg*m^2", (0, np.inf)),
        ("shaft.stiffness", "N*m/rad", (0, np.inf)),
        ("drag.damping", "N*m*s/rad", (0, np.inf)),
    ],
)
def test_natures(name, unit, bounds):
    found = parameter_quantity(rig(), name)
    assert (found.unit, found.bounds) == (unit, bounds)


def test_units_in_table_and_command(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    response = rig(c=0.2).frequency_response("n", "T", np.linspace(2, 30, 40))
    fit = tn.identify(rig(c=0.2), tn.Measurement(response, "n", "T", delay=True), {"k": 500.0, "c": 0.1, "J_2": 0.04})
    assert fit.units == {"k": "N*m/rad", "c": "N*m*s/rad", "J_2": "kg*m^2", "delay[measurement]": "s"}
    tn.io.write_frequency_response(response, "frf.csv")
    rig(c=0.2).to_yaml("rig.yaml")
    (tmp_path / "fit.yaml").write_text(
        "torsionnet: 1\nmodel: rig.yaml\nparameters: {k: 500 N*m/rad}\n"
        "measurements: {test: {response: frf.csv, output: n, input: T}}\n"
    )
    assert "N*m/rad" in run("fit", "fit.yaml").stdout
    (entry,) = json.loads(run("fit", "fit.yaml", "--json").stdout)["parameters"]
    assert (entry["name"], entry["unit"]) == ("k", "N*m/rad")
