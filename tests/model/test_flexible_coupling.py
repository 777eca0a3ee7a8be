"""Couplings by their makers' sheets and by their material, against numbers put in by hand and published constants."""

import math

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.expressions import Number
from torsionnet.linear.sensitivity.sensitivities_of_modes import mode_sensitivities
from torsionnet.model.element_base.viscoelastic import ShearedBush, ShearedDisc, Viscoelastic
from torsionnet.model.elements import Values

RPM = np.pi / 30
SHARES = {0.25: 200, 0.5: 300, 1: 700}
MODULI = [[1, 1e6, 1e5], [10, 1.5e6, 3e5], [100, 3e6, 9e5]]
DISC = {"type": "disc", "outer_diameter": 0.4, "inner_diameter": 0.2, "thickness": 0.05}


def coupling(**given):
    return tn.FlexibleCoupling("cpl", nodes=("a", "b"), **given)


def law(values=None, **given):
    return coupling(**given).parts(Values(values or {}))[0]


def two_masses(parameters=None, **given):
    return tn.Drivetrain(
        "two masses",
        [tn.Inertia("one", node="a", inertia=2), tn.Inertia("two", node="b", inertia=3), coupling(**given)],
        parameters=parameters or {},
        inputs={"T": {"torque": "a"}},
        sensors={"theta": {"angle": "b"}, "through": {"torque": "cpl"}},
    )


class TestSheet:
    @pytest.mark.parametrize("torque", [250, 400, 500, 610, 1000])
    def test_stiffness_is_read_off_between_the_rows(self, torque):
        expected = np.interp(torque / 1000, [0.25, 0.5, 1], [200, 300, 700])
        shares = law(stiffness_over_torque=SHARES, T_KN=1000, torque=torque).stiffness
        torques = law(stiffness_over_torque={"250 N*m": 200, "0.5 kN*m": 300, "1 kN*m": 700}, torque=torque).stiffness
        percent = law(
            stiffness_over_torque={"25 %": 200, "50 %": 300, "100 %": 700}, T_KN=1000, torque=torque
        ).stiffness
        assert [shares, torques, percent] == pytest.approx([expected] * 3, rel=1e-14)

    def test_factors_multiply(self):
        found = law(
            stiffness=1000,
            T_KN=100,
            torque=50,
            vibratory_torque=10,
            temperature="60 degC",
            torque_factor={0: 1, 1: 2},
            amplitude_factor={0: 1.2, 0.2: 1},
            temperature_factor={"30 degC": 1, "80 degC": 0.5},
            damping_temperature_factor={"30 degC": 1, "80 degC": 1.5},
            loss_factor={"psi": 1.0},
        )
        assert found.stiffness == pytest.approx(1000 * 1.5 * 1.1 * 0.7, rel=1e-14)
        assert found.loss_factor == pytest.approx(1.3 / (2 * np.pi), rel=1e-14)

    def test_series_and_parallel(self):
        """Three groups in series of two in parallel; inertias of both halves stay."""
        one, many = (
            coupling(stiffness=600, damping=30, first_inertia=1, second_inertia=2, in_series=n, in_parallel=m).parts(
                Values({})
            )
            for n, m in ((1, 1), (3, 2))
        )
        assert (many[0].stiffness, many[0].damping) == (400, 20)
        assert [part.inertia for part in many[1:]] == [part.inertia for part in one[1:]] == [1, 2]

    def test_beyond_the_curve_nothing_is_known(self):
        for torque in (200, 1001):
            with pytest.raises(tn.ModelError, match=r"elements\.cpl\.torque: .*0\.25.*out-of-range"):
                two_masses(stiffness_over_torque=SHARES, T_KN=1000, torque=torque)
        with pytest.raises(tn.ModelError, match=r"elements\.cpl\.temperature: .*30.*80.*out-of-range"):
            two_masses({"t": "20 degC"}, stiffness=1, temperature="t", temperature_factor={"30 degC": 1, "80 degC": 2})

    def test_what_is_read_off_may_be_a_parameter(self):
        """Derivatives are the slope of the curve, the mean of both slopes at a row; symbols give the same number."""
        for torque, slope in ((400, 400), (500, 600), (700, 800)):
            rig = two_masses({"Q": torque}, stiffness_over_torque=SHARES, T_KN=1000, torque="Q")
            stiffness = np.interp(torque / 1000, [0.25, 0.5, 1], [200, 300, 700])
            assert rig.modes().natural_frequencies[-1] * 2 * np.pi == pytest.approx(np.sqrt(stiffness * 5 / 6))
            found = mode_sensitivities(rig, ["Q"])
            effect = found.frequency_slopes[-1, 0] / rig.modes().natural_frequencies[-1]
            assert effect == pytest.approx(slope / 1000 / (2 * stiffness), rel=1e-9)
            symbolic = rig.symbolic()
            assert float(symbolic.K[0, 0].subs(symbolic.values)) == pytest.approx(stiffness)

    def test_follows_the_mean_torque_over_speed(self):
        text = """torsionnet: 1
parameters:
  Q: {by: mean_torque, of: cpl}
elements:
  engine: {type: inertia, node: a, inertia: 20 kg*m^2}
  cpl: {type: flexible_coupling, nodes: [a, b], T_KN: 1 kN*m, torque: Q, loss_factor: {psi: 1},
    stiffness_over_torque: {0: 8 kN*m/rad, 0.5: 10 kN*m/rad, 1: 30 kN*m/rad}}
  pump: {type: inertia, node: b, inertia: 15 kg*m^2}
speeds: {of: a, range: 500..1000 rpm, step: 100 rpm, rated: 1000 rpm}
load: {absorbed_at: b, power: 100 kW, torque_exponent: 2, driven_by: {a: 1}}
excitations:
  engine: {type: harmonic, node: a, orders: {1: {amplitude: 10 N*m}}}
"""
        with pytest.raises(tn.ModelError, match=r":6:71: .*500.*out-of-range"):
            tn.loads(text.replace("{0: 8", "{0.3: 8"))
        rig = tn.loads(text)
        run = rig.order_response("torque(cpl)")
        rated = 1e5 / (1000 * RPM)
        for place, rpm in enumerate(run.rpm):
            stiffness = np.interp(rated * (rpm / 1000) ** 2 / 1000, [0, 0.5, 1], [8e3, 10e3, 30e3])
            kappa = stiffness * (1 + 1j / (2 * np.pi))
            s2 = -((rpm * RPM) ** 2)
            expected = 10 * 15 * kappa / (20 * 15 * s2 + 35 * kappa)
            assert abs(run.values[place, 0, 0]) == pytest.approx(abs(expected), rel=1e-10)

    def test_over_frequency(self):
        """k(f) (1 + j eta(f)), straight on double logarithmic paper; a parameter scales it, with derivative."""
        given = {"frequency_factor": {1: 1, 100: 2}, "loss_over_frequency": {1: 0.1, 100: 0.2}}
        rig = two_masses({"k": 500}, stiffness="k", **given)
        f = np.array([1.0, 10.0, 40.0])
        power = np.log10(f) / 2
        kappa = 500 * 2**power * (1 + 0.1j * 2**power)
        s2 = -((2 * np.pi * f) ** 2)
        expected = kappa / (6 * s2**2 + 5 * kappa * s2)
        found = rig.frequency_response("theta", "T", f).values.ravel()
        np.testing.assert_allclose(found, expected, rtol=1e-10)
        mode = mode_sensitivities(rig, ["k"]).frequency_slopes[-1, 0]
        step = [rig.configured(k=500 + d).modes().natural_frequencies[-1] for d in (-0.05, 0.05)]
        assert mode == pytest.approx((step[1] - step[0]) / 0.1, rel=1e-5)


class TestMaterial:
    def test_disc_and_bush(self):
        """By integration of the shear over rings: dT = 2 pi r^2 tau dr, and of the twist of sleeves."""
        radius = np.linspace(0.1, 0.2, 20001)
        disc = ShearedDisc(outer_diameter=0.4, inner_diameter=0.2, thickness=0.05).factor
        assert disc == pytest.approx(np.trapezoid(2 * np.pi * radius**3 / 0.05, radius), rel=1e-7)
        bush = ShearedBush(outer_diameter=0.4, inner_diameter=0.2, length=0.3).factor
        assert bush == pytest.approx(1 / np.trapezoid(1 / (2 * np.pi * radius**3 * 0.3), radius), rel=1e-7)

    def test_universal_constants_of_williams_landel_and_ferry(self):
        """17.44 and 51.6 K from the glass transition are 8.86 and 101.6 K from 50 K above it, as published: the shift
        between two temperatures is the same. At 50 K above, log a_T is -17.44*50/101.6 = -8.583."""
        glass = Viscoelastic(moduli=MODULI, reference_temperature="200 K", C1=17.44, C2="51.6 K")
        above = Viscoelastic(moduli=MODULI, reference_temperature="250 K", C1=8.86, C2="101.6 K")
        logs = {t: (math.log10(glass.shift_factor(t)), math.log10(above.shift_factor(t))) for t in (220, 250, 290)}
        assert logs[250] == (pytest.approx(-8.583, abs=1e-3), 0)
        for t in (220, 290):
            assert logs[t][0] - logs[250][0] == pytest.approx(logs[t][1], rel=2e-3)

    def test_warm_rubber_is_cold_rubber_at_a_lower_frequency(self):
        given = {"geometry": DISC, "material": {
            "moduli": MODULI, "reference_temperature": "20 degC", "C1": 8.86, "C2": "101.6 K"}}  # fmt: skip
        cold, warm = (law(**given, temperature=t).table for t in ("20 degC", "45 degC"))
        shift = 10 ** (-8.86 * 25 / 126.6)
        omega = 2 * np.pi * np.array([3.0, 30.0, 800.0])
        np.testing.assert_allclose(warm.kappa(omega), cold.kappa(omega * shift), rtol=1e-12)

    def test_at_its_rows_it_is_the_factor_times_the_moduli(self):
        kappa = law(geometry=DISC, material={"moduli": MODULI}, in_series=2, scale=1.5).table.kappa(
            2 * np.pi * np.array([1.0, 10.0, 100.0])
        )
        factor = np.pi * (0.2**4 - 0.1**4) / (2 * 0.05) / 2 * 1.5
        np.testing.assert_allclose(kappa, factor * (np.array(MODULI)[:, 1] + 1j * np.array(MODULI)[:, 2]), rtol=1e-12)

    def test_rates_are_the_slopes_of_the_law(self):
        table = law(geometry=DISC, material={"moduli": MODULI}).table
        for omega in (2.0, 20.0, 300.0, 1000.0):
            step = 1e-5 * omega
            low, high = table.kappa(np.array([omega - step, omega + step]))
            assert table.kappa_rate(omega) == pytest.approx((high - low) / (2 * step), rel=1e-7, abs=1e-7)

    def test_a_scale_of_the_moduli_may_be_fitted(self):
        rig = two_masses({"F": 1.0}, geometry=DISC, material={"moduli": MODULI}, scale="F")
        found = mode_sensitivities(rig, ["F"]).frequency_slopes[-1, 0]
        step = [rig.configured(F=1 + d).modes().natural_frequencies[-1] for d in (-1e-4, 1e-4)]
        assert found == pytest.approx((step[1] - step[0]) / 2e-4, rel=1e-4)

    def test_a_temperature_is_refused_where_derivatives_are_asked_for(self):
        """A law over frequency knows none to its temperature: better said than silently zero."""
        rig = two_masses(
            geometry=DISC,
            material={"moduli": MODULI, "shift": {"0 degC": 5, "20 degC": 1, "80 degC": 0.05}},
            temperature="40 degC",
        )
        with pytest.raises(tn.ModelError, match=r"elements\.cpl\.temperature: .*expression-not-allowed"):
            mode_sensitivities(rig, ["cpl.temperature"])

    def test_a_table_of_shifts_goes_with_its_logarithm(self):
        rubber = Viscoelastic(moduli=MODULI, shift={"0 degC": 100, "20 degC": 1})
        assert rubber.shift_factor(283.15) == pytest.approx(10)


def test_round_trip_keeps_units_and_rows():
    rig = two_masses(
        stiffness_over_torque={"25 %": "0.2 kN*m/rad", 1: 700},
        T_KN="1 kN*m",
        torque="0.4 kN*m",
        temperature="60 degC",
        temperature_factor={"20 degC": 1, "80 degC": 0.5},
    )
    data = rig.elements["cpl"].to_data()
    assert data["stiffness_over_torque"] == {"25 %": "0.2 kN*m/rad", "1": 700}
    assert data["temperature"] == "60 degC"
    again = tn.model.elements.make_element("flexible_coupling", "cpl", {k: v for k, v in data.items() if k != "type"})
    assert again == rig.elements["cpl"]


T20 = {"reference_temperature": "20 degC"}


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, r"elements\.cpl: .*missing-entry"),
        (
            {"stiffness": 1, "stiffness_over_torque": SHARES},
            r"elements\.cpl\.stiffness_over_torque: .*contradicting-entries",
        ),
        ({"stiffness_over_torque": SHARES, "T_KN": 3}, r"elements\.cpl\.stiffness_over_torque: .*missing-entry"),
        ({"stiffness_over_torque": SHARES, "torque": 1}, r"elements\.cpl\.stiffness_over_torque: .*missing-entry"),
        ({"stiffness_over_torque": {"1 N*m": 2, 0.5: 3}}, "here are both"),
        ({"stiffness_over_torque": {1: 2}}, "two rows or more"),
        ({"stiffness_over_torque": {0: 2, 1: "k"}}, "holds numbers"),
        ({"stiffness_over_torque": {0: 2, "1.0": 3, 1: 4}}, "stands twice"),
        ({"stiffness_over_torque": {0: 2, "1 kg": 3}}, r"elements\.cpl\.stiffness_over_torque\.1\ kg: .*wrong-unit"),
        ({"stiffness_over_torque": {0: 0, 1: 3}}, "out-of-range"),
        ({"stiffness": 1, "temperature": 60}, r"elements\.cpl\.temperature: .*60.*60.*missing-unit"),
        ({"stiffness": 1, "temperature": "60 degC"}, r"elements\.cpl\.temperature: .*needless-entry"),
        (
            {"stiffness": 1, "temperature_factor": {20: 1, 60: 2}},
            r"elements\.cpl\.temperature_factor\.20: .*20.*20.*missing-unit",
        ),
        ({"stiffness": 1, "temperature_factor": {"20 degC": 1, "60 degC": 2}}, "needs temperature"),
        ({"stiffness": 1, "loss_factor": 0.1, "damping": 2}, r"elements\.cpl\.damping: .*contradicting-entries"),
        ({"stiffness": 1, "frequency_factor": {1: 1, 2: 2}}, "needs a damping, too"),
        ({"stiffness": 1, "frequency_factor": {1: 1, 2: 2}, "loss_factor": 0}, "needs a damping, too"),
        (
            {"stiffness": 1, "frequency_factor": {1: 1, 2: 2}, "loss_factor": "eta"},
            r"elements\.cpl\.loss_factor: .*expression-not-allowed",
        ),
        ({"stiffness": 1, "frequency_factor": {0: 1, 2: 2}, "loss_factor": 1}, "begin above 0"),
        ({"stiffness": 1, "scale": 2}, r"elements\.cpl\.scale: .*needless-entry"),
        ({"material": {"moduli": MODULI}}, "here is no geometry"),
        ({"stiffness": 1, "geometry": DISC}, "here is no material"),
        ({"material": {"moduli": MODULI}, "geometry": DISC, "loss_factor": 0.1}, "leave out loss_factor"),
        (
            {"material": {"moduli": MODULI}, "geometry": DISC, "temperature": "20 degC"},
            r"elements\.cpl\.temperature: .*out-of-range",
        ),
        ({"material": {"moduli": MODULI, "C1": 8}, "geometry": DISC}, "are given together"),
        ({"material": {"moduli": MODULI, "C1": 8, "C2": "100 K"}, "geometry": DISC}, "need reference_temperature"),
        ({"material": {"moduli": [[1, 2]]}, "geometry": DISC}, "a row is"),
        ({"material": {"moduli": [[2, 1, 1], [1, 1, 1]]}, "geometry": DISC}, "must increase"),
        ({"material": {"moduli": [[2, 1, 0]]}, "geometry": DISC}, "out-of-range"),
        ({"material": {"moduli": MODULI}, "geometry": DISC | {"inner_diameter": 1}}, "smaller than the outer"),
        ({"material": {"moduli": MODULI}, "geometry": {"type": "dics"}}, 'did you mean "disc"'),
        (
            {"material": {"moduli": MODULI, **T20, "C1": 8, "C2": "60 K"}, "geometry": DISC, "temperature": "-50 degC"},
            "so far below",
        ),
    ],
)
def test_contradictions_are_named(given, words):
    with pytest.raises(tn.ModelError, match=words):
        coupling(**given)


def test_a_share_of_a_nominal_torque_that_is_a_parameter():
    assert law({"N": 1000, "Q": 400}, stiffness_over_torque=SHARES, T_KN="N", torque="Q").stiffness == pytest.approx(
        260
    )
    assert isinstance(coupling(stiffness=3).stiffness, Number)


@pytest.mark.parametrize(
    ("element", "home"),
    [
        ("type: hysteretic_spring, nodes: [a, b], stiffness: 1 kN*m/rad, psi: 0.9", "loss_factor: {psi: 0.9}"),
        ("type: spring, nodes: [a, b], stiffness: 1 kN*m/rad, zeta: 0.02", "damping: {zeta: 2 %, at: 12 Hz}"),
    ],
)
def test_a_measure_of_damping_beside_its_entry_is_one_fault(element, home):
    masses = "".join(f"  m{n}: {{type: inertia, node: {n}, inertia: 1}}\n" for n in "ab")
    with pytest.raises(tn.ModelError) as error:
        tn.loads(f"torsionnet: 1\nname: x\nelements:\n{masses}  s: {{{element}}}\n")
    (fault,) = error.value.faults
    assert fault.kind == "unknown-entry"
    assert home in fault.message
