"""Cases that are equal but for rounding are no choice, and remarks are about what vibrates."""

import json

import numpy as np
import pytest
from support.written_models import TWO_CYLINDER_PLANT, TWO_CYLINDERS

import torsionnet as tn
from torsionnet.machinery.orders.worst_response import ALL_CASES_EQUAL
from torsionnet.report.document_tree import TableBlock
from torsionnet.report.report import make_report


@pytest.fixture(scope="module")
def plant():
    """Two cylinders on one throw: whichever misfires, the shaft bears the same half a cycle later."""
    return tn.loads(json.dumps(TWO_CYLINDER_PLANT))


def test_equal_cases_are_no_choice(plant):
    run = plant.order_response("torque(rubber)")
    alone = np.array([one.half_range[:, 0] for one in run.case_responses])
    assert alone[0] == pytest.approx(alone[1], rel=1e-9)
    assert (run.chosen == 0).all()
    assert set(run.cases()) == {ALL_CASES_EQUAL}
    check = plant.check_limits()
    assert not any("misfire of" in remark for one in check.verdicts for remark in one.remarks)
    assert {one.case for one in plant.critical_speeds().crossings} == {""}


def test_a_mean_torque_has_no_remark_on_a_misfire():
    """With a flywheel between the cylinders they are unlike, and the criteria on vibration name one."""
    data = json.loads(json.dumps(TWO_CYLINDER_PLANT))
    data["elements"] |= {
        "link": {"type": "spring", "nodes": ["crank", "c2"], "stiffness": "5 MN*m/rad"},
        "disc": {"type": "inertia", "node": "c2", "inertia": 50},
    }
    data["excitations"]["engine"]["cylinders"] = {"1": "crank", "2": "c2"}
    check = tn.loads(json.dumps(data)).check_limits()
    said = {one.criterion: any("misfire of" in remark for remark in one.remarks) for one in check.verdicts}
    assert said == {"T_KN": False, "T_KW": True}


def test_equal_torques_are_those_of_the_first_node_and_phases_have_a_unit():
    engine = {**TWO_CYLINDERS, "cylinders": {1: "crank", 2: "screw"}, "misfire": []}
    blades = {"type": "propeller", "node": "screw", "blades": 4, "torque": "8 kN*m", "rated": "600 rpm",
              "blade_orders": {1: {"share": "8 %", "phase": "30 deg"}}}  # fmt: skip
    rig = tn.Drivetrain(
        "plant",
        [tn.Inertia("throw", node="crank", inertia=100), tn.Inertia("wheel", node="screw", inertia=400),
         tn.Spring("rubber", nodes=("crank", "screw"), stiffness=2e6)],
        speeds={"of": "crank", "range": "500..600 rpm", "step": "20 rpm", "rated": "600 rpm"},
        excitations={"engine": engine, "blades": blades},
    )  # fmt: skip
    (section,) = make_report(rig, sections=["excitations"], date=None).sections
    tables = [block for block in section.blocks if isinstance(block, TableBlock)]
    assert {row[-1] for row in tables[1].groups[0].rows} == {"crank (of 2 alike)"}
    given = {row[0]: row[1] for row in tables[2].groups[0].rows}
    assert given["blade orders"] == "1: share 0.08, phase 30 deg"


def test_axes_of_large_torques_are_in_kilonewton_metres(plant):
    from torsionnet.plot import limit_check, order_response

    panel = limit_check(plant.check_limits(), "rubber").axes[0]
    assert panel.get_ylabel() == "mean torque [kN·m]"
    assert panel.lines[-1].get_ydata().max() == pytest.approx(20)
    run = plant.order_response("torque(rubber)")
    axes = order_response(run).axes[0]
    assert axes.get_ylabel() == "torque(rubber) [kN·m]"
    assert axes.lines[0].get_ydata() == pytest.approx(run.half_range[:, 0] / 1e3)
