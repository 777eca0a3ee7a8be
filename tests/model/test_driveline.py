"""Clutch, gearbox, final drive, tyre and vehicle against closed forms, and against the same things built of parts."""

from functools import cache

import numpy as np
import pytest
from support.front_wheel_drive_car import components, springs_and_gears

import torsionnet as tn

CASES = [
    f"gear={gear},clutch={clutch}" for gear in ("I", "II", "III", "IV", "V", "VI", "N") for clutch in ("closed", "open")
]


@cache
def cars():
    return tn.loads(components()), tn.loads(springs_and_gears())


class TestCar:
    """The plant by its components, and as it was written with gears, inertias and rigid couplings."""

    @pytest.mark.few(2)
    @pytest.mark.parametrize("case", CASES)
    def test_modes_and_responses_are_the_same(self, case):
        ours, theirs = (car.configured(case) for car in cars())
        modes, expected = ours.modes(), theirs.modes()
        scale = abs(expected.eigenvalues).max()
        np.testing.assert_allclose(modes.eigenvalues, expected.eigenvalues, rtol=1e-12, atol=1e-14 * scale)
        frequencies = np.geomspace(0.5, 500, 60)
        for source in ("T_E", "T_block"):
            for sensor in ("n_prim", "a_sec", "T_hl", "T_hr", "a_veh", "roll"):
                found, wanted = (car.frequency_response(sensor, source, frequencies).values for car in (ours, theirs))
                np.testing.assert_allclose(found, wanted, rtol=1e-12, atol=1e-12 * abs(wanted).max())

    def test_ratios(self):
        assert cars()[0].configured("gear=II").ratio_between("inp", "cage") == pytest.approx(1.958 * 3.45, rel=1e-14)
        assert cars()[0].configured("gear=VI").ratio_between("inp", "cage") == pytest.approx(0.717 * 2.76, rel=1e-14)

    def test_a_loose_wheel_runs_along(self):
        """Wheel VI in gear I, with the block at rest on average: as fast as the input over 0.717."""
        assert cars()[0].configured("gear=I").ratio_between("high.VI", "inp") == pytest.approx(-1 / 0.717, rel=1e-14)


def pair(clutch, damping=0):
    """Two masses with the clutch in between; the second on a damper to ground."""
    return tn.Drivetrain(
        "pair",
        [
            tn.Inertia("one", node="a", inertia=2),
            clutch,
            tn.Inertia("two", node="b", inertia=3),
            tn.Spring("shaft", nodes=("b", "ground"), stiffness=4800, damping=damping),
        ],
        inputs={"T": {"torque": "a"}},
        sensors={"w": {"velocity": "b"}, "through": {"torque": "clutch"}},
    )


class TestClutch:
    TABLE = ([0, 200], [10, 190], [30, 220])

    @pytest.mark.parametrize(("slip", "slope"), [(5, -1.0), (-5, -1.0), (10, 1.5), (30, 1.5), ("100 rpm", 1.5)])
    def test_the_slope_of_the_table_damps(self, slip, slope):
        clutch = tn.Clutch("clutch", nodes=("a", "b"), state="slipping", slip_speed=slip, torque=self.TABLE)
        damper = tn.Clutch("clutch", nodes=("a", "b"), state="open", drag=abs(slope))
        poles = np.roots([2 * 3, slope * 5, 2 * 4800, slope * 4800])
        found = pair(clutch).modes().eigenvalues
        for pole in poles[poles.imag >= 0]:
            assert min(abs(found - pole)) < 1e-10 * max(abs(pole), 1)
        if slope > 0:
            np.testing.assert_allclose(pair(damper).modes().eigenvalues, found, rtol=1e-12, atol=1e-12)

    def test_falling_friction_makes_a_mode_unstable_and_is_noted(self):
        falling = {"state": "slipping", "friction": [[0, 0.14], [20, 0.10]], "clamp_torque": 1500}
        rig = pair(tn.Clutch("clutch", nodes=("a", "b"), slip_speed=4, **falling), damping=2)
        slope = -0.04 / 20 * 1500
        poles = np.roots([6, 2 * (slope + 2) + 3 * slope, 2 * 4800 + 2 * slope, slope * 4800])
        assert max(pole.real for pole in poles if pole.imag > 1) > 0
        found = rig.modes().eigenvalues
        for pole in poles[poles.imag >= 0]:
            assert min(abs(found - pole)) < 1e-10 * max(abs(pole), 1)
        (note,) = [fault for fault in rig.check() if "drives vibrations" in fault.message]
        assert (note.severity, note.path) == ("note", ("elements", "clutch"))

    def test_closed_it_is_rigid_or_the_springs_of_its_disc(self):
        rigid = pair(tn.Clutch("clutch", nodes=("a", "b"), first_inertia=0.5, disc_inertia=0.25))
        assert max(rigid.modes().natural_frequencies) == pytest.approx(np.sqrt(4800 / 5.75) / (2 * np.pi), rel=1e-12)
        soft = pair(tn.Clutch("clutch", nodes=("a", "b"), stiffness=900, first_inertia=0.5, disc_inertia=0.25))
        squares = np.linalg.eigvals(np.array([[900 / 2.75, -900 / 2.75], [-900 / 3, 5700 / 3]]))
        expected = np.sort(np.sqrt(squares)) / (2 * np.pi)
        np.testing.assert_allclose(np.sort(soft.modes().natural_frequencies), expected, rtol=1e-12)

    def test_open_it_passes_nothing_on(self):
        rig = pair(tn.Clutch("clutch", nodes=("a", "b"), state="open", stiffness=900))
        assert abs(rig.frequency_response("w", "T", [1.0, 9.0]).values).max() == 0

    @pytest.mark.parametrize(
        ("entries", "words"),
        [
            (
                {"state": "slipping", "torque": TABLE[1:]},
                r"elements\.clutch\.torque\.0\.0: .*unfit-curve",
            ),
            ({"state": "slipping", "torque": [[0, -1], [2, 1]]}, r"elements\.clutch\.torque\.0\.1: .*unfit-curve"),
            (
                {"state": "slipping", "torque": TABLE, "slip_speed": 0},
                r"elements\.clutch\.slip_speed: .*contradicting-values",
            ),
            ({"state": "slipping", "slip_speed": 5}, r"elements\.clutch\.state: .*missing-entry"),
            (
                {"state": "slipping", "slip_speed": 31, "torque": TABLE},
                r"elements\.clutch\.slip_speed: .*contradicting-values",
            ),
            ({"torque": TABLE, "friction": TABLE}, r"elements\.clutch\.friction: .*contradicting-entries"),
            ({"friction": TABLE}, r"elements\.clutch\.friction: .*missing-entry"),
            ({"damping": 3}, r"elements\.clutch\.damping: .*missing-entry"),
            ({"torque": [[3, 1], [2, 1]]}, r"elements\.clutch\.torque\.1\.0: .*unordered-rows"),
            ({"state": "shut"}, r"elements\.clutch\.state: .*unknown-word"),
        ],
    )
    def test_what_is_wrong_is_said(self, entries, words):
        with pytest.raises(tn.ModelError, match=words):
            tn.Clutch("clutch", nodes=("a", "b"), **entries)

    def test_a_configuration_lets_it_slip(self):
        text = """torsionnet: 1
elements:
  one: {type: inertia, node: a, inertia: 2}
  clutch: {type: clutch, nodes: [a, b], torque: [[0 rad/s, 200 N*m], [10 rad/s, 190 N*m], [30 rad/s, 220 N*m]]}
  two: {type: inertia, node: b, inertia: 3}
configurations: {clutch: {closed: {}, slipping: {clutch.state: slipping%s}}}
"""
        slipping = tn.loads(text % ", clutch.slip_speed: 20 rad/s").configured("slipping")
        assert min(slipping.modes().eigenvalues.real) == pytest.approx(-1.5 * (1 / 2 + 1 / 3), rel=1e-12)
        with pytest.raises(tn.ModelError, match=r":6:93: .*contradicting-values"):
            tn.loads(text % ", clutch.slip_speed: 0")


class TestGearbox:
    RATIOS = {"I": -4, "II": -2, "III": 1.25}  # noqa: RUF012
    WHEELS = {"I": 0.4, "II": 0.3, "III": 0.2}  # noqa: RUF012

    def box(self, engaged, **entries):
        box = tn.Gearbox(
            "box", input="a", output="b", ratios=self.RATIOS, wheel_inertias=self.WHEELS, engaged=engaged, **entries
        )
        return tn.Drivetrain(
            "box",
            [
                tn.Inertia("one", node="a", inertia=1),
                tn.Spring("in", nodes=("a", "ground"), stiffness=700),
                box,
                tn.Inertia("two", node="b", inertia=5),
            ],
            inputs={"T": {"torque": "a"}},
            sensors={"phi": {"angle": "a"}, "out": {"angle": "b"}, "wheel": {"angle": "box.III"}},
        )

    @pytest.mark.parametrize("engaged", ["I", "II", "III", "neutral"])
    @pytest.mark.parametrize("side", ["input", "output"])
    def test_inertia_felt_at_the_input(self, engaged, side):
        """Loose wheels turn with the shaft that meshes with them."""
        reflected = 0.0
        for gear, tau in self.RATIOS.items():
            at_output = self.WHEELS[gear] * tau**2
            if engaged == "neutral":
                reflected += self.WHEELS[gear] / tau**2 if side == "output" else 0
            elif side == "output":
                reflected += self.WHEELS[gear] / tau**2
            else:
                reflected += at_output / self.RATIOS[engaged] ** 2
        reflected += 5 / self.RATIOS[engaged] ** 2 if engaged != "neutral" else 0
        found = max(self.box(engaged, loose_wheels=side).modes().natural_frequencies)
        assert found == pytest.approx(np.sqrt(700 / (1 + reflected)) / (2 * np.pi), rel=1e-12)

    def test_elastic_mesh_of_a_loose_wheel_has_a_mode_of_its_own(self):
        """In neutral the wheels hang on the input shaft: one mass 1 on 700, one of 0.2 behind the teeth."""
        rig = self.box("neutral", stiffness={"III": 9000})
        mass = 1 + 0.4 / 16 + 0.3 / 4
        stiffness = np.array([[700 + 9000, -1.25 * 9000], [-1.25 * 9000, 1.25**2 * 9000]])
        squares = np.linalg.eigvals(stiffness / np.array([[mass], [0.2]]))
        expected = np.sort(np.sqrt(squares)) / (2 * np.pi)
        np.testing.assert_allclose(np.sort(rig.modes().natural_frequencies)[-2:], expected, rtol=1e-12)

    def test_neutral_uncouples(self):
        assert self.box("neutral").frequency_response("out", "T", [1.0]).values == 0

    def test_ratios_may_be_expressions_and_teeth(self):
        by_teeth = tn.Gearbox("box", input="a", output="b", teeth={"I": [13, -49]}, engaged="I")
        assert by_teeth.engaged_ratio({}) == tn.Gear("g", nodes=("a", "b"), teeth=(13, -49)).ratio_value({})
        by_name = tn.Gearbox("box", input="a", output="b", ratios={"I": "2*i"}, engaged="I")
        assert by_name.engaged_ratio({"i": 3}) == 6

    @pytest.mark.parametrize(
        ("entries", "where", "words"),
        [
            ("ratios: {I: 4, II: 2}, engaged: VI", "4:77", r":4:77: .*unknown-name"),
            ("ratios: {I: 4, II: 0}, engaged: I", "4:64", r":4:64: .*out-of-range"),
            ("ratios: {I: 4, II: 3 kg}", "4:64", r":4:64: .*wrong-unit"),
            ("engaged: I", "4:3", r":4:3: .*missing-entry"),
            ("ratios: {I: 4}, teeth: {I: [1, 4]}", "4:61", "contradicting-entries"),
            ("ratios: {I: 4}, wheel_inertias: {II: 4}", "4:78", r":4:78: .*unknown-name"),
            ("ratios: {I: 4}, damping: 4", "4:70", r":4:70: .*missing-entry"),
        ],
    )
    def test_what_is_wrong_is_said_where_it_stands(self, entries, where, words):
        text = f"""torsionnet: 1
elements:
  one: {{type: inertia, node: a, inertia: 2}}
  box: {{type: gearbox, input: a, output: b, {entries}}}
  two: {{type: inertia, node: b, inertia: 3}}
"""
        with pytest.raises(tn.ModelError, match=words) as caught:
            tn.loads(text, file="box.yaml")
        assert f"box.yaml:{where}: error: " in str(caught.value)


class TestFinalDrive:
    def axle(self, **entries):
        return tn.Drivetrain(
            "axle",
            [
                tn.Inertia("engine", node="p", inertia=1),
                tn.FinalDrive("axle", pinion="p", left="l", right="r", ratio=-3, cage_inertia=2, **entries),
                tn.Inertia("left", node="l", inertia=4),
                tn.Inertia("right", node="r", inertia=6),
            ],
            inputs={"T": {"torque": "p"}},
            sensors={"l": {"acceleration": "l"}, "r": {"acceleration": "r"}, "cage": {"acceleration": "axle.cage"}},
        )

    def test_open_the_outputs_share_the_torque_equally(self):
        """Torque T' on each side: cage 2 a_c = a_l + a_r, 4 a_l = 6 a_r = T', -3 T = 2 T' + (2 + 9) a_c."""
        share = -3 / (2 + 11 * (1 / 4 + 1 / 6) / 2)
        values = self.axle().frequency_response(["l", "r", "cage"], "T", [2.0]).values.ravel()
        np.testing.assert_allclose(values, [share / 4, share / 6, share * 5 / 24], rtol=1e-12)

    def test_locked_all_turn_alike(self):
        values = self.axle(differential="locked").frequency_response(["l", "r"], "T", [2.0]).values.ravel()
        np.testing.assert_allclose(values, [-3 / (9 + 2 + 4 + 6)] * 2, rtol=1e-12)

    def test_limited_slip_damps_the_difference(self):
        """The difference of both speeds decays: in 4 a_l = T' - c d, 6 a_r = T' + c d with the rest free of torque."""
        rig = self.axle(differential="limited-slip", slip_damping=7)
        mass = np.array([[4 + 11 / 4, 11 / 4], [11 / 4, 6 + 11 / 4]])
        decay = np.linalg.eigvals(np.linalg.solve(mass, 7 * np.array([[1, -1], [-1, 1]]))).max()
        assert min(rig.modes().eigenvalues.real) == pytest.approx(-decay, rel=1e-12)

    @pytest.mark.parametrize(
        ("entries", "words"),
        [
            ({}, r"elements\.axle: .*missing-entry"),
            ({"ratio": 3, "teeth": (9, 31)}, "contradicting-entries"),
            ({"ratio": 3, "differential": "limited-slip"}, r"elements\.axle\.differential: .*contradicting-entries"),
            ({"ratio": 3, "slip_damping": 3}, r"elements\.axle\.slip_damping: .*contradicting-entries"),
            ({"ratio": 3, "damping": 3}, r"elements\.axle\.damping: .*missing-entry"),
            ({"ratio": 3, "cage": "l"}, r"elements\.axle\.pinion: .*same-node"),
        ],
    )
    def test_what_is_wrong_is_said(self, entries, words):
        with pytest.raises(tn.ModelError, match=words):
            tn.FinalDrive("axle", pinion="p", left="l", right="r", **entries)


class TestTyre:
    R, C, SIGMA, V = 0.31, 9e4, 0.45, 22.0

    def rig(self, **entries):
        tyre = tn.Tyre("tyre", nodes=("rim", "ground"), radius=self.R, slip_stiffness=self.C, **entries)
        return tn.Drivetrain(
            "tyre",
            [tn.Inertia("wheel", node="rim", inertia=1.1), tyre],
            inputs={"phi": {"angle": "rim"}},
            sensors={"T": {"torque": "tyre"}},
        )

    @pytest.mark.parametrize("given", ["relaxation_length", "stiffness"])
    def test_torque_lags_the_slip_by_the_relaxation_length(self, given):
        value = self.SIGMA if given == "relaxation_length" else self.C * self.R**2 / self.SIGMA
        frequencies = np.array([0.01, 1.0, 7.0, 30.0, 200.0])
        s = 2j * np.pi * frequencies
        expected = self.C * self.R**2 / self.V * s / (1 + s * self.SIGMA / self.V)
        found = self.rig(speed=self.V, **{given: value}).frequency_response("T", "phi", frequencies).values.ravel()
        np.testing.assert_allclose(found, expected, rtol=1e-12)

    def test_standing_it_is_a_spring(self):
        found = self.rig(state="standing", stiffness=8000, damping=3).frequency_response("T", "phi", [4.0]).values
        assert found == pytest.approx(8000 + 3 * 2j * np.pi * 4, rel=1e-12)

    def test_its_torque_decays_over_the_relaxation_length(self):
        """Free wheel of no inertia but the belt's: poles of J_b s + c in series with the spring."""
        free = tn.Drivetrain(
            "free",
            [
                tn.Lock("hub", node="rim"),
                tn.Tyre("tyre", nodes=("rim", "road"), radius=self.R, slip_stiffness=self.C, speed=self.V,
                        relaxation_length=self.SIGMA),
                tn.Lock("plate", node="road"),
            ],
        )  # fmt: skip
        assert free.modes().eigenvalues[0].real == pytest.approx(-self.V / self.SIGMA, rel=1e-12)

    @pytest.mark.parametrize(
        ("entries", "words"),
        [
            ({"stiffness": 5e3}, r"elements\.tyre: .*missing-entry"),
            ({"state": "standing"}, r"elements\.tyre: .*missing-entry"),
            ({"stiffness": 5e3, "relaxation_length": 1}, "contradicting-entries"),
            ({"state": "standing", "relaxation_length": 1}, r"elements\.tyre: .*missing-entry"),
            ({"stiffness": 5e3, "speed": "3 rpm"}, r"elements\.tyre\.speed: .*wrong-unit"),
        ],
    )
    def test_what_is_wrong_is_said(self, entries, words):
        with pytest.raises(tn.ModelError, match=words):
            tn.Tyre("tyre", nodes=("rim", "road"), **entries)


class TestVehicle:
    def test_air_and_road_damp_by_the_slope_of_their_force(self):
        """The derivative of rho A v^2/2 + m g (f_0 + f_1 v) by differences, at 108 km/h."""
        car = tn.Drivetrain(
            "car",
            [
                tn.Vehicle("car", node="road", mass="1.4 t", wheel_radius="30 cm", wheel_inertia=2, speed="108 km/h",
                           drag_area=0.7, air_density=1.25, rolling_slope="0.0001 s/m"),
            ],
        )  # fmt: skip

        def force(v):
            return 1.25 * 0.7 * v**2 / 2 + 1400 * 9.80665 * (0.01 + 1e-4 * v)

        slope = (force(30.5) - force(29.5)) * 0.3**2
        assert min(car.modes().eigenvalues.real) == pytest.approx(-slope / (1400 * 0.09 + 2), rel=1e-10)

    def test_drag_follows_the_operating_speed(self):
        text = """torsionnet: 1
parameters: {r: 0.3 m, n: {by: speed, of: road}}
elements:
  engine: {type: inertia, node: e, inertia: 1}
  gear: {type: gear, nodes: [e, road], ratio: 4}
  car: {type: vehicle, node: road, mass: 1000 kg, wheel_radius: 0.3 m, speed: n*r, drag_area: 0.7 m^2}
speeds: {of: e, range: 200 rad/s..500 rad/s, step: 100 rad/s, rated: 400 rad/s}
"""
        decay = 1.204 * 0.7 * 30 * 0.09 / (90 + 16)
        assert min(tn.loads(text).modes().eigenvalues.real) == pytest.approx(-decay, rel=1e-9)

    @pytest.mark.parametrize(
        ("entries", "words"), [({"speed": 3}, "give drag_area"), ({"drag_area": 3}, "give speed too")]
    )
    def test_what_is_wrong_is_said(self, entries, words):
        with pytest.raises(tn.ModelError, match=words):
            tn.Vehicle("car", node="road", mass=1000, wheel_radius=0.3, **entries)
