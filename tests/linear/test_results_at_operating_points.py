"""Results at operating points are those of ordinary plants with tangent stiffnesses, and say about which point."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.linear.batch.batch_plan import batch_plan
from torsionnet.linear.batch.batched_modes import batched_modes
from torsionnet.linear.sensitivity import mode_sensitivities

pytestmark = pytest.mark.slow
FREQUENCIES = [0.7, 4.0, 11.0]


def edge(rng, name, nodes, torque):
    """Element of a law of motion that carries a torque, and a spring with its tangent at it, by hand."""
    k, kind = float(rng.uniform(200, 2000)), rng.choice(["stages", "clearance", "cubic"])
    damping = float(rng.uniform(0.1, 2))
    if kind == "stages":
        corner = float(rng.uniform(0.01, 0.1))
        stages = [{"stiffness": k, "to": f"{corner} rad"}, {"stiffness": 3 * k}]
        law = tn.Spring(name, nodes=nodes, stages=stages, damping=damping)
        tangent = k if abs(torque) < k * corner else 3 * k
    elif kind == "clearance":
        law = tn.Clearance(name, nodes=nodes, gap=0.1, stiffness=k, damping=damping)
        tangent = k
    else:
        cubic = 50 * k
        law = tn.Spring(name, nodes=nodes, stiffness=k, cubic=cubic, damping=damping)
        twist = next(one.real for one in np.roots([cubic, 0, k, -torque]) if abs(one.imag) < 1e-9)
        tangent = k + 3 * cubic * twist**2
    return law, tn.Spring(name, nodes=nodes, stiffness=float(tangent), damping=damping)


def pair_of_plants(seed):
    """A chain with laws of motion, free or held, at mean torques, and the same with their tangents."""
    rng = np.random.default_rng(seed)
    nodes = [f"n{place}" for place in range(int(rng.integers(2, 6)))]
    torques, held = rng.normal(0, 60, len(nodes)), bool(rng.random() < 0.5)
    if not held:
        torques[-1] -= torques.sum()
    through = np.cumsum(torques)
    both = [[], []]
    for place, node in enumerate(nodes):
        for some in both:
            some.append(tn.Inertia(f"J{node}", node=node, inertia="J" if place == 0 else 0.3 + place))
        after = [*nodes, "ground"][place + 1]
        if after != "ground" or held:
            for some, one in zip(both, edge(rng, f"e{place}", (node, after), float(through[place])), strict=True):
                some.append(one)
    more = {
        "parameters": {"J": 0.4},
        "excitations": {"gas": {"type": "harmonic", "node": nodes[0], "orders": {2: {"amplitude": "10 N*m"}}}},
        "speeds": {"of": nodes[0], "list": [10, 20, 40]},
        "limits": {"first": {"rule": "curve", "output": "torque(e0)", "value": "5 N*m", "source": "test"}},
    }
    plants = [tn.Drivetrain(f"plant {seed}", some, **more) for some in both]
    return plants[0].at(torque=dict(zip(nodes, torques.tolist(), strict=True))), plants[1], nodes


def check_results(seed):
    loaded, plain, nodes = pair_of_plants(seed)
    pairs = [
        (one.frequency_response([nodes[-1], "torque(e0)"], nodes[0], FREQUENCIES).values, 1e-9)
        for one in (loaded, plain)
    ]
    np.testing.assert_allclose(pairs[0][0], pairs[1][0], rtol=1e-9)
    rotor = {"J": [0.2, 0.4, 0.9]}
    for make in (
        lambda one: one.modes().eigenvalues,
        lambda one: one.frequency_responses("torque(e0)", nodes[0], FREQUENCIES, rotor).values,
        lambda one: batched_modes(batch_plan(one, ["J"]).batch(rotor)).eigenvalues,
        lambda one: one.order_response(["torque(e0)"]).values,
        lambda one: mode_sensitivities(one, ["J"]).pole_slopes,
    ):
        first, second = make(loaded), make(plain)
        np.testing.assert_allclose(first, second, rtol=1e-8, atol=1e-8 * np.abs(second).max())
    first, second = (one.critical_speeds().table() for one in (loaded, plain))
    assert first.rows == second.rows


@pytest.mark.parametrize("seed", [1, 2])
def test_results_are_those_of_the_tangents(seed):
    check_results(seed)


@pytest.mark.parametrize("seed", [4])
def test_a_passage_is_that_of_the_tangents(seed):
    found = [
        one.passage_response(["torque(e0)"], times=[0, 0.03], speeds=[10, 12]).values
        for one in pair_of_plants(seed)[:2]
    ]
    np.testing.assert_allclose(found[0], found[1], rtol=1e-6, atol=1e-6 * np.abs(found[1]).max())


def test_every_result_says_about_which_point_it_is():
    loaded, _, nodes = pair_of_plants(4)
    results = {
        "modes": loaded.modes(),
        "frequency response": loaded.frequency_response(nodes[-1], nodes[0], FREQUENCIES),
        "variants": loaded.frequency_responses(nodes[-1], nodes[0], FREQUENCIES, {"J": [0.2, 0.4]}),
        "orders": loaded.order_response(["torque(e0)"]),
        "critical speeds": loaded.critical_speeds(),
        "limits": loaded.check_limits(),
        "passage": loaded.passage_response(["torque(e0)"], times=[0, 0.01], speeds=[10, 11]),
        "holzer": loaded.holzer_table(mode=1),
        "static": loaded.static_state(),
        "sensitivities": mode_sensitivities(loaded, ["J"]),
        "symbols": loaded.symbolic().transfer_function(nodes[-1], nodes[0]),
    }
    silent = [name for name, one in results.items() if not any("operating point under" in note for note in one.notes)]
    assert silent == []


def test_parameters_that_follow_the_speed_move_the_point():
    """A cubic spring whose stiffness follows the speed, each speed by itself as a plant with the stiffness there."""

    def plant(stiffness, **more):
        elements = [
            tn.Inertia("J1", node="a", inertia=0.5),
            tn.Spring("disc", nodes=("a", "b"), stiffness=stiffness, cubic=3000, damping=0.3),
            tn.Inertia("J2", node="b", inertia=1),
        ]
        excitations = {"e": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": "10 N*m"}}}}
        point = {"torque": {"a": 60, "b": -60}, "speed": {"a": 50}}
        speeds = {"of": "a", "list": [20, 50, 80]}
        return tn.Drivetrain("p", elements, operating_point=point, speeds=speeds, excitations=excitations, **more)

    table = {"0 rad/s": "400 N*m/rad", "100 rad/s": "1200 N*m/rad"}
    found = plant("k", parameters={"k": {"by": "speed", "of": "a", "table": table}}).order_response("twist(disc)")
    alone = [plant(400 + 8 * n).order_response("twist(disc)", speeds=[n]).values[0, 0, 0] for n in (20, 50, 80)]
    np.testing.assert_allclose(found.values[:, 0, 0], alone, rtol=1e-9)
