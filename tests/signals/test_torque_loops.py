"""Loops of torque over twist: stages, friction, free play, loss, corrections, and intervals that cover."""

from __future__ import annotations

import re

import numpy as np
import pytest
from support.campaigns import examples
from support.loop_records import (
    STAGES,
    arc_spring_record,
    backlash_record,
    course,
    loop_record,
    stage_record,
    staged,
)

from torsionnet.base.errors import UsageError
from torsionnet.signals import loops

TRUE = {"k_1": 460.0, "k_2": 1500.0, "g_1": 0.12, "M": 6.0}
SCATTER = {"k_1": 0.036e-2, "k_2": 0.02e-2, "g_1": 0.023e-2, "M": 0.13e-2}
"""Relative scatter over many records, of another implementation."""


def only(record, **corrections):
    (loop,) = loops(record, "T", "gamma", **corrections).loops
    return loop


def stage_values(loop):
    first, second = loop.side("both")
    return {"k_1": first.stiffness, "k_2": second.stiffness, "g_1": second.begins, "M": loop.friction}


def test_stages_and_friction_of_a_noisy_record_are_as_certain_as_the_noise_allows():
    loop = only(stage_record(3))
    assert loop.cycles == 5
    assert loop.frequency == pytest.approx(0.5, rel=1e-3)
    for name, one in stage_values(loop).items():
        assert one.value == pytest.approx(TRUE[name], rel=5 * SCATTER[name]), name
        assert 0.2 * SCATTER[name] < one.half_width / TRUE[name] < 6 * SCATTER[name], name
    for side in ("drive", "coast"):
        assert [round(one.friction.value, 1) for one in loop.side(side)] == [6.0, 6.0]


@pytest.mark.parametrize(("seed", "size"), [(0, 0.5), (1, 0.5), (2, 0.5), (3, 0.5), (4, 1.0), (9, 1.0), (13, 1.0)])
def test_free_play_that_noise_tilts_is_free_play_in_every_cycle(seed, size):
    """Over 0.04 rad noise tilts single cycles, and of 1 N m their mean too, by more than a hundredth of 500 N m/rad."""
    twist, sense = course(6.01, 800)
    gamma = 0.25 * twist
    torque = 500 * np.sign(gamma) * np.maximum(np.abs(gamma) - 0.02, 0) + 6 * sense
    noise = np.random.default_rng(1000 + seed).normal(0, size, len(gamma))
    loop = only(loop_record(torque + noise, gamma))
    assert loop.free_play.value == pytest.approx(0.04, rel=0.04)
    for side in ("drive", "coast"):
        (stage,) = loop.side(side)
        assert stage.stiffness.value == pytest.approx(500, rel=4e-3)


def test_secant_and_loss_of_stages_with_coulomb_friction_are_those_of_the_closed_form():
    loop = only(stage_record(4))
    # (460*.12 + 1500*.13 + 6)/.25 from tip to tip, and D = 4 M a.
    assert loop.secant_stiffness.value == pytest.approx(1024.8, abs=3)
    assert loop.loss.value == pytest.approx(6.0, abs=0.05)
    assert loop.eta_s.value == pytest.approx(6.0 / (np.pi * 1024.8 * 0.25**2), rel=0.01)


def test_first_harmonic_of_a_sine_over_stages_is_that_of_the_describing_function():
    twist, sense = course(4.6, 4000, sine=True)
    loop = only(loop_record(staged(0.2 * twist) + 6 * sense, 0.2 * twist))
    assert loop.storage_stiffness.value == pytest.approx(756.147259, rel=1e-4)
    assert loop.eta_1.value == pytest.approx(0.0505155, rel=1e-3)
    assert loop.loss_stiffness.value == pytest.approx(loop.loss.value / (np.pi * 0.2**2), rel=1e-3)


def test_the_two_loss_factors_of_an_arc_spring_differ_and_are_named_apart():
    loop = only(arc_spring_record())
    assert loop.eta_s.value == pytest.approx(0.424413, rel=1e-3)
    assert loop.eta_1.value == pytest.approx(0.5, rel=1e-3)
    assert loop.secant_stiffness.value == pytest.approx(2933.90, rel=1e-3)
    assert loop.storage_stiffness.value == pytest.approx(2490.37, rel=1e-3)
    assert loop.loss.value == pytest.approx(4.766489, rel=1e-3)
    assert loop.mean_twist == pytest.approx(np.radians(20.0), rel=1e-4)


def test_free_play_is_measured_between_the_lines_of_both_flanks():
    loop = only(backlash_record(1))
    assert loop.free_play.value == pytest.approx(np.radians(0.5), rel=3e-3)
    (contact,) = loop.side("both")
    assert contact.stiffness.value == pytest.approx(20000, rel=1e-2)
    assert contact.begins.value == pytest.approx(np.radians(0.25), rel=3e-3)
    assert loop.friction.value == pytest.approx(1.0, rel=1e-2)


def test_drive_and_coast_that_differ_are_told():
    twist, sense = course(4.6, 800)
    torque = np.where(twist > 0, 900.0, 700.0) * 0.1 * twist + 4 * sense
    rng = np.random.default_rng(0)
    found = loops(loop_record(torque + rng.normal(0, 0.2, len(twist)), 0.1 * twist), "T", "gamma")
    (loop,) = found.loops
    for side, stiffness in {"drive": 900, "coast": 700, "both": 800}.items():
        (stage,) = loop.side(side)
        assert stage.stiffness.value == pytest.approx(stiffness, rel=2e-3)
    assert any("stiffness differs" in note for note in found.notes)


def sine_record(*, inertia=0.0, late=0.0, amplitude=0.15, frequency=1.5, noise=0.1):
    """Record of 900 N m/rad with friction 5 N m."""
    twist, _ = course(6.6, 800, sine=True)
    rate = 800 * frequency
    turns = np.arange(len(twist)) / 800 - late * frequency
    torque = -900 * amplitude * np.cos(2 * np.pi * turns) + 5 * np.where(turns % 1 < 0.5, 1.0, -1.0)
    torque -= inertia * (2 * np.pi * frequency) ** 2 * amplitude * twist
    torque += np.random.default_rng(2).normal(0, noise, len(twist))
    return loop_record(torque, amplitude * twist, rate)


def test_inertia_of_the_moving_side_lowers_the_stiffness_until_it_is_taken_out():
    record = sine_record(inertia=0.045)
    (seen,) = only(record).side("both")
    assert seen.stiffness.value == pytest.approx(900 - 4.0, abs=0.3)
    assert any("each 0.01 kg m^2 lowers" in note for note in loops(sine_record(frequency=4.0), "T", "gamma").notes)
    (corrected,) = only(record, inertia=0.045).side("both")
    assert corrected.stiffness.value == pytest.approx(900, abs=0.3)


def test_a_late_torque_narrows_the_loop_until_it_is_moved():
    record = sine_record(late=1.2e-3)
    seen = loops(record, "T", "gamma")
    # k a sin(w tau) = 1.5 N m in the middle of the loop; the loss D = 4 M a loses pi k a^2 sin(w tau), 24 %.
    assert seen.loops[0].loss.value == pytest.approx(4 * 5 * 0.15 * 0.76, rel=0.01)
    assert any("narrows the loop" in note for note in seen.notes)
    loop = only(record, delay=1.2e-3)
    assert loop.loss.value == pytest.approx(4 * 5 * 0.15, rel=0.005)
    assert loop.friction.value == pytest.approx(5.0, rel=0.005)


def test_drift_opens_the_loop_until_it_is_taken_out():
    record = stage_record(5, drift=2.0)
    seen = loops(record, "T", "gamma")
    assert seen.loops[0].drift.value == pytest.approx(2.0, abs=0.05)
    assert any("drifts by 2" in note for note in seen.notes)
    loop = only(record, drift=True)
    # A drift of 2 N m a cycle lifts the falling branch by 1 N m on average over the rising one.
    assert seen.loops[0].friction.value == pytest.approx(6.0 - 0.5, abs=0.05)
    assert loop.friction.value == pytest.approx(6.0, abs=0.05)


def test_drift_beyond_the_friction_is_a_warning():
    notes = loops(stage_record(5, drift=9.0), "T", "gamma").notes
    assert any("more than the friction torque" in note and str(note).startswith("warning") for note in notes)
    assert not any("in series" in note for note in notes)


def test_coarse_steps_of_the_encoder_widen_the_intervals():
    step, (twist, sense) = np.radians(0.25), course(4.6, 800)
    torque = staged(0.25 * twist) + sense + np.random.default_rng(1).normal(0, 0.1, len(twist))
    record = loop_record(torque, (np.round(0.25 * twist / step + 0.3) - 0.3) * step)
    found = loops(record, "T", "gamma")
    assert any("steps of the twist of 0.25 deg" in note for note in found.notes)
    unknown = loops(record, "T", "gamma", encoder_step=1e-9)
    assert [any("in series" in note for note in one.notes) for one in (found, unknown)] == [False, True]
    told, hidden = (stage_values(one.loops[0]) for one in (found, unknown))
    assert told["k_1"].half_width > 1.5 * hidden["k_1"].half_width


def test_something_elastic_in_series_with_the_friction_is_named():
    twist, _ = course(4.6, 800)
    slider, torque = 0.0, []
    for one in 0.2 * twist:  # 300 N m/rad before 12 N m slip, beside 500 N m/rad
        slider += min(max(one - slider - 12 / 300, 0), 1) + max(min(one - slider + 12 / 300, 0), -1)
        torque.append(500 * one + 300 * (one - slider))
    notes = loops(loop_record(np.array(torque), 0.2 * twist), "T", "gamma").notes
    assert any("elastic in series with the friction" in note for note in notes)


@pytest.mark.parametrize(("stiff", "samples", "sine"), [(6000.0, 2000, False), (12000.0, 800, True)])
def test_a_stiff_adapter_between_the_sensors_is_named(stiff, samples, sine):
    k, M = 500.0, 6.0
    turn, sense = course(4.6, samples, sine=sine)
    twist = 0.2 * turn
    own, torque = 0.0, []
    for one in twist:  # the component slips where adapter less spring exceed the friction
        own = float(np.clip(own, (stiff * one - M) / (k + stiff), (stiff * one + M) / (k + stiff)))
        torque.append(stiff * (one - own))
    noise = np.random.default_rng(2).normal(0, 0.1, len(twist))
    notes = loops(loop_record(np.array(torque) + noise, twist), "T", "gamma").notes
    (told,) = [str(note) for note in notes if "in series between the sensors" in str(note)]
    assert float(re.search(r"behind ([\d.e+]+) N m/rad", told)[1]) == pytest.approx(stiff, rel=0.06)
    rigid = k * twist + M * sense + noise
    assert not [note for note in loops(loop_record(rigid, twist), "T", "gamma").notes if "series" in str(note)]


def test_a_loop_of_a_sine_that_is_wider_in_its_middle_is_viscous():
    twist, sense = course(4.6, 2000, sine=True)
    omega = 2 * np.pi * 0.1
    torque = 900 * 0.15 * twist + 3 * sense + 4 * omega * 0.15 * sense * np.sqrt(np.maximum(1 - twist**2, 0))
    noise = np.random.default_rng(0).normal(0, 0.05, len(twist))
    notes = [str(one) for one in loops(loop_record(torque + noise, 0.15 * twist, 200), "T", "gamma").notes]
    (told,) = [one for one in notes if "wider in its middle" in one]
    assert float(re.search(r"c = ([\d.]+)", told)[1]) == pytest.approx(4, rel=0.1)
    assert not [one for one in notes if "in series" in one]


def test_torque_that_relaxes_where_the_twist_is_held_is_creep():
    past = np.linspace(0, 1, 400)
    ends = np.ones(200)
    twist = 0.1 * np.concatenate([np.r_[2 * past - 1, ends, 1 - 2 * past, -ends]] * 4 + [2 * past - 1])
    fall = 3.0 * (1 - np.exp(-np.arange(200) / 40))
    held = np.concatenate([np.r_[0 * past, -fall, 0 * past, fall]] * 4 + [0 * past])
    sense = np.concatenate([np.r_[past * 0 + 1, ends, past * 0 - 1, -ends]] * 4 + [past * 0 + 1])
    torque = 900 * twist + 5 * sense + held + np.random.default_rng(1).normal(0, 0.1, len(twist))
    assert any("creep" in str(note) for note in loops(loop_record(torque, twist), "T", "gamma").notes)


def test_loops_over_two_amplitudes_are_two():
    twist, sense = course(4, 800)
    sizes = np.repeat([0.08, 0.25], len(twist))
    both = sizes * np.tile(twist, 2)
    tail = 0.25 * course(0.3, 800)[0]
    twists = np.r_[both, tail]
    senses = np.r_[np.tile(sense, 2), np.ones(len(tail))]
    found = loops(loop_record(staged(twists) + 6 * senses, twists), "T", "gamma").loops
    assert [round(one.amplitude.value, 3) for one in found] == [0.08, 0.25]
    # Coulomb friction adds M/a to the secant.
    assert found[0].secant_stiffness.value == pytest.approx(460 + 6 / 0.08, rel=1e-2)
    assert [len(one.side("both")) for one in found] == [1, len(STAGES)]


def runs(*frequencies, viscous=0.0, creep=0.0, inertia=0.0):
    """Record of 900 N m/rad, friction 5 N m, sines of 0.15 rad at frequencies in Hz, one behind the other."""
    parts = []
    for frequency in frequencies:
        time = np.arange(round(5 / frequency * 800)) / 800
        omega = 2 * np.pi * frequency
        twist, rate = -0.15 * np.cos(omega * time), 0.15 * omega * np.sin(omega * time)
        torque = (900 - inertia * omega**2) * twist + (5 + creep / frequency) * np.sign(rate) + viscous * rate
        parts.append((torque, twist))
    torque, twist = (np.concatenate(one) for one in zip(*parts, strict=True))
    return loop_record(torque + np.random.default_rng(3).normal(0, 0.05, len(torque)), twist, 800)


@pytest.mark.parametrize(
    ("spoiled", "words"),
    [
        ({"viscous": 0.8}, "grows by .*a part of it is viscous, c = 0.8 N m s/rad"),
        ({"creep": 0.5}, "grows with slowness is creep"),
        ({"inertia": 0.045}, "an inertia of 0.04[45]"),
        ({}, ""),
    ],
    ids=["viscous", "creep", "inertia", "nothing"],
)
def test_two_speeds_tell_viscous_friction_creep_and_inertia_apart(spoiled, words):
    notes = loops(runs(0.5, 1.5, **spoiled), "T", "gamma").notes
    told = [str(note) for note in notes if "from 0.5 to 1.5 Hz" in str(note)]
    assert len(told) == len(spoiled)
    assert all(re.search(words, one) for one in told)


def test_a_swing_at_which_nothing_slips_is_told():
    twist, _ = course(5.6, 800, sine=True)
    torque = 3000 * 0.01 * twist + np.random.default_rng(1).normal(0, 0.5, len(twist))
    notes = loops(loop_record(torque, 0.01 * twist), "T", "gamma").notes
    assert any("swing further" in note for note in notes)


@pytest.mark.parametrize(
    ("twist", "words"),
    [
        (np.linspace(0, 0.2, 2000), "there and back"),
        (0.1 * course(4.6, 400)[0] * np.linspace(0.2, 1, 1840), "hold each amplitude"),
    ],
    ids=["no reversal", "amplitudes that do not repeat"],
)
def test_records_without_repeated_cycles_are_refused(twist, words):
    with pytest.raises(UsageError, match=f"(?s){words}.*no-reversal"):
        loops(loop_record(500 * twist, twist), "T", "gamma")


def test_two_angles_make_a_twist_and_results_are_kept():
    record = stage_record(6)
    half = record["gamma"].values / 2
    from torsionnet.signals import Signal

    angles = record.with_signals(Signal("a", "angle", half), Signal("b", "angle", -half))
    found = loops(angles, "T", ("a", "b"))
    assert found.twist == "a-b"
    again = type(found).from_json(found.to_json())
    assert again.table() == found.table()
    assert found.loops[0].secant_stiffness == only(record).secant_stiffness


def coverage(loops_of_records, true, values):
    """Relative scatter and share of intervals that cover, by name, over loops."""
    found = [values(loop) for loop in loops_of_records]
    names = list(true)
    errors = {name: np.array([one[name].value / true[name] - 1 for one in found]) for name in names}
    hits = {
        name: np.mean([abs(one[name].value - true[name]) <= one[name].half_width for one in found]) for name in names
    }
    return errors, hits


@pytest.mark.slow
@pytest.mark.parametrize(
    ("walk", "scatter"),
    [(0.0, SCATTER), (0.02, {"k_1": 0.2e-2, "k_2": 0.1e-2, "g_1": 0.05e-2, "M": 2e-2})],
    ids=["white noise", "random walk"],
)
def test_intervals_over_cycles_cover_also_where_the_meter_wanders(walk, scatter):
    seeds = range(examples(16, 80))
    errors, hits = coverage((only(stage_record(seed, walk=walk)) for seed in seeds), TRUE, stage_values)
    for name, one in errors.items():
        assert one.std() < 1.35 * scatter[name], name
        assert abs(one.mean()) < 4 * one.std() / np.sqrt(len(one)) + 1e-4, name
        assert hits[name] >= examples(0.8, 0.86), name


@pytest.mark.nightly
@pytest.mark.parametrize(("degrees", "scatter"), [(0.05, 0.06e-2), (0.25, 0.25e-2)])
def test_intervals_with_the_steps_of_an_encoder_cover(degrees, scatter):
    every = [only(stage_record(seed, step=np.radians(degrees))) for seed in range(50)]
    # Steps that lie by a break alike in all cycles may make a stage of their own, on one side or both.
    two = [loop for loop in every if len(loop.side("both")) == 2]
    assert len(two) >= 44
    errors, hits = coverage(two, TRUE, stage_values)
    # Intervals over cycles alone cover .87 to .98 of .05 deg, and .45, .17 and .13 of .25 deg.
    assert min(hits[name] for name in TRUE) >= 0.8
    assert errors["k_1"].std() < scatter


@pytest.mark.nightly
def test_free_play_and_contact_stiffness_are_without_bias_by_distance_in_both_channels():
    true = {"k": 20000.0, "gap": np.radians(0.5), "M": 1.0}

    def values(loop):
        return {"k": loop.side("both")[0].stiffness, "gap": loop.free_play, "M": loop.friction}

    errors, hits = coverage((only(backlash_record(seed)) for seed in range(60)), true, values)
    assert errors["k"].std() < 0.45e-2
    assert abs(errors["k"].mean()) < 0.15e-2
    assert errors["gap"].std() < 0.11e-2
    assert abs(errors["gap"].mean()) < 0.04e-2
    assert min(hits.values()) >= 0.85


def test_without_friction_nothing_grows_with_speed_and_without_torque_there_is_no_loop():
    gamma = 0.2 * course(6.01, 200)[0]
    notes = [str(note) for note in loops(loop_record(500 * gamma, gamma), "T", "gamma").notes]
    assert len(notes) == 1
    assert "no loss is seen" in notes[0]
    with pytest.raises(UsageError, match="unfit-channel"):
        loops(loop_record(0 * gamma, gamma), "T", "gamma")
