"""Response to all orders along a speed over time: against an integrator, in the limits, and for library ships."""

import numpy as np
import pytest
import scipy

import torsionnet as tn
from torsionnet.base.units import RPM
from torsionnet.machinery.passage.passage_response import crests, cycles_above, envelopes

J, K, C = (2.0, 3.0), 1.2e4, 6.0
NATURAL = np.sqrt(K * (1 / J[0] + 1 / J[1]))  # 100 rad/s


def two_masses(damping=C, **more):
    elements = [
        tn.Inertia("a", node="a", inertia=J[0]),
        tn.Inertia("b", node="b", inertia=J[1]),
        more.pop("spring", tn.Spring("shaft", nodes=("a", "b"), stiffness=K, damping=damping)),
        *more.pop("extra", ()),
    ]
    orders = {1: {"amplitude": "10 N*m"}, 2: {"amplitude": "4 N*m", "phase": "50 deg"}}
    excitations = {"engine": {"type": "harmonic", "node": "a", "orders": orders}}
    speeds = {"of": "a", "range": "100..2000 rpm", "step": "100 rpm", "rated": "2000 rpm"}
    return tn.Drivetrain("two", elements, speeds=speeds, excitations=excitations, **more)


def integrated(times, at, speeds, damping=lambda _: 0.0):
    """Torque in the shaft from matrices written down here; ``damping`` of mass b to ground at each speed."""
    slope = np.diff(speeds) / np.diff(at)
    starts = np.concatenate([[0.0], np.cumsum(np.diff(at) * (speeds[:-1] + np.array(speeds[1:])) / 2)])

    def course(t):
        piece = min(max(int(np.searchsorted(at, t, side="right")) - 1, 0), len(slope) - 1)
        since = t - at[piece]
        return (
            starts[piece] + speeds[piece] * since + slope[piece] * since**2 / 2,
            speeds[piece] + slope[piece] * since,
        )

    def matrices(speed):
        k = K * np.array([[1, -1], [-1, 1]])
        c = C * np.array([[1, -1], [-1, 1]]) + np.diag([0.0, damping(speed)])
        return k, c

    def rates(t, x):
        angle, speed = course(t)
        k, c = matrices(speed)
        torque = 10 * np.cos(angle) + 4 * np.cos(2 * angle + np.radians(50))
        return np.concatenate([x[2:], (np.array([torque, 0.0]) - k @ x[:2] - c @ x[2:]) / J])

    first = np.zeros(4)
    k, c = matrices(speeds[0])
    for order, load in ((1, 10.0), (2, 4 * np.exp(1j * np.radians(50)))):
        w = order * speeds[0]
        q = np.linalg.solve(k + 1j * w * c - w**2 * np.diag(J), [load, 0])
        first += np.concatenate([q.real, (1j * w * q).real])
    x = [first[:, None]]
    for piece in range(len(slope)):
        inside = (times > at[piece]) & (times <= at[piece + 1] * (1 + 1e-12))
        run = scipy.integrate.solve_ivp(
            rates, at[piece : piece + 2], x[-1][:, -1], "DOP853", np.minimum(times[inside], at[piece + 1]),
            rtol=1e-9, atol=1e-12,
        )  # fmt: skip
        x.append(run.y)
    x = np.concatenate(x, axis=1)
    return K * (x[0] - x[1]) + C * (x[2] - x[3])


def off(run, exact):
    sign = np.sign(run.of() @ exact)
    return np.abs(sign * run.of() - exact).max() / np.abs(exact).max()


@pytest.mark.parametrize("speeds", [(70, 130), pytest.param((130, 70), marks=pytest.mark.slow)])
def test_sweep_through_resonance_as_integrated(speeds):
    at = [0.0, 1.0]
    run = two_masses().passage_response("torque(shaft)", at, speeds)
    assert off(run, integrated(run.times, np.array(at), np.array(speeds, float))) < 1e-6
    assert run.speeds[[0, -1]] == pytest.approx(speeds)
    assert run.angles[-1] == pytest.approx(100)
    assert run.error <= 1e-5


def test_a_hold_between_two_ramps():
    at, speeds = np.array([0.0, 0.5, 0.8, 1.2]), np.array([80.0, 100.0, 100.0, 60.0])
    run = two_masses().passage_response("torque(shaft)", at, speeds)
    assert off(run, integrated(run.times, at, speeds)) < 1e-6


def test_damping_at_the_speed_of_the_moment():
    extra = [tn.Damper("water", nodes=("b", "ground"), damping="c")]
    table = {"100 rpm": "2 N*m*s/rad", "2000 rpm": "40 N*m*s/rad"}
    rig = two_masses(extra=extra, parameters={"c": {"by": "speed", "of": "a", "table": table}})
    at, speeds = np.array([0.0, 1.5]), np.array([70.0, 130.0])
    run = rig.passage_response("torque(shaft)", at, speeds)
    exact = integrated(run.times, at, speeds, lambda speed: np.interp(speed * RPM, [100, 2000], [2, 40]))
    assert off(run, exact) < 2e-5
    constant = integrated(run.times, at, speeds, lambda _: 2.0)
    assert off(run, constant) > 1e-2


def test_lewis_a_quicker_sweep_has_a_lower_and_a_later_peak():
    """F. M. Lewis, Trans. ASME 54 (1932), 253: the peak is lower and shifts in the direction of the sweep."""
    light = two_masses(damping=2.0)
    runs = [light.passage_response("torque(shaft)", [0, time], [80, 125]).peak() for time in (1, 4, 200)]
    down = light.passage_response("torque(shaft)", [0, 1], [125, 80]).peak()
    sizes, shifts = [one.half_range for one in runs], [one.rpm / RPM - NATURAL for one in runs]
    assert sizes[0] < 0.7 * sizes[1] < sizes[2]
    assert shifts[0] > shifts[1] > shifts[2] > -0.1
    assert down.rpm / RPM < NATURAL - 1


@pytest.mark.slow
def test_undamped_sweep_from_rest_by_fresnel_integrals():
    """Behind resonance the free vibration of an undamped mass has the amplitude T/(J w) sqrt(pi/(2 a)), a in rad/s^2."""
    rig = tn.Drivetrain(
        "one", [tn.Inertia("a", node="a", inertia=1), tn.Spring("s", nodes=("a", "ground"), stiffness=1e4)],
        speeds={"of": "a", "list": ["955 rpm"]},
        excitations={"e": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": "1 N*m"}}}},
    )  # fmt: skip
    slope = 5.0
    run = rig.passage_response("a", [0, 100], [20, 520])
    late = run.times > 90
    free = 1 / 100 * np.sqrt(np.pi / (2 * slope))
    assert np.abs(run.of()[late]).max() == pytest.approx(free, rel=0.03)


def test_a_slow_passage_is_the_steady_response():
    rig = two_masses()
    run = rig.passage_response("torque(shaft)", [0, 150], [98, 102])
    times, sizes = run.envelope()
    speeds = np.interp(times, run.times, run.speeds)[20::200]
    assert sizes[20::200] == pytest.approx(
        rig.order_response("torque(shaft)", speeds=speeds).half_range[:, 0], rel=5e-3
    )


@pytest.mark.parametrize("rpm", [46, 51])
def test_a_ship_at_constant_speed_is_in_steady_vibration(rpm):
    ship, names = tn.load("bulk_carrier").configured("normal"), ["stress(int_shaft)", "torque(tail)", "phi_1"]
    run = ship.passage_response(names, [0, 4], [rpm / RPM] * 2)
    steady = ship.order_response(names, speeds=[rpm / RPM]).half_range[0]
    assert [run.peak(name).half_range for name in names] == pytest.approx(steady, rel=1e-3)


HARMONIC, MACHINE = {"type": "harmonic", "node": "a"}, {"type": "electric_machine", "node": "a"}
SLOW_LINES = {
    "orders 1.5 and 3.5": HARMONIC | {"orders": {1.5: {"amplitude": 1}, 3.5: {"amplitude": 0.5}}},
    "a line of 2 Hz": MACHINE
    | {"line": {"frequency": "2 Hz", "multiples": {1: {"amplitude": 1}, 1.5: {"amplitude": 1}}}},
    "a slip of 10 Hz": MACHINE | {"pole_pairs": 2, "slip": {"frequency": "25 Hz", "amplitude": [[0, 1], [5000, 1]]}},
}


def driven(excitations):
    elements = [
        tn.Inertia("a", node="a", inertia=1),
        tn.Inertia("b", node="b", inertia=1e3),
        tn.Spring("shaft", nodes=("a", "b"), stiffness=1e6, damping=300),
    ]
    return tn.Drivetrain("driven", elements, speeds={"of": "b", "list": [600 / RPM]}, excitations=excitations)


@pytest.mark.parametrize("line", SLOW_LINES)
def test_half_ranges_hold_a_common_cycle_of_all_lines(line):
    """In a window of the slowest order alone the first two had 91 and 54 %, in a quarter turn the slip had 71 %."""
    rig = driven({"drive": SLOW_LINES[line]})
    run = rig.passage_response("torque(shaft)", [0, 4], [600 / RPM] * 2)
    steady = rig.order_response("torque(shaft)", speeds=[600 / RPM]).half_range[0, 0]
    assert run.peak().half_range == pytest.approx(steady, rel=1e-3)
    # Where a crest falls on the edge of a window, the sample beside it stands for it.
    assert run.envelope()[1] == pytest.approx(np.full(len(run.envelope()[0]), steady), rel=0.03)


def test_shafts_with_a_short_common_cycle():
    """Shafts of 3/2 and 4/2 of the speed of the reference repeat together after two of its turns."""
    elements = [
        tn.Inertia("a", node="a", inertia=1),
        tn.Inertia("b", node="b", inertia=1e3),
        tn.Spring("shaft", nodes=("a", "b"), stiffness=1e6, damping=300),
        tn.Gear("first", nodes=("p", "a"), ratio="3/2"),
        tn.Gear("second", nodes=("q", "a"), ratio=2),
    ]
    one = {"type": "harmonic", "orders": {1: {"amplitude": "10 N*m"}, 2: {"amplitude": "5 N*m"}}}
    rig = tn.Drivetrain("geared", elements, speeds={"of": "b", "list": [600 / RPM]},
                        excitations={"p": one | {"node": "p"}, "q": one | {"node": "q"}})  # fmt: skip
    run = rig.passage_response("torque(shaft)", [0, 5], [600 / RPM] * 2)
    steady = rig.order_response("torque(shaft)", speeds=[600 / RPM]).half_range[0, 0]
    assert run.envelope()[1] == pytest.approx(np.full(len(run.envelope()[0]), steady), rel=0.03)


def test_a_synchronous_motor_starts_through_a_resonance_at_its_slip():
    """Twice the slip frequency falls through 15 Hz at 1275 of 1500 rpm, where a quarter turn is a sixth of a period."""
    rotor, screw, stiffness = 20.0, 30.0, 12 * (2 * np.pi * 15) ** 2
    elements = [
        tn.Inertia("a", node="a", inertia=rotor),
        tn.Inertia("b", node="b", inertia=screw),
        tn.Spring("shaft", nodes=("a", "b"), stiffness=stiffness, damping=stiffness * 0.04 / (2 * np.pi * 15)),
    ]
    slip = {"frequency": "50 Hz", "amplitude": [[0, 1e4], [1500, 1e4]]}
    rig = tn.Drivetrain("start", elements, speeds={"of": "a", "list": [1000 / RPM]},
                        excitations={"motor": MACHINE | {"pole_pairs": 2, "slip": slip}})  # fmt: skip
    run = rig.passage_response("torque(shaft)", [0, 6], [1200 / RPM, 1490 / RPM])
    assert run.peak().half_range == pytest.approx(np.abs(run.of()).max(), rel=0.03)


@pytest.mark.slow
def test_quick_passage_of_a_ship_is_lower_and_later():
    ship = tn.load("bulk_carrier").configured("normal")
    steady = ship.order_response("stress(int_shaft)", speeds=np.arange(48, 54, 0.05) / RPM).half_range.max()
    quick, slow = (
        ship.passage_response("stress(int_shaft)", [0, time], [42 / RPM, 61 / RPM]).peak() for time in (8, 80)
    )
    assert quick.half_range < 0.9 * steady
    assert 0.95 * steady < slow.half_range < steady
    assert quick.rpm > slow.rpm > 51


def test_misfire_takes_the_worst_cylinder():
    ship = tn.load("two_stroke_ship").configured("misfire")
    run = ship.passage_response("torque(tail)", [0, 2], [50 / RPM] * 2)
    steady = ship.order_response("torque(tail)", speeds=[50 / RPM])
    assert run.peak().half_range == pytest.approx(steady.half_range[0, 0], rel=1e-3)
    assert run.notes[0].endswith(steady.case_at(0))


def test_hysteretic_springs_have_their_viscous_equivalent():
    rubber = tn.HystereticSpring("shaft", nodes=("a", "b"), stiffness=K, loss_factor=0.05)
    found = two_masses(spring=rubber).passage_response("torque(shaft)", [0, 1], [80, 120])
    note = next(note for note in found.notes if "Hz" in note)
    frequency = float(note.split(" at ")[1].split(" Hz")[0])
    assert frequency == pytest.approx(NATURAL / (2 * np.pi), rel=0.01)
    viscous = two_masses(damping=K * 0.05 / (2 * np.pi * frequency))
    same = viscous.passage_response("torque(shaft)", [0, 1], [80, 120])
    assert found.of() == pytest.approx(same.of(), abs=2e-3 * same.peak().half_range)


@pytest.mark.parametrize(("last", "is_noted"), [(20, True), (40, False)])
def test_a_table_that_ends_below_the_highest_order_is_noted(last, is_noted):
    """Order 2 at 120 rad/s is 38.1972 Hz."""
    rubber = tn.TabulatedSpring("shaft", nodes=("a", "b"), table=[[1, K, 6], [last, K, 6]])
    found = two_masses(spring=rubber).passage_response("torque(shaft)", [0, 0.2], [80, 120])
    text = "shaft: the rows of its table go from 1 to 20 Hz, and it is read at up to 38.1972 Hz, where the last row is kept"
    assert (text in found.notes) is is_noted
    assert any("rows of its table" in note for note in found.notes) is is_noted


def test_cycles_and_time_above():
    angle = np.linspace(0, 40 * np.pi, 8001)
    wave = np.cos(angle) * np.interp(angle, [0, 20 * np.pi, 40 * np.pi], [0, 1, 0])
    assert cycles_above(wave, 0.5) == pytest.approx(10, abs=0.5)
    # A ripple of three times the frequency has crests of its own, but is no cycle of its own.
    assert cycles_above(wave + 0.2 * np.cos(3 * angle) * np.abs(wave), 0.5) < 12
    middle, low, high = envelopes(angle, np.cos(angle) + 0.5 * np.cos(2 * angle), 2 * np.pi)
    assert high - low == pytest.approx(np.full(len(middle), 1.5 + 0.75), rel=1e-4)


def test_results_are_shown():
    from torsionnet.plot import passage_response as drawn

    run = two_masses().passage_response(["torque(shaft)", "a"], [0, 1], [80, 120])
    peak = run.peak("torque(shaft)")
    assert run.table().rows[0][:2] == ("torque(shaft)", peak.half_range)
    assert run.long_table().rows[-1][1] == pytest.approx(120 * RPM)
    assert 0 < run.seconds_above(0.5 * peak.half_range, "torque(shaft)") < 1
    assert run.cycles_above(1.1 * peak.half_range, "torque(shaft)") == 0
    level = np.linspace(10, 20, len(run.times))
    labels = [line.get_label() for line in drawn(run, "torque(shaft)", limits={"allowed": level}).axes[0].lines]
    assert "allowed" in labels


@pytest.mark.parametrize(
    ("times", "speeds", "said"),
    [
        ([0, 1], [80], "alike long"),
        ([0, 0], [80, 90], "times rise"),
        ([0, 1], [0, 90], "above 0"),
        ([0, 1], [80, np.nan], "finite"),
        ([0, 1e6], [80, 90], "shorten the time"),
        (np.arange(3000), np.full(3000, 80), "thin them out"),
    ],
)
def test_speeds_that_cannot_be_followed(times, speeds, said):
    with pytest.raises(tn.UsageError, match=said):
        two_masses().passage_response("torque(shaft)", times, speeds)


def test_many_cycles_are_drawn_as_the_area_between_their_envelopes():
    """Of 955 cycles no line is drawn; the area reaches as high as the half range, on one axis with the quick passage."""
    from torsionnet.plot import passage_response as drawn

    rig = two_masses()
    quick, slow = (rig.passage_response("torque(shaft)", [0, time], [80, 120]) for time in (1, 60))
    levels = [{"allowed": np.full(len(one.times), 20.0)} for one in (quick, slow)]
    figure = drawn([quick, slow], limits=levels)
    left, right = figure.axes[0], figure.axes[1]
    assert left.get_ylim() == right.get_ylim()
    (band,) = right.collections
    assert not left.collections
    top = max(float(path.vertices[:, 1].max()) for path in band.get_paths())
    assert top == pytest.approx(slow.peak().half_range, rel=0.02)
    assert max(len(line.get_xdata()) for line in right.lines[:3]) < 4100
    for panel in (left, right):
        assert "allowed" in [line.get_label() for line in panel.lines]


def test_envelopes_by_hand():
    """A wave of the amplitude t/25 after t turns, on a mean of 3."""
    turns = np.linspace(0, 50, 20001)
    middle, low, high = envelopes(2 * np.pi * turns, 3 + turns / 25 * np.cos(2 * np.pi * turns), 2 * np.pi)
    at = middle / 2 / np.pi / 25
    assert np.abs(high - (3 + at)).max() < 0.021  # half a cycle of growth, 1/50
    assert np.abs(low - (3 - at)).max() < 0.021


def test_three_samples_have_a_crest():
    """Parabola 1 - (t - .5)^2/10 through t = -1, 0, 1."""
    found = crests(1 - (np.array([-1.0, 0.0, 1.0]) - 0.5) ** 2 / 10)
    assert found[1] == pytest.approx(1)
