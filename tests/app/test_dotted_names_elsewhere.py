"""Dots in all names: motion over time, functional mock-up units, files of results and the page of explore."""

import numpy as np
import pytest
from support.dotted_models import dotted

import torsionnet as tn
from torsionnet.app.explore import open_session
from torsionnet.app.explore.answers import answer
from torsionnet.app.explore.session import ResponseChoice
from torsionnet.app.explore.state import State
from torsionnet.io import (
    read_frequency_response,
    read_recording,
    write_frequency_response,
    write_recording,
)
from torsionnet.io.fmu.archive import suggested_step

FREQUENCIES = np.linspace(1.0, 40.0, 60)


@pytest.fixture(scope="module")
def rigs():
    plain = tn.load("dmf_rig")
    return plain, dotted(plain)


def torques(count):
    return np.random.default_rng(3).normal(size=count) * 10


def test_motion_over_time(rigs):
    plain, rig = rigs
    wanted = plain.simulate(["theta_1", "T_T"], {"T_M": torques(300)}, 1e3)
    found = rig.simulate(["rig.theta_1", "rig.T_T"], {"rig.T_M": torques(300)}, 1e3)
    for name in ("theta_1", "T_T"):
        np.testing.assert_array_equal(found[f"rig.{name}"].values, wanted[name].values)


def test_a_functional_mock_up_unit(rigs):
    pytest.importorskip("fmpy.validation")
    from support.fmu_hosts import Host

    rig = rigs[1]
    host, step = Host(rig).start(), suggested_step(rig)
    assert {"rig.theta_1", "rig.T_T"} <= set(host.outputs)
    inputs = np.random.default_rng(1).normal(size=(200, len(host.inputs)))
    found = host.run(np.arange(200) * step, inputs, told=True)
    record = rig.simulate(host.outputs, dict(zip(host.inputs, inputs.T, strict=True)), 1 / step)
    expected = np.array([record[name].values for name in host.outputs]).T
    scale = np.abs(expected).max(axis=0)
    np.testing.assert_allclose(found / scale, expected / scale, atol=1e-9)


@pytest.mark.parametrize("ending", ["csv", "uff", "npz", "mat"])
def test_files_of_results(rigs, tmp_path, ending):
    if ending == "uff":
        pytest.importorskip("pyuff")
    rig = rigs[1]
    response = rig.frequency_response(["rig.theta_1", "rig.T_T"], "rig.T_M", FREQUENCIES)
    write_frequency_response(response, tmp_path / f"frf.{ending}")
    again = read_frequency_response(tmp_path / f"frf.{ending}")
    assert [str(one) for one in again.outputs] == [str(one) for one in response.outputs]
    np.testing.assert_allclose(again.values, response.values, rtol=1e-6)
    record = rig.simulate(["rig.theta_1", "rig.T_T"], {"rig.T_M": torques(200)}, 1e3)
    write_recording(record, tmp_path / f"record.{ending}")
    back = read_recording(tmp_path / f"record.{ending}")
    np.testing.assert_allclose(back["rig.T_T"].values, record["rig.T_T"].values, rtol=1e-6, atol=1e-9)


def test_the_page_of_explore(rigs, tmp_path):
    plain, rig = rigs
    (tmp_path / "rig.yaml").write_text(rig.to_yaml(), encoding="utf-8")
    session = open_session(tmp_path / "rig.yaml", pairs=[ResponseChoice("rig.theta_1", "rig.T_M")])
    response = answer(session, State({}, {"rig.k_2": "600"}, "rig.theta_1", "rig.T_M", band=(1.0, 40.0)))["response"]
    expected = plain.configured(k_2=600).frequency_response("theta_1", "T_M", np.array(response["frequencies"]))
    np.testing.assert_allclose(response["magnitude"], expected.magnitude[:, 0, 0], rtol=1e-12)


def test_a_parameter_of_a_part_is_fitted(rigs):
    rig = rigs[1]
    truth = rig.configured(**{"rig.k_2": 600})
    response = truth.frequency_response(["rig.theta_1"], ["rig.T_M"], FREQUENCIES)
    found = tn.identify(rig, tn.Measurement(response, "rig.theta_1", "rig.T_M"), {"rig.k_2": 500})
    assert found.values["rig.k_2"] == pytest.approx(600, rel=1e-6)
    assert found.configured(rig).parameters["rig.k_2"] == pytest.approx(600, rel=1e-6)
