"""Values of elements that vary in a study as parameters do."""

import numpy as np
import pytest
from support.faults import faults_of

import torsionnet as tn
from torsionnet.base.errors import ModelError
from torsionnet.study.run.run_chunks import run_study
from torsionnet.study.study import define

FIRST = {"f_1": {"type": "natural_frequency", "mode": 1}}
FIVE = {"type": "normal", "deviation": "5 %"}


@pytest.fixture
def chain():
    return tn.Drivetrain(
        "chain",
        [
            tn.Inertia("disc", node="disc", inertia=0.1),
            tn.Spring("shaft", nodes=("disc", "ground"), stiffness="1 kN*m/rad", damping="c/2"),
            tn.Spring("other", nodes=("disc", "ground"), stiffness="k", damping=0.3),
        ],
        parameters={"k": "200 N*m/rad", "c": 1},
        configurations={"soft": {}, "hard": {"shaft.stiffness": 2000}},
    )


def frequency(inertia, stiffness):
    return np.sqrt(stiffness / inertia) / (2 * np.pi)


def test_values_of_elements_vary(chain):
    study = define(
        chain,
        {
            "shaft.stiffness": {"type": "list", "values": ["0.9 kN*m/rad", 1100]},
            "disc.inertia": {"type": "list", "values": [0.1, 0.2]},
        },
        FIRST,
    )
    expected = [frequency(inertia, 200 + k) for k in (900, 1100) for inertia in (0.1, 0.2)]
    assert run_study(study).values("f_1") == pytest.approx(expected, rel=3e-4)  # which is the damping's share


def test_relative_to_each_configuration(chain):
    study = define(
        chain, {"shaft.stiffness": {"type": "list", "values": ["-10 %", "+0 %"]}}, FIRST, configurations="all"
    )
    result = run_study(study)
    for configuration, stiffness in (("soft", 1000), ("hard", 2000)):
        expected = [frequency(0.1, 200 + share * stiffness) for share in (0.9, 1)]
        assert result.values("f_1", configuration) == pytest.approx(expected, rel=3e-4)


def test_copies_of_a_part_vary_singly():
    shaft = tn.Drivetrain(
        "half shaft",
        [tn.Spring("shaft", nodes=("inner", "hub"), stiffness=9000), tn.Inertia("wheel", node="hub", inertia=0.9)],
        ports=["inner"],
    )
    axle = tn.Drivetrain("axle", [tn.Inertia("cage", node="cage", inertia=0.03)])
    axle = axle.with_part("left", shaft, at={"inner": "cage"}).with_part("right", shaft, at={"inner": "cage"})
    study = define(axle, {"left.shaft.stiffness": {"type": "list", "values": [6100]}}, FIRST)
    stiffness = np.array([[6100, -6100, 0], [-6100, 15100, -9000], [0, -9000, 9000]])
    mass = np.diag([0.9, 0.03, 0.9])
    exact = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real)[1]) / (2 * np.pi)
    assert run_study(study).values("f_1") == pytest.approx([exact], rel=1e-9)


def test_what_was_chosen_stays(chain):
    named = chain.configured("hard", k=300).with_entries_named(["shaft.stiffness", "disc.inertia"])
    assert named.configuration == "hard"
    assert dict(named.parameters) == {"k": 300, "c": 1, "shaft.stiffness": 2000, "disc.inertia": 0.1}
    assert named.configured("soft").parameters["shaft.stiffness"] == 1000
    assert named.modes().natural_frequencies == pytest.approx(
        chain.configured("hard", k=300).modes().natural_frequencies, rel=1e-14
    )
    assert chain.with_entries_named(["k", "nothing", "other.stiffness"]) is chain


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("shaft.damping", "unknown-parameter"),
        ("shaft.stifness", "unknown-name"),
        ("disc.damping", "unknown-name"),
        ("shaft.outer_diameter", "missing-entry"),
        ("shaft.nodes", "unknown-name"),
        ("sahft.stiffness", "unknown-parameter"),
    ],
)
def test_what_cannot_vary(chain, name, kind):
    assert faults_of(lambda: define(chain, {name: FIVE}, FIRST, sampling={"count": 10})) == [(kind, ("vary", name))]


def test_impossible_values_are_refused_as_those_of_parameters(chain):
    with pytest.raises(ModelError, match=r"disc\.inertia"):
        define(chain, {"disc.inertia": {"type": "uniform", "low": -1, "high": 1}}, FIRST, sampling={"count": 10})
