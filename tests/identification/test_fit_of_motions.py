"""Fits of laws of motion to records over time; the records are closed forms, or integrated by scipy."""

import numpy as np
import pytest
import scipy
from support.campaigns import examples
from support.loop_records import backlash_record, loop_record, stage_record, staged

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.identification.fit_problem import make_problem
from torsionnet.identification.lack_of_fit import misfits
from torsionnet.identification.plan.fit_entries import read_unknowns
from torsionnet.signals import Recording, Signal

DECAY = {"k": 140.0, "c": 0.06, "M": 0.35}
INERTIA, RATE = 0.05, 500.0
NOISE = np.radians(0.01)


def decaying(time, k, c, M, begin=0.12):
    """Twist of an inertia on a spring with damping and friction from rest at ``begin``, in closed form by half swings.

    About the twist M/k that friction shifts it to, each half swing is a damped sine from rest to rest.
    """
    decay = c / (2 * INERTIA)
    omega = np.sqrt(k / INERTIA - decay**2)
    half, twist = np.pi / omega, np.empty(len(time))
    begins = 0.0
    while True:
        shift = np.sign(begin) * M / k
        inside = time >= begins - 1e-12
        if abs(begin) <= M / k:
            twist[inside] = begin
            return twist
        past = time[inside] - begins
        swing = np.exp(-decay * past) * (np.cos(omega * past) + decay / omega * np.sin(omega * past))
        twist[inside] = shift + (begin - shift) * swing
        begin, begins = shift - (begin - shift) * np.exp(-decay * half), begins + half


def decay_model(spring="k", **values):
    parts = [
        tn.Inertia("mass", node="a", inertia=INERTIA),
        tn.Spring("disc", nodes=("a", "ground"), stiffness="k", damping="c", **({} if spring == "k" else spring)),
        tn.Friction("ring", nodes=("a", "ground"), torque="M"),
    ]
    return tn.Drivetrain("bench", parts, values, inputs={"T": {"torque": "a"}}, sensors={"gamma": {"angle": "a"}})


def fitted(model, record, names, into="", **more):
    return tn.identify(model, tn.Measurement(record, "gamma", into, equations=True, name="test", **more), names)


def of_twist(twist, rate=RATE):
    return Recording((Signal("gamma", "angle", twist),), rate)


@pytest.mark.parametrize("noise", [NOISE, 0.0], ids=["noise", "exact"])
def test_a_decay_tells_spring_damping_and_friction(noise):
    time = np.arange(0, 2, 1 / RATE)
    twist = decaying(time, **DECAY) + np.random.default_rng(1).normal(0, noise, len(time))
    assert twist[-1] == pytest.approx(twist[-100], abs=8 * NOISE)  # it has come to rest
    fit = fitted(decay_model(k=110, c=0.1, M=0.5), of_twist(twist), list(DECAY))
    within = {"k": 5e-4, "c": 0.02, "M": 0.01} if noise else {"k": 3e-5, "c": 5e-4, "M": 3e-4}
    for name, value in DECAY.items():
        assert abs(fit.values[name] - value) < 4 * fit.standard_errors[name], name
        assert fit.standard_errors[name] < within[name] * value, name
    assert not fit.lack_of_fit.rejected


def test_weights_are_those_of_the_result_not_of_the_start():
    """A third of the friction at the start makes its turns a ninth as uncertain: five half swings take few equations."""
    time, true = np.arange(0, 0.5, 1 / RATE), DECAY | {"M": 1.5}
    record = of_twist(decaying(time, **true) + np.random.default_rng(1).normal(0, NOISE, len(time)))
    far, near = (fitted(decay_model(**start), record, ["k", "M"]) for start in (true | {"M": 0.5}, true))
    for name, error in near.standard_errors.items():
        assert far.standard_errors[name] == pytest.approx(error, rel=0.02), name


def test_a_decay_without_a_torque_does_not_tell_its_scale():
    """Stiffness, damping, friction and inertia that are all smaller by one factor move alike."""
    time = np.arange(0, 1, 1 / RATE)
    twist = decaying(time, **DECAY) + np.random.default_rng(1).normal(0, NOISE, len(time))
    fit = fitted(decay_model(k=110, c=0.1, M=0.5), of_twist(twist), [*DECAY, "mass.inertia"])
    assert fit.values["k"] / fit.values["mass.inertia"] == pytest.approx(DECAY["k"] / INERTIA, rel=1e-3)
    assert fit.standard_errors["k"] == fit.standard_errors["mass.inertia"] == np.inf


STAGES = {"k1": 460.0, "k2": 1500.0, "g1": 0.12, "M": 6.0}
SCATTER = {"k1": 0.036e-2, "k2": 0.02e-2, "g1": 0.023e-2, "M": 0.13e-2}
"""Relative scatter over many records, of another implementation by branches."""


def stages(**values):
    parts = [
        tn.Spring("disc", nodes=("a", "ground"), stages=[{"stiffness": "k1", "to_twist": "g1"}, {"stiffness": "k2"}]),
        tn.Friction("ring", nodes=("a", "ground"), torque="M"),
    ]
    return tn.Drivetrain("bench", parts, values, inputs={"T": {"torque": "a"}}, sensors={"gamma": {"angle": "a"}})


def test_a_loop_tells_stages_and_friction():
    fit = fitted(stages(k1=430, k2=1600, g1=0.11, M=4.0), stage_record(3), list(STAGES), "T")
    for name, value in STAGES.items():
        assert abs(fit.values[name] - value) < 4 * fit.standard_errors[name], name
        assert 0.3 * SCATTER[name] < fit.standard_errors[name] / value < 2 * SCATTER[name], name


@pytest.mark.parametrize("walk", [0.0, 0.02])
def test_a_meter_that_wanders_has_no_intervals_by_residuals(walk):
    """They would hold stiffness and friction in .32 and .42 of all draws; loops have intervals over cycles."""
    test = tn.Measurement(stage_record(1, walk=walk), "gamma", "T", equations=True, name="test")
    problem = make_problem(stages(**STAGES), [test], read_unknowns(list(STAGES)), "complex")
    assert misfits(problem, problem.start)[0].rejected == (walk > 0)


def sines(*frequencies, inertia=0.045, amplitudes=(0.25, 0.25), rate=400.0):
    """Record of the stages with friction at sines one behind the other, seen by a meter behind an inertia."""
    runs = []
    for hertz, amplitude in zip(frequencies, amplitudes, strict=False):
        phase = 2 * np.pi * hertz * np.arange(round(4 * rate / hertz)) / rate
        twist = -amplitude * np.cos(phase)
        bent = amplitude * (2 * np.pi * hertz) ** 2 * np.cos(phase)
        runs.append((twist, staged(twist) + 6.0 * np.sign(np.sin(phase)) + inertia * bent))
    twist, torque = np.concatenate(runs, axis=1)
    noise = np.random.default_rng(1).normal(size=(2, len(twist)))
    return loop_record(torque + 0.2 * noise[0], twist + 2e-5 * noise[1], rate)


def held(record):
    """Record that stays for a second at its last values, read without noise."""
    torque, twist = (np.r_[record[name].values, np.full(400, record[name].values[-1])] for name in ("T", "gamma"))
    return loop_record(torque, twist, record.sampling_rate)


@pytest.mark.parametrize(
    ("record", "told"),
    [
        (sines(1.5), "1.5 Hz"),
        (sines(1.5, 1.5, amplitudes=(0.25, 0.1)), "1.5 Hz"),
        (sines(1.5, 4.0), ""),
        (held(sines(1.5)), "1.5 Hz"),
        (stage_record(3), ""),  # a triangle has its inertia at the corners alone
    ],
    ids=["one", "two amplitudes", "two", "then at rest", "triangle"],
)
def test_one_frequency_does_not_tell_inertia_from_stiffness(record, told):
    test = tn.Measurement(record, "gamma", "T", equations=True, name="test")
    block = make_problem(stages(**STAGES), [test], read_unknowns(["k1"]), "complex").blocks[0]
    assert ("k is not told from k - J w^2" in block.remark, told in block.remark) == (bool(told), True)


@pytest.mark.slow
def test_inertia_of_the_moving_side_is_named_and_found_by_two_frequencies():
    """It lowers all stiffnesses by 4 and 28 N m/rad at 1.5 and 4 Hz."""
    model, record = stages(k1=430, k2=1600, g1=0.11, M=4.0), sines(1.5, 4.0)
    wrong = fitted(model, record, list(STAGES), "T").lack_of_fit
    assert wrong.rejected
    assert [one.kind for one in wrong.explanations] == ["moving_inertia"]
    fit = fitted(model, record, list(STAGES), "T", moving_inertia=True)
    assert fit.values["moving_inertia[test]"] == pytest.approx(0.045, rel=0.01)
    for name, value in STAGES.items():
        assert fit.values[name] == pytest.approx(value, rel=2e-3), name


def test_contacts_over_free_play_are_not_flattened_by_noise_of_the_twist():
    """Torque over twist sample by sample makes k .56 % too small; scatter over draws is .3, .075 and .27 %."""
    true = {"k": 20000.0, "gap": np.radians(0.5), "M": 1.0}
    parts = [
        tn.Clearance("mesh", nodes=("a", "ground"), stiffness="k", gap="gap"),
        tn.Friction("ring", nodes=("a", "ground"), torque="M"),
    ]
    start = {"k": 17000.0, "gap": 0.0092, "M": 2.0}
    model = tn.Drivetrain("b", parts, start, inputs={"T": {"torque": "a"}}, sensors={"gamma": {"angle": "a"}})
    fit = fitted(model, backlash_record(1), list(true), "T")
    for name, within in {"k": 0.01, "gap": 0.003, "M": 0.02}.items():
        assert fit.values[name] == pytest.approx(true[name], rel=within), name


def test_backlash_that_rattles_is_told_by_the_contacts():
    """Angles to .0015 deg and 0.25 N m of a gap of .46 deg, of which a record predicted as a whole runs away."""
    true, time = {"k": 8000.0, "gap": np.radians(0.46), "c": 2.0}, np.arange(0, 1, 1 / 4000)
    swings = [(0.0045, 7.3, 0.2), (0.0022, 19.1, 1.0), (0.0012, 31.7, 2.0)]
    twist, rate = (
        sum(a * (2 * np.pi * f) ** n * np.sin(2 * np.pi * f * time + p + n * np.pi / 2) for a, f, p in swings)
        for n in (0, 1)
    )
    pressed = twist - np.clip(twist, -true["gap"] / 2, true["gap"] / 2)
    torque = true["k"] * pressed + true["c"] * rate * (pressed != 0)
    torque[torque * pressed < 0] = 0.0  # contacts push and never pull
    noise = np.random.default_rng(1).normal(size=(2, len(time)))
    signals = Signal("T", "torque", torque + 0.25 * noise[0]), Signal("gamma", "angle", twist + 3.7e-5 * noise[1])
    parts = [
        tn.Inertia("wheel", node="a", inertia=0.02),
        tn.Clearance("mesh", nodes=("a", "ground"), stiffness="k", gap="gap", damping="c"),
    ]
    model = tn.Drivetrain(
        "b", parts, {"k": 7000, "gap": 0.0075, "c": 4.0}, inputs={"T_M": {"torque": "a"}},
        sensors={"T": {"torque": "mesh"}, "gamma": {"twist": "mesh"}},
    )  # fmt: skip
    fit = fitted(model, Recording(signals, 4000), list(true), "T")
    for name, value in true.items():
        assert abs(fit.values[name] - value) < 4 * fit.standard_errors[name], name
        assert fit.standard_errors[name] < {"k": 4e-3, "gap": 1.5e-3, "c": 0.04}[name] * value, name


def test_a_break_that_no_motion_reaches_is_not_seen():
    time = np.arange(0, 2, 1 / RATE)
    twist = decaying(time, **DECAY) + np.random.default_rng(1).normal(0, NOISE, len(time))
    model = stages(k1=140, k2=500, g1=0.2, M=0.4)
    elements = [*model.elements.values(), tn.Inertia("mass", node="a", inertia=INERTIA), tn.Damper("oil", nodes=("a", "ground"), damping=0.06)]  # fmt: skip
    model = tn.Drivetrain("b", elements, {"k1": 140, "k2": 500, "g1": 0.2, "M": 0.4}, inputs=model.inputs, sensors={"gamma": {"angle": "a"}})  # fmt: skip
    fit = fitted(model, of_twist(twist), ["k1", "g1", "k2", "M"])
    for name in ("g1", "k2"):
        assert any(one.startswith(f"{name} is not seen: no swing reaches it") for one in fit.verdicts)
    assert fit.values["M"] == pytest.approx(DECAY["M"], rel=0.02)


@pytest.mark.parametrize(
    ("said", "kind"), [({"band": (1.0, 5.0)}, "needless-entry"), ({"settling": 10.0}, "too-short")]
)
def test_what_equations_cannot_have_is_refused(said, kind):
    twist = decaying(np.arange(0, 1, 1 / RATE), **DECAY)
    with pytest.raises(UsageError) as caught:
        fitted(decay_model(k=140, c=0.06, M=0.35), of_twist(twist), ["k"], **said)
    assert caught.value.kind == kind


@pytest.mark.parametrize(
    ("twist", "kind"),
    [(np.full(500, 0.1), "too-short"), (np.arange(3.0), "too-short"), (np.full(500, np.nan), "not-finite")],
)
def test_records_without_motion_or_values_are_refused(twist, kind):
    with pytest.raises(UsageError) as caught:
        fitted(decay_model(k=140, c=0.06, M=0.35), of_twist(twist), ["k"])
    assert caught.value.kind == kind


def test_a_second_mass_beside_the_element_is_refused():
    parts = [*decay_model(k=140, c=0.06, M=0.35).elements.values(), tn.Inertia("wheel", node="b", inertia=0.1)]
    parts.append(tn.Spring("shaft", nodes=("a", "b"), stiffness=300))
    model = tn.Drivetrain("b", parts, {"k": 140, "c": 0.06, "M": 0.35}, inputs={"T": {"torque": "a"}}, sensors={"gamma": {"angle": "a"}})  # fmt: skip
    with pytest.raises(UsageError, match="more than one mass") as caught:
        fitted(model, of_twist(decaying(np.arange(0, 1, 1 / RATE), **DECAY)), ["k"])
    assert caught.value.kind == "unfit-channel"


def test_the_torque_of_an_element_beside_friction_is_refused():
    model = decay_model(k=140, c=0.06, M=0.35)
    model = tn.Drivetrain(
        "b", model.elements.values(), {"k": 140, "c": 0.06, "M": 0.35}, inputs={"T_M": {"torque": "a"}},
        sensors={"T": {"torque": "disc"}, "gamma": {"angle": "a"}},
    )  # fmt: skip
    with pytest.raises(UsageError, match="beside ring, which it tells nothing of") as caught:
        fitted(model, stage_record(3), ["M"], "T")
    assert caught.value.kind == "no-effect"


def of_decay(**true):
    time = np.arange(0, 2, 1 / RATE)
    clean = decaying(time, **true)

    def fit(seed):
        twist = clean + np.random.default_rng(seed).normal(0, NOISE, len(time))
        return fitted(decay_model(k=110, c=0.1, M=0.5), of_twist(twist), list(true))

    return true, fit


def of_cubic_decay():
    """From 0.33 rad on 140 N m/rad and 2600 N m/rad^3, at 1 kHz: half swings by DOP853, each from rest to rest."""
    true, time = {"k": 140.0, "k3": 2600.0, "c": 0.06, "M": 0.35}, np.arange(0, 3, 1e-3)
    clean, begin, turned, sense = np.empty(len(time)), 0.33, 0.0, -1.0
    while 140 * abs(begin) + 2600 * abs(begin) ** 3 > 0.35 and turned < time[-1]:

        def motion(_time, y, sense=sense):
            return y[1], -(140 * y[0] + 2600 * y[0] ** 3 + 0.06 * y[1] + 0.35 * sense) / INERTIA

        def rests(_time, y, sense=sense):
            return y[1] * sense

        rests.terminal, rests.direction = True, -1
        found = scipy.integrate.solve_ivp(
            motion, (turned, 4.0), (begin, sense * 1e-9), "DOP853", None, True, rests, rtol=1e-11, atol=1e-13
        )
        inside = (time >= turned) & (time <= found.t[-1])
        clean[inside] = found.sol(time[inside])[0]
        turned, begin, sense = found.t[-1], found.y[0][-1], -sense
    clean[time >= turned] = begin
    parts = [
        tn.Inertia("mass", node="a", inertia=INERTIA),
        tn.Spring("disc", nodes=("a", "ground"), stiffness="k", cubic="k3", damping="c"),
        tn.Friction("ring", nodes=("a", "ground"), torque="M"),
    ]
    inputs, sensors = {"T": {"torque": "a"}}, {"gamma": {"angle": "a"}}
    model = tn.Drivetrain("b", parts, {"k": 130, "k3": 2900, "c": 0.08, "M": 0.45}, inputs=inputs, sensors=sensors)

    def fit(seed):
        twist = clean + np.random.default_rng(seed).normal(0, NOISE, len(time))
        return fitted(model, of_twist(twist, 1000.0), list(true))

    return true, fit


def of_driven_stages():
    """Torque of 0.5 N m noise that leads 0.05 kg m^2 on the stages along three sines, with oil and friction."""
    true, time = STAGES | {"c": 0.5, "M": 3.0}, np.arange(0, 4, 1e-3)
    swings = [(0.16, 1.3, 0.2), (0.09, 4.1, 1.0), (0.03, 9.7, 2.0)]
    twist, rate, bent = (
        sum(a * (2 * np.pi * f) ** n * np.sin(2 * np.pi * f * time + p + n * np.pi / 2) for a, f, p in swings)
        for n in range(3)
    )
    torque = INERTIA * bent + true["c"] * rate + staged(twist) + true["M"] * np.sign(rate)
    start = {"k1": 430.0, "k2": 1600.0, "g1": 0.11, "M": 2.5, "c": 0.7}
    oil = tn.Inertia("mass", node="a", inertia=INERTIA), tn.Damper("oil", nodes=("a", "ground"), damping="c")
    inputs, sensors = {"T": {"torque": "a"}}, {"gamma": {"angle": "a"}}
    model = tn.Drivetrain(
        "b", [*stages(k1=430, k2=1600, g1=0.11, M=2.5).elements.values(), *oil], start, inputs=inputs, sensors=sensors
    )

    def fit(seed):
        noise = np.random.default_rng(seed).normal(size=(2, len(time)))
        record = loop_record(torque + 0.5 * noise[0], twist + np.radians(0.003) * noise[1], 1000.0)
        return fitted(model, record, list(true), "T")

    return true, fit


def of_loops():
    return STAGES, lambda seed: fitted(stages(k1=430, k2=1600, g1=0.11, M=4.0), stage_record(seed), list(STAGES), "T")


LARGEST = {"k": 0.005, "k3": 0.005, "k1": 0.005, "k2": 0.005, "g1": 0.005, "M": 0.02}
"""Root mean squares of errors over draws that are asked for; damping, beside friction, has no bound."""


@pytest.mark.nightly
@pytest.mark.parametrize(
    "case",
    [lambda: of_decay(**DECAY), lambda: of_decay(**DECAY | {"M": 1.5}), of_cubic_decay, of_driven_stages, of_loops],
    ids=["decay", "five half swings", "cubic", "driven", "loops"],
)
def test_errors_and_intervals_over_draws(case):
    """95 % intervals of 200 draws hold the truth in 90 % or more, and are no wider than the scatter asks for."""
    true, fit_of = case()
    fits = [fit_of(seed) for seed in range(examples(8, 200))]
    for name, value in true.items():
        ends = [fit.intervals()[name] for fit in fits]
        inside = sum(low <= value <= high for low, high in ends)
        assert scipy.stats.binom.cdf(inside, len(fits), 0.9) > 1e-3, (name, inside)
        sound = [fit for fit in fits if not fit.lack_of_fit.rejected]
        assert len(sound) >= 0.94 * len(fits)
        stated = np.sqrt(np.mean([(fit.standard_errors[name] / value) ** 2 for fit in sound]))
        scatter = np.sqrt(np.mean([(fit.values[name] / value - 1) ** 2 for fit in sound]))
        assert scatter < LARGEST.get(name, 1.0), name
        assert 0.5 * scatter < stated < 1.6 * scatter, name
