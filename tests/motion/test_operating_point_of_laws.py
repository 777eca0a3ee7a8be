"""Operating points of laws of motion: balances in dense matrices written here, stages, breakdown slips, notes."""

from math import sqrt

import numpy as np
import pytest
from support import campaigns
from support.random_motion_plants import moving_plant

import torsionnet as tn
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.model.element_base.laws import MotionLaw, Values
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve

FREQUENCIES = np.linspace(0.3, 30, 7)
STAGES = [{"stiffness": "450 N*m/rad", "to": "0.1 rad"}, {"stiffness": "1800 N*m/rad", "to": "0.3 rad"}]


def random_spring(rng, name, nodes):
    """An element between two nodes: a linear spring, or one of a law of motion over the twist."""
    kind = rng.choice(["linear", "stages", "preload", "table", "clearance", "cubic"])
    k = float(rng.uniform(50, 2000))
    if kind == "linear":
        return tn.Spring(name, nodes=nodes, stiffness=k)
    if kind in ("stages", "preload"):
        ends = np.cumsum(rng.uniform(0.01, 0.1, 2)).tolist()
        preload = {"preload": float(rng.uniform(1, 20))} if kind == "preload" else {}
        stages = [
            {"stiffness": k, "to": f"{ends[0]} rad", **(preload if rng.random() < 0.5 else {})},
            {"stiffness": k * float(rng.uniform(0.3, 4)), "to": f"{ends[1]} rad", **preload},
            {"stiffness": k * float(rng.uniform(0.3, 4))},
        ]
        return tn.Spring(name, nodes=nodes, stages=stages)
    if kind == "table":
        rows = [
            [-9.0, -9.0 * k],
            [-0.02, float(-rng.uniform(0, 30))],
            [0.05, float(rng.uniform(0, 30))],
            [9.0, 9.0 * k],
        ]
        return tn.Spring(name, nodes=nodes, torque_over_twist=rows)
    if kind == "clearance":
        return tn.Clearance(name, nodes=nodes, gap=float(rng.uniform(0.01, 0.2)), stiffness=k)
    return tn.Spring(name, nodes=nodes, stiffness=k, cubic=k * float(rng.uniform(1, 100)))


def random_plant(seed):
    """A tree of springs with a few loops, held or free, and mean torques in balance."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 9))
    names = [f"n{place}" for place in range(count)]
    elements = [tn.Inertia(f"J{name}", node=name, inertia=float(rng.uniform(0.1, 2))) for name in names]
    edges = [(names[int(rng.integers(0, place))], names[place]) for place in range(1, count)]
    for _ in range(int(rng.integers(0, 4))):
        first, second = rng.choice(count, 2, replace=False).tolist()
        edges.append((names[first], names[second]))
    held = bool(rng.random() < 0.5)
    if held:
        edges.append((names[0], "ground"))
    elements += [random_spring(rng, f"e{number}", nodes) for number, nodes in enumerate(edges)]
    torque = dict(zip(names, rng.normal(0, 60, count).tolist(), strict=True))
    if not held:
        torque[names[-1]] -= sum(torque.values())
    return tn.Drivetrain(f"plant {seed}", elements), torque


def dense(plant, torque):
    """Rows of laws over nodes, their torques over twist, stiffness of linear springs, and torques on nodes."""
    nodes = list(plant.nodes)
    value = Values(plant.exact_values)
    laws, linear = [], np.zeros((len(nodes), len(nodes)))
    for element in plant.definition.switched_on:
        for part in element.whole_parts(value):
            row = np.array([float(part.row.get(node, 0)) for node in nodes])
            if isinstance(part, MotionLaw):
                laws.append((element.name, row, part))
            else:
                linear += float(part.stiffness) * np.outer(row, row)
    return nodes, laws, linear, np.array([torque.get(node, 0.0) for node in nodes])


@pytest.mark.parametrize("seed", range(0, 300, 15))
def test_random_plants_are_in_balance(seed):
    check_balance(*random_plant(seed))


@pytest.mark.slow
@pytest.mark.parametrize("first", campaigns.by_day(range(0, 300, 30), 0, 150))
def test_more_random_plants_are_in_balance(first):
    for seed in range(first, first + 30):
        check_balance(*random_plant(seed))


def check_balance(plant, torque):
    """Twists fit node angles at which the torques of all laws, within steps any torque of these, leave nothing over."""
    (point,) = plant.operating_points(torque=torque)
    nodes, laws, linear, acting = dense(plant, torque)
    rows = np.array([row for _, row, _ in laws]).reshape(len(laws), len(nodes))
    twists = np.array([one.twist for states in point.states.values() for one in states])
    torques = np.array([one for some in point.torques.values() for one in some])
    for (_, _, law), state, own in zip(
        laws, (one for states in point.states.values() for one in states), torques.tolist(), strict=True
    ):
        piece = law.curve.pieces[state.piece] if isinstance(law.curve, PieceCurve) else None
        if isinstance(piece, Hold):
            assert float(piece.low) - 1e-9 <= own <= float(piece.high) + 1e-9
            assert state.twist == pytest.approx(float(piece.at), abs=1e-12)
        else:
            assert own == pytest.approx(float(law.torque(state.twist, 0)), rel=1e-9, abs=1e-8)
    matrix = np.concatenate([rows, linear])
    right = np.concatenate([twists, acting - rows.T @ torques])
    scale = np.concatenate([np.full(len(rows), 1e3), np.ones(len(nodes))])
    angles = np.linalg.lstsq(matrix * scale[:, None], right * scale, rcond=None)[0]
    np.testing.assert_allclose(linear @ angles + rows.T @ torques, acting, atol=1e-7 * np.abs(acting).max())
    np.testing.assert_allclose(rows @ angles, twists, atol=1e-9)


BEARING = tn.Damper("bearing", nodes=("b", "ground"), damping=0.2)


def staged(*, bearing=True, **more):
    """Two rotors with a spring in stages between them."""
    rotors = [tn.Inertia("J1", node="a", inertia=0.5), tn.Inertia("J2", node="b", inertia=0.8)]
    held = [BEARING] if bearing else []
    return tn.Drivetrain("staged", [*rotors, tn.Spring("disc", nodes=("a", "b"), stages=STAGES), *held], **more)


def linear(stiffness):
    """The same two rotors with a linear spring."""
    rotors = [tn.Inertia("J1", node="a", inertia=0.5), tn.Inertia("J2", node="b", inertia=0.8)]
    return tn.Drivetrain("linear", [*rotors, tn.Spring("disc", nodes=("a", "b"), stiffness=stiffness), BEARING])


def response(plant, **more):
    return plant.frequency_response(["b", "torque(disc)"], "a", FREQUENCIES, **more).values


@pytest.mark.parametrize(("torque", "stiffness"), [(20, 450), (44.9, 450), (45, 1800), (90, 1800)])
def test_a_stage_is_that_of_the_mean_torque(torque, stiffness):
    """At the corner, 45 N m, the piece above it counts; the response is that of a linear spring to the last bit."""
    plant = staged().at(torque={"a": torque, "b": -torque})
    assert (response(plant) == response(linear(stiffness))).all()
    assert (response(plant, method="dense") == response(linear(stiffness), method="dense")).all()


def test_operating_point_of_the_file_and_of_a_configuration():
    """Without a call the operating point of the model counts, in each configuration its own."""
    point = {"torque": {"a": "20 N*m", "b": "-20 N*m"}}
    other = {"operating_point": {"torque": {"a": "90 N*m", "b": "-90 N*m"}}}
    plant = staged(operating_point=point, configurations={"low": {}, "high": other})
    assert (response(plant) == response(linear(450))).all()
    assert (response(plant.configured("high")) == response(linear(1800))).all()
    asked = plant.at(torque={"a": 90, "b": -90})
    assert (response(asked.configured("low")) == response(linear(1800))).all()  # a call holds against configurations
    assert plant.to_yaml() == staged(operating_point=point, configurations={"low": {}, "high": other}).to_yaml()


def test_every_result_says_about_which_point_it_is():
    plain, loaded = staged(), staged().at(torque={"a": 90, "b": -90})
    for plant, text in ((plain, "without load: disc linear at rest"), (loaded, "disc works at 0.125 rad, 90 N*m")):
        notes = [plant.modes().notes, plant.frequency_response("a", "b", [1.0]).notes]
        assert all(any(text in note for note in some) for some in notes)


def test_flywheel_stages_are_those_of_its_own_torque_entry():
    """An entry torque: of a dual mass flywheel, and the same torque as operating point, give one response, bit by bit."""
    entries = {
        "nodes": ("a", "b"),
        "primary_inertia": 0.09,
        "secondary_inertia": 0.05,
        "stages": STAGES,
        "damping": 0.3,
    }

    def rig(**more):
        return tn.Drivetrain(
            "rig", [tn.DualMassFlywheel("disc", **entries, **more), tn.Inertia("J", node="b", inertia=1)]
        )

    for torque in (20, 90):
        own, asked = rig(torque=torque), rig().at(torque={"a": torque, "b": -torque})
        assert (response(own) == response(asked)).all()


def motor(**more):
    """An induction motor with its load on the same shaft."""
    machine = tn.InductionMachine(
        "motor", node="a", synchronous_speed=100, breakdown_torque=400, breakdown_slip=0.1, inertia=0.4, **more
    )
    return tn.Drivetrain(
        "drive", [machine, tn.Inertia("fan", node="b", inertia=2), tn.Spring("s", nodes=("a", "b"), stiffness=1e4)]
    )


def test_slips_of_six_tenths_of_the_breakdown_torque():
    """Kloss: s/s_k + s_k/s = 2/0.6 has the roots s_k/3 and 3 s_k; the motor holds its speed at the smaller one only."""
    points = motor().operating_points(torque={"b": -240})
    slips = [(1 - one.states["motor"][0].rate / 100, one.is_stable) for one in points]
    assert slips == [(pytest.approx(0.3, rel=1e-12), False), (pytest.approx(0.1 / 3, rel=1e-12), True)]
    assert points[0].speeds["b"] == pytest.approx(70, rel=1e-12)
    asked = motor().at(torque={"b": -240})
    (law,) = [one for one in asked.assembly.laws if one.damping]
    slip = 0.1 / 3
    slope = 2 * 400 * 0.1 * (0.1**2 - slip**2) / (100 * (slip**2 + 0.1**2) ** 2)
    assert float(law.damping) == pytest.approx(slope, rel=1e-12)
    assert any("2 operating points are in balance, 1 of them stable" in note for note in asked.modes().notes)


def test_a_torque_beyond_breakdown_is_refused():
    with pytest.raises(ModelError, match=r"elements\.motor: .*no-solution"):
        motor().at(torque={"b": -401}).modes()


def test_a_torque_beyond_the_last_stage_is_refused():
    with pytest.raises(ModelError, match=r"elements\.disc: .*500.*405.*no-solution"):
        staged().at(torque={"a": 500, "b": -500}).modes()
    faults = staged().at(torque={"a": 500, "b": -500}).check()
    assert any("it ends at 405" in fault.message for fault in faults)


def test_torques_out_of_balance_are_refused_with_a_proposal():
    with pytest.raises(ModelError, match=r"operating_point\.torque: .*20.*\-20.*unbalanced-torques"):
        staged(bearing=False).at(torque={"a": 20}).modes()
    (point,) = staged().operating_points(torque={"a": 20})
    assert point.speeds["b"] == pytest.approx(20 / 0.2, rel=1e-12)  # what the bearing takes


def test_a_node_that_does_not_exist_is_refused():
    with pytest.raises(ModelError, match=r"operating_point\.torque\.crank: .*unknown-node"):
        staged().at(torque={"crank": 20})
    with pytest.raises(UsageError, match="give torques or speeds"):
        staged().at()
    with pytest.raises(UsageError, match="missing-entry"):
        staged().at(speed="1500 rpm")


def gap(friction=None):
    elements = [tn.Inertia("J1", node="a", inertia=0.5), tn.Inertia("J2", node="b", inertia=0.8)]
    elements += [tn.Clearance("claw", nodes=("a", "b"), gap=0.2, stiffness=100)]
    return tn.Drivetrain("gap", [*elements, *([] if friction is None else [friction])])


def test_a_gap_is_a_free_motion_and_contact_a_spring():
    assert gap().modes().undamped_natural_frequencies.tolist() == [0.0, 0.0] or not any(
        gap().modes().undamped_natural_frequencies
    )
    reduced = 0.5 * 0.8 / 1.3
    touching = gap().at(torque={"a": 7, "b": -7})
    assert touching.modes().undamped_natural_frequencies.max() * 2 * np.pi == pytest.approx(
        sqrt(100 / reduced), rel=1e-9
    )


def test_friction_is_rigid_while_it_sticks_and_free_while_it_slips():
    rub = tn.Friction("rub", nodes=("b", "ground"), torque=20, stick=30)
    stuck = gap(rub).at(torque={"a": 25})
    assert stuck.modes().undamped_natural_frequencies.max() * 2 * np.pi == pytest.approx(sqrt(100 / 0.5), rel=1e-9)
    sliding = gap(rub).at(torque={"a": 20}, speed={"a": 50})
    assert any("rub slips at 50 rad/s, 20 N*m" in note for note in sliding.modes().notes)
    assert sliding.modes().undamped_natural_frequencies.max() * 2 * np.pi == pytest.approx(
        sqrt(100 / (0.5 * 0.8 / 1.3)), rel=1e-9
    )
    with pytest.raises(ModelError, match=r"elements\.rub: .*35.*no-solution"):
        gap(rub).at(torque={"a": 35}).modes()


def fan(**more):
    """A fan behind a spring in stages and a gap, with a load over the square of the speed."""
    elements = [
        tn.Inertia("J1", node="e", inertia=2),
        tn.Inertia("J2", node="m", inertia=1),
        tn.Inertia("J3", node="p", inertia=1),
        tn.Spring("disc", nodes=("e", "m"), stages=[{"stiffness": 1e4, "to": "300 N*m"}, {"stiffness": 1e5}]),
        tn.Clearance("claw", nodes=("m", "p"), gap=0.02, stiffness=5e4, damping=3),
    ]
    load = {"absorbed_at": "p", "power": "100 kW", "torque_exponent": 2, "driven_by": {"e": 1}}
    blades = {"type": "harmonic", "node": "p", "orders": {2: {"amplitude": "10 N*m"}}}
    speeds = {"of": "e", "list": [50, 75, 100], "rated": 100}
    return tn.Drivetrain("fan", elements, load=load, speeds=speeds, excitations={"blades": blades}, **more)


def test_mean_twists_over_speed_follow_the_stages():
    """By hand: T = 1000 (n/100)^2 N m; the disc has its corner at 300 N m, 0.03 rad; the gap is 0.01 rad to each side."""
    found = fan().mean_response(["torque(disc)", "twist(disc)", "twist(claw)"])
    torque = 1000 * np.array([0.25, 0.5625, 1.0])
    disc = np.where(torque < 300, torque / 1e4, 0.03 + (torque - 300) / 1e5)
    np.testing.assert_allclose(found.values, np.array([torque, disc, 0.01 + torque / 5e4]).T, rtol=1e-12)


def test_orders_at_every_speed_are_those_of_its_load():
    """Each speed has the response of a linear plant with the stiffness of the stage there."""
    found = fan().order_response("torque(disc)")
    for speed, value in zip(found.speeds.tolist(), found.values[:, 0, 0].tolist(), strict=True):
        torque = 1000 * (speed / 100) ** 2
        k, w = 1e4 if torque < 300 else 1e5, 2 * speed
        D = np.diag([-2 * w**2, -(w**2), -(w**2)]).astype(complex)
        D[:2, :2] += k * np.array([[1, -1], [-1, 1]])
        D[1:, 1:] += (5e4 + 3j * w) * np.array([[1, -1], [-1, 1]])
        angles = np.linalg.solve(D, [0, 0, 10])
        assert abs(value) == pytest.approx(abs(k * (angles[0] - angles[1])), rel=1e-9)
    assert any("at every speed" in note for note in found.notes)


def test_symbols_at_an_operating_point_are_its_numbers():
    plant = staged().at(torque={"a": 90, "b": -90})
    found = plant.symbolic().transfer_function("b", "a").evaluate(FREQUENCIES).values[:, 0, 0]
    np.testing.assert_allclose(found, plant.frequency_response("b", "a", FREQUENCIES).values[:, 0, 0], rtol=1e-12)


def test_variants_have_their_own_operating_points():
    """A parameter that moves the torque moves the stage: each variant is that of a model by itself."""
    point = {"torque": {"a": "T", "b": "-T"}}
    plant = staged(parameters={"T": {"value": "20 N*m"}}, operating_point=point)
    found = plant.frequency_responses("b", "a", FREQUENCIES, {"T": [20.0, 90.0]})
    for torque, values in zip((20.0, 90.0), found.values, strict=True):
        alone = plant.configured(T=torque).frequency_response("b", "a", FREQUENCIES).values
        np.testing.assert_array_equal(values, alone)


def test_what_hangs_free_in_a_gap_stays_in_it():
    """The stand turns by five gaps, and what the gap carries has no torque: it goes along and stays within the gap."""
    elements = [
        tn.Spring("foot", nodes=("a", "ground"), stiffness=100),
        tn.Inertia("J_a", node="a", inertia=1),
        tn.Clearance("gap", nodes=("a", "b"), gap=0.1, stiffness=1e4),
        tn.Inertia("J_b", node="b", inertia=1),
        tn.Spring("shaft", nodes=("b", "c"), stiffness=300),
        tn.Inertia("J_c", node="c", inertia=1),
    ]
    (point,) = tn.Drivetrain("hanging", elements).operating_points(torque={"a": 50})
    assert point.torques["gap"] == (0.0,)
    assert abs(point.states["gap"][0].twist) <= 0.05


@pytest.mark.parametrize("seed", [10, 15, 61, 72])
def test_trees_with_free_parts_are_in_balance(seed):
    plant = moving_plant(seed, 20)
    elements = [one for one in plant.drivetrain.elements.values() if not isinstance(one, tn.Friction)]
    torque = {node: ends[0] for node, ends in plant.torques.items()}
    check_balance(tn.Drivetrain("free parts", elements), torque)
