"""Scenarios: torques over time and short circuits, against matrices of the test's own and closed forms."""

import json
from math import pi, sqrt

import numpy as np
import pytest
import scipy
from support.command_line import run

import torsionnet as tn
from torsionnet.model.elements import Values
from torsionnet.motion.scenarios.short_circuit import ShortCircuitScenario
from torsionnet.motion.scenarios.time_history import HistoryPiece, TimeHistory, Wave, straight
from torsionnet.motion.scenarios.torques_of_nodes import TorqueScenario
from torsionnet.signals.records.recording_files import read_recording
from torsionnet.study.quantities.quantity import VariantBlock
from torsionnet.study.quantities.transient_peak import ScenarioPeak

SSR = tn.load("turbine_generator_ssr")
T_0 = SSR.parameters["T_0"]
H = np.array([0.092897, 0.155589, 0.858670, 0.884215, 0.868495, 0.0342165])
K = np.array([19.303, 34.929, 52.038, 70.858, 2.822])
"""Inertia constants in s and stiffnesses per unit of the first SSR benchmark, as published."""


def peaks_per_unit(waves, seconds, steps):
    """Largest torques of the five shafts per unit, under sum of a sin(n w t) against the generator, by exp(A h)."""
    w, n, m = 120 * pi, 6, 2 * len(waves)
    stiffness = np.diag([*K, 0]) + np.diag([0, *K]) - np.diag(K, 1) - np.diag(K, -1)
    A = np.zeros((2 * n + m,) * 2)
    A[:n, n : 2 * n] = np.eye(n)
    A[n : 2 * n, :n] = -stiffness / (2 * H / w)[:, None]
    z = np.zeros(2 * n + m)
    for number, (order, size) in enumerate(waves):
        sine = 2 * n + 2 * number
        A[sine, sine + 1], A[sine + 1, sine], A[n + 4, sine] = order * w, -order * w, -size / (2 * H[4] / w)
        z[sine + 1] = 1
    step, largest = scipy.linalg.expm(A * seconds / steps), np.zeros(5)
    for _ in range(steps + 1):
        largest = np.maximum(largest, np.abs(K * (z[:5] - z[1:6])))
        z = step @ z
    return largest


def fault(**entries):
    return ShortCircuitScenario(**{"machine": "G", "x": 0.135, "rated_torque": "T_0", "frequency": "60 Hz", **entries})


def per_unit(record, name):
    return float(np.abs(record[name].values).max()) / T_0


class TestShortCircuit:
    @pytest.mark.parametrize(
        ("phases", "waves", "lpb_g", "lpa_lpb"),
        [(3, [(1, 1 / 0.135)], 3.3568, 2.0078), (2, [(1, 1 / 0.135), (2, -0.5 / 0.135)], 2.8400, 1.5808)],
    )
    def test_peaks_of_the_ssr_benchmark(self, phases, waves, lpb_g, lpa_lpb):
        record = SSR.simulate(scenario=fault(phases=phases, duration=0.5, rate=4e4))
        found = [per_unit(record, f"T_{name}") for name in ("HP_IP", "IP_LPA", "LPA_LPB", "LPB_G", "G_X")]
        assert found == pytest.approx(peaks_per_unit(waves, 0.5, 20_000).tolist(), rel=1e-10)
        assert found[3] == pytest.approx(lpb_g, abs=5e-5)
        assert found[2] == pytest.approx(lpa_lpb, abs=5e-5)

    def test_library_has_the_same_faults(self):
        record = SSR.simulate("T_LPB_G", scenario="two_phases", sampling_rate=4e4)
        assert per_unit(record, "T_LPB_G") == pytest.approx(2.8400, abs=5e-5)
        assert [str(one) for one in record.events] == ["0 s: G short circuit of 2 phases"]

    @pytest.mark.parametrize(
        ("entries", "crest"),
        [
            ({"phases": 3}, 1 / 0.2),
            ({"phases": 2}, 3 * sqrt(3) / 4 / 0.2),
            ({"angle": "120 deg"}, 3 * sqrt(3) / 2 / 0.2),
            ({"angle": "90 deg"}, (1 + sqrt(2)) / 0.2),
        ],
    )
    def test_crests_without_decay(self, entries, crest):
        """(1 + sqrt 2)/x at 90 degrees: 2 sin 45 (1 + cos 45)/x."""
        history = fault(**entries, x=0.125, x_external=0.075).torque(Values({}), 1.0, 50.0)
        assert np.abs(history.samples(50e3 * 18, 20_000)).max() == pytest.approx(crest, rel=1e-6)

    def test_torque_begins_at_zero_and_brakes(self):
        for entries in ({"phases": 2}, {"phases": 3}, {"angle": "120 deg"}):
            values = fault(**entries).torque(Values({}), 1.0, 50.0).samples(1e5, 200)
            assert values[0] == pytest.approx(0, abs=1e-12)
            assert values[50:].min() < values[:2].min() <= 0

    def test_decays_are_those_of_the_definition(self):
        history = fault(phases=2, at=0.1, decay=0.4, decay_double=0.2).torque(Values({}), 3.0, 50.0)
        t = np.arange(4000) / 1e4
        s, w = t - 0.1, 100 * pi
        wanted = -3 / 0.135 * (np.exp(-s / 0.4) * np.sin(w * s) - np.exp(-s / 0.2) * np.sin(2 * w * s) / 2)
        assert history.samples(1e4, 4000) == pytest.approx(np.where(s < -1e-9, 0, wanted), abs=1e-10)
        history = fault(angle="-60 deg", decay=0.4).torque(Values({}), 3.0, 50.0)
        wanted = (
            -3 / 0.135 * (np.sin(-pi / 3) - np.exp(-t / 0.4) * (np.sin(w * t - pi / 3) - np.sin(w * t)))
        )  # the synchronising torque of a rotor that keeps its angle stays
        assert history.samples(1e4, 4000) == pytest.approx(wanted, abs=1e-10)

    def test_it_acts_on_top_of_the_torque_before(self):
        """From the load, all shafts of the free machine carry their mean torques until the fault."""
        loaded = tn.Drivetrain(
            "set", SSR.elements.values(), parameters={name: str(one.value) for name, one in SSR.parameter_definitions.items()},
            sensors={"T": {"torque": "LPB_G"}},
            operating_point={"speed": {"generator": "3600 rpm"}, "torque": {"lpa": "1 MN*m", "generator": "-1 MN*m"}},
        )  # fmt: skip
        record = loaded.simulate(scenario=fault(phases=3, at=0.05, duration=0.3, rate=1e4))
        alone = loaded.simulate(scenario=fault(phases=3, at=0.05, duration=0.3, rate=1e4, start="rest"))
        assert record["T"].values[:500] == pytest.approx(1e6, rel=1e-9)
        assert record["T"].values - 1e6 == pytest.approx(alone["T"].values, abs=1e-3)
        assert record["torque on generator"].values[0] == -1e6

    def test_generator_on_a_grid_knows_its_rating(self):
        data = {"rated_power": "555 MW", "speed": "3600 rpm", "grid_frequency": "60 Hz", "inertia_constant": "3.5 s"}
        machine = tn.GridGenerator("G", node="rotor", synchronising_coefficient=0.757, **data)
        plant = tn.Drivetrain(
            "plant", [machine], scenarios={"f": {"type": "short_circuit", "machine": "G", "phases": 3, "x": 0.2}}
        )
        record = plant.simulate("rotor", scenario="f", sampling_rate=2.4e4)
        assert np.abs(record.signals[0].values).max() == pytest.approx(5 * 555e6 / (120 * pi), rel=1e-9)


OMEGA = 2 * pi * 50 / 2
"""Synchronous speed in rad/s of two pole pairs on 50 Hz."""


class TestFaultySynchronisation:
    """Against scipy for equations written here, in rotor (J = 40), turbine or stator (J = 90), spring and damper."""

    J, K, C, X = (40.0, 90.0), 2e6, 300.0, 0.3
    OUTPUTS = ("angle(g)", "velocity(b)", "velocity(g)")

    def onto(self, **entries):
        given = {"machine": "G", "x": 0.2, "x_external": 0.1, "rated_torque": "5 kN*m", "frequency": "50 Hz"}
        return ShortCircuitScenario(**given | {"pole_pairs": 2, "duration": 0.4, "rate": 1e3} | entries)

    def set_of_two(self, **entries):
        elements = [
            tn.Inertia("G", node="g", inertia=self.J[0]), tn.Inertia("B", node="b", inertia=self.J[1]),
            tn.Spring("shaft", nodes=("g", "b"), stiffness=self.K, damping=self.C),
        ]  # fmt: skip
        return tn.Drivetrain("set", elements, **entries)

    def integrated(self, delta, at=0.0, decay=np.inf, start=(0, 0, 0, 0), grid=0.0, driven=0.0, ground=0.0, sign=0.0):
        """Angles and speeds of both masses and the air-gap torque; the grid turns at ``grid`` rad/s, mass b takes
        ``driven`` N m and a spring to ground. With ``sign`` -1 it is a stator, on which the air-gap torque reacts."""
        w, t = 100 * pi, np.arange(401) / 1e3

        def torque(s, y, first):
            if first is None:
                return 0.0 * s
            angle = delta + 2 * (y[0] + sign * y[1] - first - grid * (s - at))
            wave = np.sin(w * (s - at) + delta) - np.sin(w * (s - at))
            return 5e3 / self.X * (np.sin(angle) - np.exp(-(s - at) / decay) * wave)

        def rates(s, y, first):
            shaft = (self.K * (y[0] - y[1]) if sign == 0 else 0) + self.C * (y[2] - y[3])
            gap = torque(s, y, first)
            return [y[2], y[3], (-gap - shaft - driven) / self.J[0],
                    (shaft + driven - sign * gap - ground * y[1]) / self.J[1]]  # fmt: skip

        def solve(begin, end, state, first, times):
            return scipy.integrate.solve_ivp(
                rates, (begin, end), state, "DOP853", times, args=(first,), rtol=1e-11, atol=1e-12, max_step=2e-3
            ).y

        before, after = t[t < at - 1e-9], t[t >= at - 1e-9]
        states = [solve(0, at, start, None, [*before, at])] if at else [np.array(start, dtype=float)[:, None]]
        first = states[0][0, -1] + sign * states[0][1, -1]
        later = solve(at, 0.4, states[0][:, -1], first, after)
        return np.hstack([states[0][:, : len(before)], later]), np.r_[0 * before, torque(after, later, first)]

    def matches(self, record, wanted):
        (angle, _, speed, other), torque = wanted
        assert record["angle(g)"].values == pytest.approx(angle, abs=1e-6 * np.abs(angle).max())
        assert record["velocity(b)"].values == pytest.approx(other, abs=1e-6 * np.abs(other).max())
        assert record["velocity(g)"].values == pytest.approx(speed, abs=1e-6 * np.abs(speed).max())
        assert record["torque on g"].values == pytest.approx(-torque, abs=1e-6 * np.abs(torque).max())
        assert abs(record.energy.left_over) < 1e-6 * max(abs(record.energy.supplied), abs(record.energy.stored))

    def test_two_masses_swing_onto_the_grid(self):
        record = self.set_of_two().simulate(self.OUTPUTS, scenario=self.onto(angle="120 deg", decay=0.2))
        self.matches(record, self.integrated(2 * pi / 3, decay=0.2))
        assert "G begins at the speed of the grid" in record.notes
        assert record["angle(g)"].values.min() < -2 * pi / 3  # as far beyond the grid as it was ahead

    def test_later_and_faster_than_the_grid(self):
        first = {"g": 1.01 * OMEGA, "b": 1.012 * OMEGA}
        record = self.set_of_two().simulate(
            self.OUTPUTS, scenario=self.onto(angle="-60 deg", at=0.1), initial_state=tn.motion.MotionStart(speeds=first)
        )
        self.matches(record, self.integrated(-pi / 3, at=0.1, start=(0, 0, *first.values()), grid=OMEGA))

    def test_from_the_load_with_pole_pairs_of_speed_and_line(self):
        """From 1480 rpm, 1.3 % below the synchronous speed, under load."""
        speed = 1480 * pi / 30
        point = {"speed": {"g": speed}, "torque": {"g": -900, "b": 900}}
        record = self.set_of_two(operating_point=point).simulate(
            self.OUTPUTS, scenario=self.onto(angle="90 deg", at=0.05, pole_pairs=None)
        )
        twist = 900 / self.K
        start = (record["angle(g)"].values[0], record["angle(g)"].values[0] + twist, speed, speed)
        states, torque = self.integrated(pi / 2, at=0.05, start=start, grid=OMEGA, driven=900.0)
        self.matches(record, (states, torque + 900))
        assert "G begins 1.33 % slower than the grid" in record.notes

    @pytest.mark.parametrize("start", ["rest", "given"])
    def test_backwards_is_the_mirror_image(self, start):
        turning = (
            {"initial_state": tn.motion.MotionStart(speeds={"g": -OMEGA, "b": -OMEGA})} if start == "given" else {}
        )
        record = self.set_of_two(operating_point={"speed": {"g": -1.002 * OMEGA}}).simulate(
            self.OUTPUTS, scenario=self.onto(angle="50 deg", decay=0.1, start="rest"), **turning
        )
        first, grid = (OMEGA, OMEGA) if turning else (0, -0.002 * OMEGA)
        states, torque = self.integrated(5 * pi / 18, decay=0.1, start=(0, 0, first, first), grid=grid)
        self.matches(record, (-states, -torque))

    def test_stator_that_gives_way(self):
        elements = [
            tn.Inertia("J_g", node="g", inertia=self.J[0]), tn.Inertia("J_b", node="b", inertia=self.J[1]),
            tn.Spring("feet", nodes=("b", "ground"), stiffness=5e5), tn.Damper("air", nodes=("g", "b"), damping=self.C),
        ]  # fmt: skip
        machine = {
            "G": {
                "type": "electric_machine",
                "node": "g",
                "stator": "b",
                "pole_pairs": 2,
                "orders": {1: {"amplitude": 1}},
            }
        }
        rig = tn.Drivetrain("set on feet", elements, excitations=machine)
        record = rig.simulate(
            ["angle(g)", "velocity(b)", "velocity(g)"], scenario=self.onto(angle="100 deg", pole_pairs=None)
        )
        (angle, _, _, other), torque = self.integrated(5 * pi / 9, ground=5e5, sign=-1.0)
        assert record["angle(g)"].values == pytest.approx(angle, abs=1e-6)
        assert record["velocity(b)"].values == pytest.approx(other, abs=1e-6)
        assert record.signals[0].values == pytest.approx(-torque, rel=1e-6, abs=0.01)

    def test_heavy_rotor_feels_a_torque_that_stays(self):
        """The crest of 120 degrees at the first instants, and sin(delta)/x in the end."""
        rig = tn.Drivetrain("heavy", [tn.Inertia("G", node="g", inertia=1e12)])
        torque = rig.simulate("g", scenario=self.onto(angle="120 deg", rate=9e3))["torque on g"].values * self.X / 5e3
        assert np.abs(torque).max() == pytest.approx(3 * sqrt(3) / 2, rel=1e-6)
        torque = rig.simulate("g", scenario=self.onto(angle="120 deg", decay=0.01))["torque on g"].values * self.X / 5e3
        assert torque[-1] == pytest.approx(-sqrt(3) / 2, rel=1e-6)

    def test_comes_to_rest_on_the_grid(self):
        """A damper winding takes the swings: the angle of 60 degrees, electrical, is gone, and so is the torque."""
        elements = [tn.Inertia("G", node="g", inertia=20), tn.Damper("winding", nodes=("g", "ground"), damping=900)]
        record = tn.Drivetrain("damped", elements).simulate(
            "angle(g)", scenario=self.onto(angle="60 deg", decay=0.05, duration=1.2, rate=100)
        )
        assert record["angle(g)"].values[-1] == pytest.approx(-pi / 6, abs=1e-6)
        assert record["torque on g"].values[-1] == pytest.approx(0, abs=0.05)

    def test_what_cannot_be_synchronised_is_refused(self):
        with pytest.raises(tn.UsageError, match=r"(?s)pole_pairs: 1.*missing-entry"):
            self.set_of_two().simulate("g", scenario=self.onto(angle="60 deg", pole_pairs=None))
        far = self.set_of_two(operating_point={"speed": {"g": "1000 rpm"}})
        assert far.simulate("g", scenario=self.onto(angle="60 deg", pole_pairs=None, duration=0.01)) is not None
        off = self.set_of_two(operating_point={"speed": {"g": "1200 rpm"}})
        with pytest.raises(tn.UsageError, match=r"(?s)pole_pairs: 1.*missing-entry"):
            off.simulate("g", scenario=self.onto(angle="60 deg", pole_pairs=None))
        machine = tn.SynchronousMachine("M", node="g", stiffness=1e4)
        tied = self.set_of_two()
        tied = tn.Drivetrain("tied", [*tied.elements.values(), machine])
        with pytest.raises(tn.UsageError, match=r"(?s)M .*rated_torque.*missing-entry"):
            tied.simulate("g", scenario=self.onto(angle="60 deg"))
        with pytest.raises(tn.ModelError, match="leave out pole_pairs"):
            self.onto(phases=2)


class TestTorques:
    def rig(self, **entries):
        elements = [
            tn.Inertia("engine", node="a", inertia=0.3), tn.Spring("shaft", nodes=("a", "b"), stiffness=900, damping=0.4),
            tn.Inertia("wheel", node="b", inertia=2.0),
        ]  # fmt: skip
        return tn.Drivetrain("rig", elements, sensors={"T": {"torque": "shaft"}, "n": {"velocity": "a"}}, **entries)

    def integrated(self, torque, t, state=(0, 0, 0, 0), brake=0.0):
        def rate(time, y):
            shaft = 900 * (y[0] - y[1]) + 0.4 * (y[2] - y[3])
            return [y[2], y[3], (torque(time) - shaft) / 0.3, (shaft - brake) / 2]

        return scipy.integrate.solve_ivp(rate, (0, t[-1]), state, "DOP853", t, rtol=1e-11, atol=1e-12, max_step=2e-3).y

    def test_ramp_from_the_operating_point(self):
        scenario = {"type": "torques", "duration": "0.4 s", "rate": "1 kHz", "start": "operating_point",
                    "torque": {"a": {"0 s": "20 N*m", "50 ms": "250 N*m"}}}  # fmt: skip
        rig = self.rig(scenarios={"tip_in": scenario}, operating_point={"torque": {"a": 20, "b": -20}})
        record, t = rig.simulate(scenario="tip_in"), np.arange(401) / 1e3
        y = self.integrated(lambda s: np.interp(s, [0, 0.05], [20, 250]), t, (20 / 900, 0, 0, 0), 20.0)
        shaft = 900 * (y[0] - y[1]) + 0.4 * (y[2] - y[3])
        assert record["T"].values == pytest.approx(shaft, abs=2e-7)
        assert record["n"].values == pytest.approx(y[2], abs=2e-7)

    def test_torques_out_of_balance_begin_in_steady_acceleration(self):
        """The shaft carries J_b/(J_a + J_b) of the torque, without vibration."""
        scenario = TorqueScenario(duration=0.2, rate=1e3, start="operating_point", torque={"a": 23})
        record = self.rig().simulate(scenario=scenario)
        assert record["T"].values == pytest.approx(np.full(201, 20.0), rel=1e-9)
        assert np.diff(record["n"].values) == pytest.approx(np.full(200, 10e-3), rel=1e-9)
        assert "steady acceleration" in record.notes[0]

    def test_sinusoid_and_step_between_samples_are_exact(self):
        at = 0.12345
        torque = {"a": {"mean": 4, "amplitude": 6, "frequency": "10 Hz", "phase": "30 deg"},
                  "b": [[at, 0], [at, 5]]}  # fmt: skip
        record, t = (
            self.rig().simulate(scenario=TorqueScenario(duration=0.4, rate=500, torque=torque)),
            np.arange(201) / 500,
        )
        A = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [-3000, 3000, -4 / 3, 4 / 3], [450, -450, 0.2, -0.2]])
        drive = np.zeros((8, 8))
        drive[:4, :4], drive[2, 4], drive[2, 5], drive[3, 7] = A, 1 / 0.3, 1 / 0.3, 1 / 2
        drive[5, 6], drive[6, 5] = -20 * pi, 20 * pi  # 6 cos, 6 sin
        drive[4:, :4] = 0
        z = np.array([0, 0, 0, 0, 4, 6 * np.cos(pi / 6), 6 * np.sin(pi / 6), 0])
        before = [scipy.linalg.expm(drive * s) @ z for s in t if s < at]
        z = scipy.linalg.expm(drive * at) @ z
        z[7] = 5
        found = np.array([*before, *(scipy.linalg.expm(drive * (s - at)) @ z for s in t if s >= at)])
        assert record["T"].values == pytest.approx(
            900 * (found[:, 0] - found[:, 1]) + 0.4 * (found[:, 2] - found[:, 3]), abs=1e-9
        )

    def test_a_table_read_beyond_its_rows_is_noted(self):
        scenario = {"type": "torques", "duration": "0.1 s", "rate": "2 kHz", "torque": {"a": "10 N*m"}}
        bush = tn.TabulatedSpring("bush", nodes=("a", "ground"), table=[[0, 8e4, 40], [600, 9e4, 40]])
        rig = tn.Drivetrain("bush", [tn.Inertia("J", node="a", inertia=2), bush], scenarios={"step": scenario})
        notes = rig.simulate("a", scenario="step").notes
        assert (
            "bush: the rows of its table go from 0 to 600 Hz, and it is read at up to 1000 Hz, where the last row is kept"
            in notes
        )

    def test_parameters_vary_in_a_study(self):
        scenario = {"type": "torques", "duration": "0.3 s", "rate": "10 kHz", "torque": {"a": "T_1"}}
        rig = tn.Drivetrain(
            "one mass", [tn.Inertia("J", node="a", inertia=2), tn.Spring("k", nodes=("a", "ground"), stiffness=8e4)],
            parameters={"T_1": "10 N*m"}, scenarios={"step": scenario},
        )  # fmt: skip
        quantity = ScenarioPeak(scenario="step", output="torque(k)")
        assert list(quantity.model_faults(rig, {})) == []
        found = quantity.evaluate(VariantBlock(rig, {"T_1": np.array([10.0, 25.0])}, {}, None))
        assert found[:, 0] == pytest.approx([20, 50], rel=1e-4)
        (wrong,) = ScenarioPeak(scenario="stop", output="torque(k)").model_faults(rig, {})
        assert 'did you mean "step"' in wrong.message

    def test_clearance_moves_in_full(self):
        """A rotor in a gap meets its wall: J v = T t until the gap is closed."""
        elements = [
            tn.Inertia("J", node="a", inertia=0.5),
            tn.Clearance("gap", nodes=("a", "ground"), gap=0.2, stiffness=1e4),
        ]
        scenario = TorqueScenario(duration=0.4, rate=1e4, torque={"a": 5})
        record = tn.Drivetrain("rotor", elements).simulate(["a", "torque(gap)"], scenario=scenario)
        assert record.events[0].time == pytest.approx(sqrt(2 * 0.1 / 10), rel=1e-9)
        assert record["torque(gap)"].values.max() == pytest.approx(5 + sqrt(25 + 2 * 5 * 0.1 * 1e4), rel=1e-3)

    def test_entries_give_a_scenario_and_motions_alone_are_read(self):
        entries = {
            "type": "torques",
            "duration": 0.1,
            "rate": 1e3,
            "start": "operating_point",
            "torque": {"a": 20, "b": -20},
        }
        record = self.rig().simulate(["n", "a"], scenario=entries)
        assert np.abs(record["n"].values).max() < 1e-12
        assert "mean torques at the start" in record.notes[0]


class TestHistories:
    def test_sum_of_pieces_is_the_sum_of_values(self):
        one = straight([(0.1, 2.0), (0.3, 6.0), (0.3, -1.0)])
        two = TimeHistory((HistoryPiece(0.0, 1.0), HistoryPiece(0.22, 0.5, 2.0, (Wave(2 - 1j, -3 + 40j),))))
        total = (one + two).samples(1e3, 500)
        assert total == pytest.approx(one.samples(1e3, 500) + two.samples(1e3, 500), abs=1e-12)
        assert total[300] - total[299] < -6

    @pytest.mark.parametrize(
        "entry",
        [
            "20 N*m",
            {"0 s": "20 N*m", "0.05 s": "T_1"},
            [["0.1 s", "0 N*m"], ["0.1 s", "5 N*m"]],
            {"mean": "3 N*m", "amplitude": "2 N*m", "frequency": "10 Hz"},
        ],
    )
    def test_written_scenarios_are_read_again(self, entry, tmp_path):
        scenarios = {"s": {"type": "torques", "duration": "1 s", "torque": {"a": entry}}}
        rig = tn.Drivetrain(
            "rig", [tn.Inertia("J", node="a", inertia=1)], parameters={"T_1": "2 N*m"}, scenarios=scenarios
        )
        path = tmp_path / "rig.yaml"
        rig.to_yaml(path)
        again = tn.load(path)
        assert again == rig
        assert again.definition.to_data()["scenarios"] == rig.definition.to_data()["scenarios"]


BAD = """\
torsionnet: 1
name: bad
elements:
  A: {type: inertia, node: a, inertia: 1 kg*m^2}
  k: {type: spring, nodes: [a, ground], stiffness: 1 kN*m/rad}
scenarios:
"""


@pytest.mark.parametrize(
    ("line", "marked", "kind"),
    [
        ("{type: torques, duration: 2 s, torque: {aa: 3 N*m}}", "aa", "unknown-node"),
        ("{type: torques, duration: 2 s, torque: {a: {5 ms: 1, 1 ms: 2}}}", "1 ms", "unordered-rows"),
        ("{type: torques, duration: 2 s, torque: {a: {5 ms: 3 kg}}}", "3 kg", "wrong-unit"),
        (
            "{type: torques, duration: 2 s, torque: {a: {amplitude: 2 N*m}}}",
            "a: {amplitude",
            "missing-entry",
        ),
        ("{type: torques, torque: {a: 2 N*m}}", "s:", "missing-entry"),
        ("{type: torques, duration: 2 s}", "s:", "missing-entry"),
        ("{type: torques, duration: 2 s, torque: {a: T}}", "T}}", "unknown-parameter"),
        ("{type: torques, duration: 2 s, torque: {a: 1}, k: {clamp: 2}}", "clamp", "unknown-word"),
        ("{type: torques, duration: 2 s, torque: {a: 1}, kk: {clamp: 2}}", "kk", "unknown-element"),
        ("{type: short_circuit, phases: 3, x: 0.2}", "s:", "missing-entry"),
        ("{type: short_circuit, machine: B, phases: 3, x: 0.2}", "B", "unknown-name"),
        ("{type: short_circuit, machine: A, phases: 3, x: 0.2, frequency: 50 Hz}", "s:", "missing-entry"),
        ("{type: short_circuit, machine: A, x: 0.2}", "s:", "missing-entry"),
        ("{type: short_circuit, machine: A, phases: 3, x: -1}", "-1", "out-of-range"),
        ("{type: short_circuit, machine: A, angle: 200 deg, x: 0.1}", "200 deg", "out-of-range"),
        ("{type: sudden, x: -1}", "sudden", "unknown-word"),
        ("{type: torques, duration: 2 s, torque: {a: {5 ms: 1, 5 ms: 2}}}", "5 ms: 2", "repeated-name"),
        ("{type: torques, duration: 2 s, torque: {a: {-5 ms: 1}}}", "-5 ms", "out-of-range"),
        ("{type: torques, duration: 2 s, torque: {a: {5 kg: 1}}}", "5 kg", "wrong-unit"),
        ("{type: torques, duration: 2 s, torque: {a: [[5 ms, 1, 2]]}}", "[5 ms", "wrong-form"),
        ("{type: torques, duration: 2 s, torque: {ground: 1}}", "ground", "grounded-node"),
        ("{type: short_circuit, machine: A, phases: 4, x: 0.2}", "4, x", "out-of-range"),
        ("{type: short_circuit, machine: A, phases: 2, angle: 90 deg, x: 0.2}", "s:", "missing-entry"),
        ("{type: short_circuit, machine: A, phases: 3, x: 0}", "0}", "out-of-range"),
        ("{type: short_circuit, machine: A, phases: 3, x: 1, decay_double: 1 s}", "decay_double", "needless-entry"),
        ("{type: short_circuit, machine: A, phases: 3, x: 1, at: 2 s, duration: 1 s}", "1 s}", "needless-entry"),
        ("{type: short_circuit, machine: k, phases: 3, x: 1}", "k,", "not-applicable"),
        ("{type: short_circuit, machine: a, phases: 3, x: 1}", "a,", "unknown-element"),
    ],
)
def test_faults_have_their_place(line, marked, kind, tmp_path):
    """The column is that of what is marked."""
    column = f"  s: {line}".index(marked) + 1
    (tmp_path / "bad.yaml").write_text(f"{BAD}  s: {line}\n", encoding="utf-8")
    with pytest.raises(tn.ModelError) as caught:
        tn.load(tmp_path / "bad.yaml")
    found = [(fault.position.line, fault.position.column, fault.kind) for fault in caught.value.faults]
    assert (7, column, kind) in found


def test_unknown_scenario_and_other_inputs_are_refused():
    with pytest.raises(tn.UsageError, match="there are three_phases"):
        SSR.simulate(scenario="none")
    with pytest.raises(tn.UsageError, match=r'(?s)"T_9".*"T_0".*unknown-parameter'):
        SSR.simulate(scenario=fault(phases=3, rated_torque="T_9"))
    with pytest.raises(tn.ModelError, match="needs duration"):
        SSR.simulate(scenario={"type": "torques", "torque": {"hp": 3}})
    with pytest.raises(tn.UsageError, match="brings its own torques"):
        SSR.simulate("T_G_X", {"T_G": [0, 1]}, scenario="two_phases")
    with pytest.raises(tn.UsageError, match="needs output, input"):
        SSR.simulate("T_G_X")


def test_command_prints_peaks_and_writes_files(tmp_path):
    options = (
        "--output",
        "T_LPB_G",
        "--sampling-rate",
        "4 kHz",
        "--plot",
        tmp_path / "f.svg",
        "-o",
        tmp_path / "f.csv",
    )
    shown = run("simulate", "turbine_generator_ssr", "two_phases", *options).stdout
    assert "short circuit of 2 phases of G at 0 s" in shown
    assert read_recording(tmp_path / "f.csv")["T_LPB_G"].unit == "N*m"
    assert "events" not in (tmp_path / "f.svg").read_text(encoding="utf-8")[:20]
    (record,) = json.loads(run("simulate", "turbine_generator_ssr", "two_phases", *options[:4], "--json").stdout)
    assert record["events"] == [{"time_s": 0.0, "element": "G", "what": "short circuit of 2 phases"}]
    assert record["peaks"][-1]["signal"] == "T_LPB_G"
    assert "no scenario" in run("simulate", "turbine_generator_ssr", "one", code=2).stderr
