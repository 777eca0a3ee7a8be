"""Functional mock-up units, run by FMPy: against the exact motion of Drivetrain.simulate and against closed forms."""

import itertools

import mpmath
import numpy as np
import pytest
from support.collecting import OnDemand
from support.fmu_hosts import VERSIONS, Host, fmpy, library_model, unpacked
from support.models import geared_line

import torsionnet as tn
from torsionnet.io.fmu.archive import suggested_step

validation = OnDemand("fmpy.validation")

MODELS = [("dmf_rig", ""), ("amt_rig", "V"), ("drill_string", ""), ("planetary_set", ""), ("turbine_generator_ssr", "")]


def torques(rig, count, seed=1):
    return np.random.default_rng(seed).normal(size=(count, len(rig.inputs))) * 100


def simulated(rig, host, inputs, step):
    record = rig.simulate(host.outputs, dict(zip(host.inputs, inputs.T, strict=True)), 1 / step)
    return np.array([record[name].values for name in host.outputs]).T


def agree(found, expected, tolerance=1e-9):
    scale = np.abs(expected).max(axis=0)
    np.testing.assert_allclose(found / scale, expected / scale, atol=tolerance)


@pytest.mark.few(1)
@pytest.mark.parametrize(("name", "configuration"), MODELS)
def test_exact_where_the_host_tells_how_inputs_run(name, configuration):
    rig = library_model(name, configuration)
    host, inputs, step = Host(rig).start(), torques(rig, 300), 7 * suggested_step(rig)
    found = host.run(np.arange(300) * step, inputs, told=True)
    agree(found, simulated(rig, host, inputs, step))


def test_exact_where_an_intermediate_update_tells():
    rig, step = library_model("drill_string"), 0.004
    inputs = torques(rig, 300)

    def ask(host, time):
        host.set(dict(zip(host.inputs, inputs[round(time / step)], strict=True)))

    host = Host(rig, "3.0", ask=ask).start()
    agree(host.run(np.arange(300) * step, inputs), simulated(rig, host, inputs, step))


@pytest.mark.parametrize("version", VERSIONS)
def test_guesses_are_put_right_when_the_next_step_begins(version):
    """A host that tells nothing gets the states of straight lines; its outputs lack what came after the last point."""
    rig, step = library_model("dmf_rig"), 1e-3
    inputs = torques(rig, 400)
    inputs[-2:] = inputs[-3]  # the last guess is right, so nothing is missing at the end
    host = Host(rig, version).start()
    found = host.run(np.arange(400) * step, inputs)
    agree(found[-1:], simulated(rig, host, inputs, step)[-1:])


@pytest.mark.parametrize(("name", "configuration"), [("dmf_rig", ""), ("drill_string", ""), ("amt_rig", "V")])
def test_a_plain_host_is_near_at_the_advised_step(name, configuration):
    """Inputs with the frequency of the highest mode are guessed to 0.8 % of themselves; outputs they feed show that."""
    rig = library_model(name, configuration)
    step = suggested_step(rig)
    highest = max(f for f in rig.modes().natural_frequencies if f < 1000)
    times = np.arange(2000) * step
    inputs = np.tile(100 * np.sin(2 * np.pi * highest * times)[:, None], (1, len(rig.inputs)))
    host = Host(rig).start()
    found, expected = host.run(times, inputs)[10:], simulated(rig, host, inputs, step)[10:]
    agree(found, expected, 0.015)
    held = Host(rig).start(extrapolate_inputs=False).run(times, inputs)[10:]
    assert np.abs((held - expected) / np.abs(expected).max(axis=0)).max() > 0.03


def test_inputs_that_are_held():
    """The exact answer to a staircase: answers to steps, shifted and added up."""
    rig, step = library_model("dmf_rig"), 1e-3
    inputs = torques(rig, 200)
    host = Host(rig).start(extrapolate_inputs=False)
    found = host.run(np.arange(200) * step, inputs)
    answer = simulated(rig, host, np.ones((200, 1)), step)
    rises = np.diff(inputs[:, 0], prepend=0)
    expected = np.array([np.convolve(rises, column)[:200] for column in answer.T]).T
    agree(found[1:, :1], expected[1:, :1])


@pytest.mark.parametrize("version", VERSIONS)
def test_steps_of_any_size(version):
    rig = library_model("turbine_generator_ssr")
    sizes = np.random.default_rng(2).choice([1e-4, 3e-4, 7e-4, 1.1e-3, 2e-3, 0.013], 80)
    times = np.concatenate([[0], np.cumsum(sizes)])
    fine = np.round(times / 1e-4).astype(int)
    line = np.interp(np.arange(fine[-1] + 1), fine, torques(rig, 81)[:, 0])[:, None]
    host = Host(rig, version).start()
    reference = simulated(rig, host, line, 1e-4)[fine]
    if version == "2.0":
        agree(host.run(times, line[fine], told=True), reference)
    else:
        host.run(times, line[fine])
        host.step(times[-1], 0.0)  # a step of no size is allowed


def test_rounding_of_the_time_costs_nothing():
    """Communication points k h after an hour: equal steps differ in the last digits, and are one step all the same."""
    rig, step = library_model("dmf_rig"), 2e-4
    inputs = torques(rig, 3000)
    host = Host(rig).start(time=3600.0)
    found = host.run(3600.0 + np.arange(3000) * step, inputs, told=True)
    agree(found, simulated(rig, host, inputs, step), 1e-6)


@pytest.mark.few(1)
@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize(
    ("name", "configuration"), [("dmf_rig", ""), ("drill_string", ""), ("wind_turbine_5mw", "rated")]
)
def test_model_exchange(version, name, configuration):
    rig = library_model(name, configuration)
    step = 20 * suggested_step(rig)
    times, inputs = np.arange(30) * step, torques(rig, 30)
    host = Host(rig, version, "ModelExchange").start()
    found = host.integrate(times, lambda t: [np.interp(t, times, column) for column in inputs.T])
    agree(found, simulated(rig, host, inputs, step), 1e-6)


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("version", VERSIONS)
def test_fmpy_runs_it(version, kind):
    rig = library_model("dmf_rig")
    result = fmpy.simulate_fmu(
        str(unpacked(rig, version)[0]), fmi_type=kind, stop_time=0.5, output_interval=1e-3, start_values={"T_M": 10.0},
        relative_tolerance=1e-9,
    )  # fmt: skip
    record = rig.simulate("theta_1", {"T_M": np.full(len(result), 10.0)}, 1e3)
    expected = record["theta_1"].values
    np.testing.assert_allclose(
        result["theta_1"], expected, atol=(1e-12 if kind == "CoSimulation" else 1e-6) * expected.max()
    )


@pytest.mark.parametrize("version", VERSIONS)
def test_parameters_are_those_of_the_model(version):
    """Also a ratio, which changes the kinematics, and what follows from others."""
    rig, changes = library_model("amt_rig", "V"), {"tau": 5.42, "k_2": 9e3, "c_O": 300.0, "I_1": 0.3}
    inputs = torques(rig, 200)
    host = Host(rig, version).start(extrapolate_inputs=False, **changes)
    changed = rig.configured(**changes)
    inputs[:] = inputs[0]
    agree(host.run(np.arange(200) * 1e-3, inputs)[1:], simulated(changed, host, inputs, 1e-3)[1:])
    assert host.get(["I_F"])[0] == pytest.approx(changed.parameters["I_F"], rel=1e-15)


def test_initial_angles_and_speeds():
    """Free decay of one mass on a spring: phi = exp(-d t) (a cos w t + (v + d a)/w sin w t)."""
    J, k, c, a, v = 2.0, 800.0, 12.0, 0.3, -4.0
    parts = [tn.Inertia("i", node="n", inertia=J), tn.Spring("s", nodes=("n", "ground"), stiffness=k, damping=c)]
    rig = tn.Drivetrain("one mass", parts, inputs={"T": {"torque": "n"}}, sensors={"phi": {"angle": "n"}})
    times, d = np.arange(200) * 0.01, c / (2 * J)
    w = np.sqrt(k / J - d * d)
    found = Host(rig).start(**{"angle(n)": a, "speed(n)": v}).run(times, np.zeros((200, 1)))[:, 0]
    expected = np.exp(-d * times) * (a * np.cos(w * times) + (v + d * a) / w * np.sin(w * times))
    np.testing.assert_allclose(found, expected, atol=1e-13)


def test_a_free_drivetrain_turns_without_drift():
    """Two masses under a constant torque for half an hour: the common motion, and the twist T J_r/(J_1 k) (1 - cos w t)."""
    J_1, J_2, k, T = 0.3, 0.7, 1e8, 50.0
    parts = [
        tn.Inertia("i", node="a", inertia=J_1), tn.Spring("s", nodes=("a", "b"), stiffness=k),
        tn.Inertia("l", node="b", inertia=J_2),
    ]  # fmt: skip
    sensors = {"phi": {"angle": "a"}, "twist": {"twist": "s"}, "load": {"velocity": "b"}}
    rig = tn.Drivetrain("free", parts, inputs={"T": {"torque": "a"}}, sensors=sensors)
    J, J_r = J_1 + J_2, J_1 * J_2 / (J_1 + J_2)
    times, w = np.arange(2001) * 1.0, np.sqrt(k / J_r)
    phi, twist, speed = Host(rig).start().run(times, np.full((2001, 1), T)).T
    np.testing.assert_allclose(
        phi, T * times**2 / (2 * J) + T * J_2 / J * J_r / (J_1 * k) * (1 - np.cos(w * times)), rtol=1e-12
    )
    np.testing.assert_allclose(speed, T * times / J - T * J_r / (J_1 * k) * J_1 / J * w * np.sin(w * times), atol=1e-5)
    assert np.abs(twist).max() <= 2.0000001 * T * J_r / (J_1 * k)
    assert phi.max() > 9e7


def test_massless_nodes_and_reactions():
    """Static and damped nodes, a torque on each, and the reaction of a clamp that feeds inputs through."""
    parts = [
        tn.Inertia("j", node="a", inertia=2),
        tn.Spring("k1", nodes=("a", "b"), stiffness=300),
        tn.Spring("k2", nodes=("b", "c"), stiffness=500),
        tn.Damper("c", nodes=("c", "d"), damping=20),
        tn.Spring("k3", nodes=("d", "e"), stiffness=400),
        tn.Lock("wall", node="e"),
    ]
    sensors = {"s": {"torque": "k2"}, "acc": {"acceleration": "a"}, "b": {"angle": "b"}, "wall": {"torque": "wall"}}
    model = tn.Drivetrain("maxwell", parts, inputs={"T": {"torque": "a"}, "T_b": {"torque": "b"}}, sensors=sensors)
    host, inputs = Host(model).start(), torques(model, 200)
    found = host.run(np.arange(200) * 0.01, inputs, told=True)
    agree(found, simulated(model, host, inputs, 0.01))
    assert [v.name for v in host.about.modelVariables if v.name.startswith(("angle", "speed"))] == [
        "angle(a)", "speed(a)", "angle(d)",
    ]  # fmt: skip


def test_torque_between_two_nodes_and_values_quoted_at_another_shaft():
    """A pair that feeds a torque meter through, a spring quoted at the far side of a gear, a reading referred there."""
    parts = [
        tn.Inertia("j", node="a", inertia=2),
        tn.RigidCoupling("meter", nodes=("a", "b")),
        tn.Inertia("i", node="b", inertia=1),
        tn.Gear("g", nodes=("b", "c"), ratio="tau"),
        tn.Spring("k", nodes=("c", "d"), stiffness=300, damping=1, referred_to="a"),
        tn.Inertia("load", node="d", inertia=3, referred_to="a"),
    ]
    sensors = {"m": {"torque": "meter"}, "t": {"torque": "k", "referred_to": "a"}, "r": {"angle": ["a", "d"]}}
    inputs = {"T": {"torque": ["a", "d"]}}
    model = tn.Drivetrain("pair", parts, parameters={"tau": 2.5}, inputs=inputs, sensors=sensors)
    host, driven = Host(model).start(), torques(model, 200)
    found = host.run(np.arange(200) * 0.01, driven, told=True)
    agree(found, simulated(model, host, driven, 0.01))


@pytest.mark.parametrize("version", VERSIONS)
def test_instances_and_units_side_by_side(version):
    rigs = [library_model("dmf_rig"), library_model("drill_string"), library_model("dmf_rig")]
    hosts = [Host(rig, version).start(extrapolate_inputs=False) for rig in rigs]
    inputs = [np.repeat(torques(rig, 1, seed), 50, axis=0) for seed, rig in enumerate(rigs)]
    for host, held in zip(hosts, inputs, strict=True):
        host.set(dict(zip(host.inputs, held[0], strict=True)))
    for number, host in itertools.product(range(49), hosts):
        host.step(number * 1e-3, 1e-3)
    for rig, host, held in zip(rigs, hosts, inputs, strict=True):
        np.testing.assert_allclose(host.get(), simulated(rig, host, held, 1e-3)[-1], rtol=1e-9)


@pytest.mark.parametrize("version", VERSIONS)
def test_stored_states(version):
    rig = library_model("drill_string")
    inputs, times = torques(rig, 40), np.arange(40) * 1e-3
    host = Host(rig, version).start()
    host.run(times[:20], inputs[:20])
    name = "State" if version == "3.0" else "state"
    unit = host.unit
    stored = getattr(unit, f"getFMU{name}")()
    packed = getattr(unit, f"serializeFMU{name}")(stored)
    first = host.run(times[19:], inputs[19:])
    getattr(unit, f"setFMU{name}")(stored)
    np.testing.assert_array_equal(host.run(times[19:], inputs[19:]), first)
    other = Host(rig, version).start()
    again = getattr(other.unit, "deserializeFMUState" if version == "3.0" else "deSerializeFMUstate")(packed)
    getattr(other.unit, f"setFMU{name}")(again)
    agree(other.run(times[19:], inputs[19:]), first, 1e-12)


@pytest.mark.parametrize("version", VERSIONS)
def test_directional_derivatives(version):
    model = geared_line()
    host = Host(model, version).start()
    names = [v.name for v in host.about.modelVariables if v.name.startswith(("angle(", "speed("))]
    space = model.to_control()
    states = [space.state_labels.index(name.replace("speed(", "velocity(")) for name in names]
    unknowns = [host.references[name] for name in host.outputs]
    knowns = [host.references[name] for name in [*names, *host.inputs]]
    found = [host.unit.getDirectionalDerivative(unknowns, knowns, list(unit)) for unit in np.eye(len(knowns))]
    expected = np.hstack([space.C[:, states], space.D])
    np.testing.assert_allclose(np.array(found).T, expected, atol=1e-9 * np.abs(space.C).max())


@pytest.mark.few(1)
@pytest.mark.parametrize("version", VERSIONS)
def test_drivetrains_without_inertia(version):
    """Springs alone have no states, springs and dampers one: phi = T/k (1 - exp(-k t/c))."""
    k, c, T = 50.0, 20.0, 3.0
    spring = tn.Spring("s", nodes=("a", "ground"), stiffness=k)
    channels = {"inputs": {"T": {"torque": "a"}}, "sensors": {"phi": {"angle": "a"}, "twist": {"torque": "s"}}}
    still = Host(tn.Drivetrain("still", [spring], **channels), version).start(T=T)
    still.step(0.0, 0.1)
    np.testing.assert_allclose(still.get(), [T / k, T], rtol=1e-15)
    damper = tn.Damper("d", nodes=("a", "ground"), damping=c)
    creeping = Host(tn.Drivetrain("creeping", [spring, damper], **channels), version).start(T=T)
    creeping.step(0.0, 0.4)
    np.testing.assert_allclose(creeping.get(), T * (1 - np.exp(-k * 0.4 / c)) * np.array([1 / k, 1]), rtol=1e-14)
    for rig in (still, creeping):
        assert validation.validate_fmu(str(rig.path)) == []


@pytest.mark.parametrize("version", VERSIONS)
def test_names_that_stand_in_several_tables(version):
    """Inputs, sensors and parameters of a model may share a name; variables of a unit may not."""
    parts = [tn.Inertia("i", node="T", inertia="T")]
    channels = {"inputs": {"T": {"torque": "T"}}, "sensors": {"T": {"velocity": "T"}}}
    model = tn.Drivetrain('namesakes: 5 % <ü>\n"x" */', parts, {"T": 2}, **channels)
    host = Host(model, version).start(T=6.0, **{"parameter(T)": 4.0})
    host.step(0.0, 2.0)
    assert host.get(["output(T)"])[0] == pytest.approx(3.0, rel=1e-15)
    assert validation.validate_fmu(str(host.path)) == []


def test_an_event_tells_a_jump():
    """Torques that jump at an event are answered exactly; without one, a jump is taken for a rise over the last step."""
    rig, step = library_model("dmf_rig"), 1e-3
    levels = np.repeat([5.0, -3.0], 40)[:, None]
    answer = rig.simulate("theta_1", {"T_M": np.ones(80)}, 1 / step)["theta_1"].values
    expected = 5 * answer - 8 * np.concatenate([np.zeros(40), answer[:40]])
    errors = []
    for events in (True, False):
        host = Host(rig, "3.0", events=events).start(T_M=5.0)
        found = [host.get(["theta_1"])[0]]
        for number in range(79):
            if events and number == 40:
                host.unit.enterEventMode()
            host.set({"T_M": levels[number, 0]})
            if events and number in (0, 40):
                host.unit.updateDiscreteStates()
                host.unit.enterStepMode()
            host.step(number * step, step)
            found.append(host.get(["theta_1"])[0])
        errors.append(np.abs(np.array(found) - expected).max() / np.abs(expected).max())
    assert errors[0] < 1e-12
    assert errors[1] > 1e-3


@pytest.mark.parametrize("size", [1e-6, 1e-3, 1.0, 1e3])
def test_exponentials_of_stiff_drivetrains(size):
    """Two masses that hardly feel each other, one 1e5 times faster: each the closed form of a mass on a spring."""
    parts, expected = [], []
    for number, (J, k) in enumerate(((2.0, 50.0), (1e-3, 2.5e8))):
        parts += [
            tn.Inertia(f"i{number}", node=f"n{number}", inertia=J),
            tn.Spring(f"s{number}", nodes=(f"n{number}", "ground"), stiffness=k, damping=0.02 * k / np.sqrt(k / J)),
        ]
        with mpmath.workdps(40):
            w = mpmath.sqrt(mpmath.mpf(k) / J)
            d, v = w / 100, w * mpmath.sqrt(1 - mpmath.mpf(1) / 10**4)
            decay = mpmath.exp(-d * size) * (mpmath.cos(v * size) + d / v * mpmath.sin(v * size))
            expected.append(float((1 - decay) / k))
    parts.append(tn.Spring("weak", nodes=("n0", "n1"), stiffness=1e-9))
    sensors = {f"y{number}": {"angle": f"n{number}"} for number in range(2)}
    inputs = {f"T{number}": {"torque": f"n{number}"} for number in range(2)}
    host = Host(tn.Drivetrain("stiff", parts, inputs=inputs, sensors=sensors)).start(T0=1.0, T1=1.0)
    host.step(0.0, size)
    np.testing.assert_allclose(host.get(), expected, rtol=1e-8)


@pytest.mark.parametrize("version", VERSIONS)
def test_what_follows_from_parameters_is_never_old(version):
    """Derived values after a second change, and a state stored under other parameters."""
    rig = library_model("amt_rig", "V")
    host = Host(rig, version)
    name, share = "I_F", rig.parameters["I_1"] - rig.parameters["I_F"]
    for value in (0.3, 0.4):
        host.set({"I_1": value})
        assert host.get([name])[0] == pytest.approx(value - share, rel=1e-12)
    word = "State" if version == "3.0" else "state"
    changed, plain = Host(rig, version).start(T_M=1.0, tau=5.42), Host(rig, version).start(T_M=1.0)
    packed = getattr(changed.unit, f"serializeFMU{word}")(getattr(changed.unit, f"getFMU{word}")())
    plain.step(0.0, 0.01)
    unpack = plain.unit.deserializeFMUState if version == "3.0" else plain.unit.deSerializeFMUstate
    getattr(plain.unit, f"setFMU{word}")(unpack(packed))
    for unit in (changed, plain):
        unit.step(0.0, 0.01)
    np.testing.assert_array_equal(plain.get(), changed.get())


def test_small_units_are_no_reason_to_refuse():
    """A balance wheel: 1e-18 kg m^2 on 1e-15 N m/rad answers a unit torque with phi = (1 - cos w t)/k."""
    parts = [tn.Inertia("i", node="n", inertia="J"), tn.Spring("s", nodes=("n", "ground"), stiffness="k")]
    rig = tn.Drivetrain("wheel", parts, {"J": 2, "k": 800}, {"T": {"torque": "n"}}, {"phi": {"angle": "n"}})
    host = Host(rig).start(J=1e-18, k=1e-15, T=1.0)
    host.step(0.0, 0.05)
    assert host.get()[0] == pytest.approx((1 - np.cos(np.sqrt(1000) * 0.05)) / 1e-15, rel=1e-12)
