"""Modes fitted to frequency responses: known poles, noise, other programs, the rigs' poles."""

import warnings
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import campaigns
from support.modal_cases import chain_residues, pole, response_of

import torsionnet as tn
from torsionnet.base.errors import SolveError, UsageError
from torsionnet.linear.frequency_response import Channel
from torsionnet.modal import Settings, identify_modes, match, peak_picking, stabilisation
from torsionnet.modal.matching import mac
from torsionnet.modal.matrix_fraction import Order, Stabilisation, _same, largest_order
from torsionnet.modal.mode_identification import fit_poles
from torsionnet.modal.refinement import factors_of, roots_of
from torsionnet.modal.residues import Projection
from torsionnet.modal.selection import clusters, significant_poles
from torsionnet.modal.spectral_lines import Criteria, lines_of, power_over_receptance

LINES = np.arange(0.5, 30.01, 0.1)
CUT = {  # Hz, %; of the rigs cut at the torque meter
    "dmf": ("8.755", "25.7"),
    "II": ("3.945", "24.5"),
    "III": ("5.396", "25.0"),
    "IV": ("6.430", "25.1"),
    "V": ("7.199", "24.8"),
    "V_c_O_360": ("7.809", "30.8"),
}


def rig(case):
    return tn.load("dmf_rig") if case == "dmf" else tn.load("amt_rig").configured(case)


def printed(value, text):
    return f"{value:.{len(text.partition('.')[2])}f}" == text


def nearest(found, wanted):
    """Relative distance of the nearest pole found to each wanted one."""
    return np.array([np.min(np.abs(np.asarray(found) - value)) / abs(value) for value in wanted])


SYSTEMS = {
    "light": [pole(5, 0.005), pole(12, 0.01)],
    "medium": [pole(4, 0.03), pole(9, 0.05), pole(17, 0.02)],
    "strong": [pole(4, 0.25), pole(13, 0.45)],
    "overdamped": [-43.9 + 0j, pole(7.8, 0.31), -255.0 + 0j],
    "real poles only": [-8.0 + 0j, -60.0 + 0j],
    "nearly critical": [pole(6, 0.999), pole(14, 0.1)],
    "close": [pole(10, 0.02), pole(10.3, 0.02)],
}


MEASURED = [(name, output, outputs) for output in ("rad", "rad/s", "rad/s^2") for outputs in (1, 3) for name in SYSTEMS]


class TestKnownPoles:
    @pytest.mark.few(1, 12)
    @pytest.mark.parametrize(("name", "output", "outputs"), MEASURED)
    def test_come_back_from_responses_without_noise(self, name, outputs, output):
        poles = SYSTEMS[name]
        residues, _ = chain_residues(poles, outputs)
        response = response_of(poles, residues, LINES, output=output, upper=1e-4, lower=0.3)
        found = identify_modes(response)
        every = np.concatenate([found.poles, found.outside_poles])
        assert nearest(every, poles).max() < 1e-6
        assert len(every) == len(poles)
        assert len(found) == sum(0.5 <= abs(value) / (2 * np.pi) <= 30 for value in poles)
        for value, residue in zip(poles, residues, strict=True):
            own = [*found.residues, *found.outside_residues][np.argmin(np.abs(every - value))]
            np.testing.assert_allclose(own, residue, rtol=1e-4, atol=1e-6 * np.abs(residues).max())
        np.testing.assert_allclose(found.synthesised.values, response.values, rtol=1e-6, atol=1e-9)
        assert found.misfit.max() < 1e-8

    @pytest.mark.slow
    def test_residual_terms_come_back(self):
        poles = [pole(8, 0.05)]
        response = response_of(poles, chain_residues(poles, 2)[0], LINES, upper=2e-3, lower=-1.5)
        found = identify_modes(response)
        np.testing.assert_allclose(found.upper, 2e-3, rtol=1e-8)
        np.testing.assert_allclose(found.lower, -1.5, rtol=1e-8)

    @pytest.mark.few(1)
    @pytest.mark.parametrize(
        "residuals", [*(pytest.param(one, marks=pytest.mark.slow) for one in ("none", "both")), "lower", "upper"]
    )
    def test_residual_terms_that_are_there_must_be_asked_for(self, residuals):
        poles = [pole(8, 0.05), pole(15, 0.02)]
        lower, upper = 1.5 * (residuals in ("lower", "both")), 2e-3 * (residuals in ("upper", "both"))
        response = response_of(poles, chain_residues(poles)[0], LINES, lower=lower, upper=upper)
        assert nearest(identify_modes(response, Settings(residuals=residuals)).poles, poles).max() < 1e-6
        if residuals != "none":
            without = identify_modes(response, Settings(residuals="none"), selection=4, refined=False)
            assert nearest(without.poles, poles).max() > 1e-6

    @pytest.mark.slow
    @given(
        st.lists(
            st.tuples(st.floats(2, 25), st.floats(0.005, 0.6)), min_size=1, max_size=3, unique_by=lambda p: round(p[0])
        ),
        st.integers(0, 10_000),
    )
    @settings(max_examples=campaigns.examples(3, 60))
    def test_any_oscillatory_modes_apart(self, modes, seed):
        modes = sorted(modes)
        if any(b[0] < 1.25 * a[0] for a, b in pairwise(modes)):
            return
        poles = [pole(*mode) for mode in modes]
        residues, _ = chain_residues(poles, 2, seed=seed)
        found = identify_modes(response_of(poles, residues, LINES))
        assert nearest(found.poles, poles).max() < 1e-6

    @pytest.mark.slow
    def test_a_repeated_pole_needs_two_inputs(self):
        poles = [pole(6, 0.02), pole(11, 0.03), pole(11, 0.03)]
        residues, shapes = chain_residues(poles, 4, 2)
        response = response_of(poles, residues, LINES)
        for method in (Settings("lscf", 30), Settings("rational", 4)):
            found = identify_modes(response, method)
            assert len(found) == 3
            assert nearest(found.poles, poles).max() < 1e-5
            both = np.linalg.qr(shapes[:, 1:])[0]
            for shape in found.shapes[:, 1:].T:  # any combination of the two shapes, but nothing else
                assert np.linalg.norm(shape - both @ (both.conj().T @ shape)) < 1e-3 * np.linalg.norm(shape)
            assert any("close together" in note for note in found.notes)
            assert found.misfit.max() < 1e-3
        assert len(identify_modes(response.select(input="u0"))) == 2

    def test_two_inputs_with_modes_apart_are_refined(self):
        poles = SYSTEMS["strong"]
        residues, shapes = chain_residues(poles, 3, 2)
        found = identify_modes(response_of(poles, residues, LINES, noise=1e-3), Settings(highest_order=4))
        assert nearest(found.poles, poles).max() < 0.01
        assert np.isfinite(found.frequency_errors).all()
        assert np.all(np.diag(mac(found.shapes, shapes)) > 0.999)


FEW_SEEDS = [0, 1, *(pytest.param(seed, marks=pytest.mark.nightly) for seed in range(2, 5))]


class TestNoise:
    @pytest.mark.slow
    @pytest.mark.parametrize(("name", "noise", "bound"), [("light", 0.02, 3e-3), ("strong", 0.002, 0.03)])
    @pytest.mark.parametrize("seed", FEW_SEEDS)
    def test_poles_stay_within_bounds(self, name, noise, bound, seed):
        poles = SYSTEMS[name]
        residues, _ = chain_residues(poles, 3)
        found = identify_modes(response_of(poles, residues, LINES, noise=noise, seed=seed))
        assert len(found) == len(poles)
        assert nearest(found.poles, poles).max() < bound

    @pytest.mark.slow
    @pytest.mark.parametrize("runs", [30, pytest.param(120, marks=pytest.mark.nightly)])
    def test_standard_errors_are_those_of_many_tests(self, runs):
        poles = [pole(8.7, 0.257)]
        residues, _ = chain_residues(poles, 1)
        tests = [
            identify_modes(response_of(poles, residues, LINES, noise=0.02, seed=seed), Settings(highest_order=3))
            for seed in range(runs)
        ]
        for numbers, errors in (("natural_frequencies", "frequency_errors"), ("damping_ratios", "damping_errors")):
            scatter = np.std([getattr(test, numbers)[0] for test in tests], ddof=1)
            assert np.median([getattr(test, errors)[0] for test in tests]) == pytest.approx(
                scatter, rel=3.1 / np.sqrt(2 * runs)
            )
            truth = {"natural_frequencies": 8.7, "damping_ratios": 0.257}[numbers]
            mean = np.mean([getattr(test, numbers)[0] for test in tests])
            assert abs(mean - truth) < 3 * scatter / np.sqrt(runs)

    @pytest.mark.slow
    def test_errors_grow_where_neighbouring_lines_are_alike(self):
        poles = [pole(8.7, 0.257)]
        plain = response_of(poles, chain_residues(poles)[0], LINES)
        rng = np.random.default_rng(1)
        white = 1e-5 * (rng.normal(size=LINES.size + 8) + 1j * rng.normal(size=LINES.size + 8))
        smooth = np.convolve(white, np.ones(9) / 3, mode="valid")
        errors = [
            identify_modes(replace(plain, values=plain.values + noise[:, None, None]), selection=2).frequency_errors[0]
            for noise in (white[8:], smooth)
        ]
        assert errors[1] > 2 * errors[0]

    @pytest.mark.slow
    @pytest.mark.parametrize("runs", [3, pytest.param(10, marks=pytest.mark.nightly)])
    def test_one_line_of_noise_is_no_mode(self, runs):
        counts = []
        for seed in range(runs):
            response = rig("V").frequency_response("theta_1", "T_T", LINES)
            rng = np.random.default_rng(seed)
            noise = 0.01 * response.magnitude.max() * (rng.normal(size=LINES.size) + 1j * rng.normal(size=LINES.size))
            found = identify_modes(replace(response, values=response.values + noise[:, None, None]))
            counts.append(np.sum(found.damping_ratios < 0.1))
        assert sum(counts) == 0


each_cut = pytest.mark.parametrize(
    "case", [pytest.param(case, marks=[pytest.mark.slow] * (case not in ("dmf", "III", "V"))) for case in CUT]
)


class TestRigs:
    """The poles of theta_1/T_T are those of the rig cut at the torque meter."""

    @pytest.mark.few(1)
    @each_cut
    def test_without_noise(self, case):
        model = rig(case)
        found = identify_modes(model.frequency_response("theta_1", "T_T", LINES))
        wanted = model.modes(measured_input="T_T").eigenvalues
        every = np.concatenate([found.poles, found.outside_poles])
        assert nearest(every, wanted[np.abs(wanted) < 1000]).max() < 1e-6
        first = int(np.argmax(np.where(found.poles.imag > 0, found.contributions, 0)))
        assert printed(found.natural_frequencies[first], CUT[case][0])
        assert printed(100 * found.damping_ratios[first], CUT[case][1])
        whole = model.modes().eigenvalues
        assert nearest(found.poles, whole[:1]).min() > 0.03

    @pytest.mark.few(1, 5)
    @each_cut
    @pytest.mark.parametrize("noise", [pytest.param(0.002, marks=pytest.mark.slow), 0.01])
    def test_with_noise(self, case, noise):
        model = rig(case)
        response = model.frequency_response("theta_1", "T_T", np.arange(0.5, 30, 0.05))
        rng = np.random.default_rng(5)
        size = noise * response.magnitude.max() / np.sqrt(2)
        values = response.values + size * (
            rng.normal(size=response.values.shape) + 1j * rng.normal(size=response.values.shape)
        )
        found = identify_modes(replace(response, values=values))
        wanted = next(v for v in model.modes(measured_input="T_T").eigenvalues if v.imag and abs(v) < 60)
        own = int(np.argmin(np.abs(found.poles - wanted)))
        assert found.natural_frequencies[own] == pytest.approx(abs(wanted) / 2 / np.pi, rel=0.01)
        assert found.damping_ratios[own] == pytest.approx(-wanted.real / abs(wanted), rel=0.02)
        assert abs(found.natural_frequencies[own] - abs(wanted) / 2 / np.pi) < 4 * found.frequency_errors[own]

    @pytest.mark.slow
    def test_from_recordings_with_the_settings_of_the_paper(self):
        from torsionnet.signals import PAPER, LinearChirp, estimate

        model = rig("dmf")
        chirp = LinearChirp(start=0.1, stop=80, duration=100, amplitude=15)
        record = model.simulate(["theta_1", "T_T"], {"T_M": chirp.samples(10e3)}, 10e3)
        measured = estimate(record, "theta_1", "T_T", settings=PAPER)
        found = identify_modes(measured, Settings(band=(0.5, 20)))
        assert found.natural_frequencies[0] == pytest.approx(8.755, rel=0.01)
        assert found.damping_ratios[0] == pytest.approx(0.257, rel=0.02)

    def test_against_an_imposed_angle_the_input_stands_still(self):
        response = rig("dmf").frequency_response("angle(primary)", "angle(motor)", np.arange(1, 150, 0.5))
        assert response.inputs[0].unit == "rad"
        clamped = np.roots([0.152, 0.1 + 4 + 0.3, 13.3e3 + 460])  # I_2, c_1 + c_2 + c_B, k_1 + k_2
        assert nearest(identify_modes(response).poles, clamped[clamped.imag > 0]).max() < 1e-6

    def test_a_torque_over_an_angle_is_fitted_as_an_inertia(self):
        """T = (k + j omega c - omega^2 J) theta plus an absorber: its pole is the absorber's with its hub clamped."""
        s = 2j * np.pi * LINES
        absorber = pole(9, 0.1)
        k, c = abs(absorber) ** 2, -2 * absorber.real
        values = 400 + 0.1 * s**2 + 0.02 * s**2 * (c * s + k) / (s**2 + c * s + k)
        response = response_of([absorber], np.ones((1, 1, 1)), LINES)
        stiffness = replace(
            response,
            values=values[:, None, None],
            outputs=(Channel("T", "N*m"),),
            inputs=(Channel("theta", "rad"),),
        )
        found = identify_modes(stiffness)
        assert nearest(found.poles, [absorber]).max() < 1e-6
        assert found.lower[0, 0] == pytest.approx(400, rel=1e-6)

    def test_powers_of_s(self):
        theta, omega, alpha, torque = (Channel("x", unit) for unit in ("rad", "rad/s", "rad/s^2", "N*m"))
        assert [power_over_receptance(channel, torque) for channel in (theta, omega, alpha, torque)] == [0, 1, 2, 0]
        assert [power_over_receptance(channel, theta) for channel in (theta, omega, alpha, torque)] == [0, 1, 2, 2]
        assert [power_over_receptance(channel, alpha) for channel in (theta, omega, alpha, torque)] == [-2, -1, 0, 0]
        with pytest.raises(UsageError, match="volt"):
            power_over_receptance(Channel("u", "volt"), torque)


class TestLscf:
    @pytest.mark.slow
    def test_light_modes_come_back(self):
        poles = [pole(f, z) for f, z in ((12, 0.005), (25, 0.01), (40, 0.02), (58, 0.01), (70, 0.008), (91, 0.01))]
        residues, shapes = chain_residues(poles, 4)
        response = response_of(poles, residues, np.arange(0.1, 100.01, 0.1), output="rad/s^2")
        found = identify_modes(response, Settings("lscf"))
        assert nearest(found.poles, poles).max() < 1e-6
        assert np.all(np.diag(mac(found.shapes, shapes)) > 1 - 1e-8)
        rough = identify_modes(response, Settings("lscf"), refined=False)
        assert nearest(rough.poles, poles).max() < 1e-4
        assert np.isnan(rough.frequency_errors).all()

    @pytest.fixture
    def ema(self):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return pytest.importorskip("sdypy.EMA")

    def noisy(self):
        poles = [pole(12, 0.005), pole(25, 0.01), pole(40, 0.02), pole(88, 0.02)]
        residues, _ = chain_residues(poles, 4)
        response = response_of(poles, residues, np.arange(0.1, 100, 0.1), noise=0.01)
        size = np.sqrt(np.mean(response.magnitude**2, axis=0))
        return poles, replace(response, values=response.values / size)

    @pytest.mark.parametrize("order", [10, *(pytest.param(order, marks=pytest.mark.slow) for order in (20, 40))])
    def test_poles_of_an_order_agree_with_sdypy(self, ema, order):
        """It counts the last line once and the others twice, which moves poles a little; the noise moves them more."""
        poles, response = self.noisy()
        frequencies = np.concatenate([[0.0], response.frequencies, [100.0]])
        values = np.concatenate([np.zeros((1, 4)), response.values[:, :, 0], np.zeros((1, 4))])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            model = ema.Model(values.T, frequencies, lower=0.1, upper=100, pol_order_high=20, frf_form="receptance")
            model.get_poles(method="lscf", show_progress=False)
        theirs = model.all_poles[order // 2 - 1]
        own = stabilisation(response, Settings("lscf")).at(order).poles
        for wanted in poles:
            one, other = (values[np.argmin(np.abs(values - wanted))] for values in (own, theirs))
            assert abs(one / other - 1) < 2e-4
            assert abs(one / other - 1) < 0.2 * abs(other / wanted - 1) + 1e-5

    @pytest.mark.usefixtures("ema")
    @pytest.mark.parametrize(("output", "form"), [("rad", "receptance"), ("rad/s^2", "accelerance")])
    def test_residues_agree_with_sdypy(self, output, form):
        poles = np.array([pole(12, 0.005), pole(25, 0.01), pole(40, 0.02)])
        response = response_of(poles, chain_residues(poles, 4)[0], np.arange(1, 60, 0.1), noise=0.01, output=output)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            from sdypy.EMA.EMA import LSFD

            theirs = LSFD(
                poles,
                response.values[:, :, 0].T,
                response.frequencies,
                False,
                False,
                0,
                len(response.frequencies),
                form,
            )[0]
        own = fit_poles(response, poles, Settings(residuals="none"))
        np.testing.assert_allclose(own.residues[:, :, 0].T, theirs, rtol=1e-9, atol=1e-12 * np.abs(theirs).max())


class TestDiagram:
    def test_poles_of_the_structure_stay_and_others_do_not(self):
        poles = SYSTEMS["medium"]
        response = response_of(poles, chain_residues(poles, 3)[0], LINES, noise=0.003)
        diagram = stabilisation(response, Settings(highest_order=10))
        stable = [np.abs(order.poles[order.stable]) / (2 * np.pi) for order in diagram.orders]
        for order in diagram.orders[6:9]:
            assert order.partners.max() >= 0
            assert nearest(order.poles[order.stable], poles).max() < 0.01
        wandering = [f for order in stable for f in order if np.min(np.abs(f / np.array([4, 9, 17]) - 1)) > 0.02]
        assert len(wandering) <= 2
        assert identify_modes(diagram, selection="clusters").natural_frequencies == pytest.approx([4, 9, 17], rel=2e-3)
        shown = next(one for one in tn.plot.stabilisation(diagram).axes if one.get_ylabel() == "order of the fit")
        assert shown.get_ylim() == (0, len(diagram.orders) + 1)

    @pytest.mark.slow
    def test_criteria_are_kept(self):
        poles = SYSTEMS["medium"]
        response = response_of(poles, chain_residues(poles, 3)[0], LINES, noise=0.01)
        limits = Criteria(0.001, 0.01, 0.999)
        diagram = stabilisation(response, Settings(criteria=limits))
        for before, order in zip(diagram.orders, diagram.orders[1:], strict=False):
            for place in np.flatnonzero(order.stable):
                old, new = before.poles[order.partners[place]], order.poles[place]
                assert abs(abs(old) / abs(new) - 1) <= limits.frequency
                assert abs(old.real / abs(old) / (new.real / abs(new)) - 1) <= limits.damping

    def test_pole_by_hand(self):
        poles = SYSTEMS["medium"]
        diagram = stabilisation(response_of(poles, chain_residues(poles, 2)[0], LINES, noise=1e-3))
        found = identify_modes(diagram, selection=[(7, 9), (6, 4.1), (7, 9.1)], refined=False)
        assert found.natural_frequencies == pytest.approx([4, 9], rel=0.01)
        assert found.method.endswith("chosen by hand")

    @pytest.mark.few(1)
    @pytest.mark.parametrize(
        ("selection", "message"),
        [
            (99, r"(?s)99.*out-of-range"),
            ([(5, 500.0)], "no pole near 500 Hz; its poles are at"),
            ([], "no pole is chosen"),
            ([3.5], "order and frequency"),
            ("best", 'choose "order"'),
        ],
    )
    def test_wrong_selection(self, selection, message):
        diagram = stabilisation(response_of([pole(8, 0.1)], np.ones((1, 1, 1)), LINES, noise=1e-3))
        with pytest.raises(UsageError, match=message):
            identify_modes(diagram, selection=selection)

    @pytest.mark.parametrize(("least", "modes"), [(5, 1), (6, 0), (None, 1)])
    def test_a_cluster_takes_enough_orders(self, least, modes):
        diagram = one_pole_over_orders(10, Settings(criteria=Criteria(least_orders=least)), lost={1, 2, 3, 5, 6})
        assert len(clusters(diagram)) == modes

    def test_no_cluster_is_an_error(self):
        diagram = one_pole_over_orders(5, Settings(criteria=Criteria(least_orders=6)))
        with pytest.raises(SolveError, match="no-resonance"):
            identify_modes(diagram, selection="clusters")

    def test_shape_that_turns_is_not_stable(self):
        """Poles alike to the order before in frequency and damping, with other shapes."""
        one = np.array([[1.0, 0.0], [0.0, 1.0]], dtype=complex)
        poles = np.array([pole(5, 0.02), pole(9, 0.03)])
        before = _before(poles, one)
        turned = np.array([[1.0, 0.5], [0.0, 1.0]], dtype=complex)
        places, (frequency, damping, shape) = _same(poles * 1.001, turned, before, Criteria())
        assert places.tolist() == [0, 1]
        assert frequency.all()
        assert damping.all()
        assert shape.tolist() == [False, True]

    def test_shapes_of_a_repeated_pole_are_any_combination(self):
        poles = np.array([pole(5, 0.02), pole(5.001, 0.02)])
        before = _before(poles, np.eye(3, dtype=complex)[:2])
        mixed = np.array([[1.0, 1.0, 0.0], [1.0, -1.0, 0.0]], dtype=complex)
        assert _same(poles, mixed, before, Criteria())[1][2].all()
        assert not _same(poles, mixed + np.array([0, 0, 1]), before, Criteria())[1][2].any()

    def test_a_chain_that_broke_is_one_mode(self):
        assert len(clusters(one_pole_over_orders(11, Settings(), lost={1, 6}))) == 1

    def test_table_has_every_pole(self):
        diagram = stabilisation(response_of([pole(8, 0.1)], np.ones((1, 1, 1)), LINES, noise=1e-3))
        assert len(diagram.table().rows) == sum(len(order.poles) for order in diagram.orders)


def one_pole_over_orders(highest, chosen, lost=frozenset({1})):
    """The same pole at every order; at some it is not counted as stable."""
    poles, shape = np.array([pole(5, 0.02)]), np.ones((1, 1), dtype=complex)
    response = response_of(poles, shape[None], LINES)
    lines = lines_of(response, chosen)
    orders = []
    for order in range(1, highest + 1):
        same = np.array([order not in lost])
        left = np.zeros(lines.values.shape, dtype=complex)
        orders.append(Order(order, poles, shape, shape, np.array([0]), same, same, same, left))
    return Stabilisation(response, chosen, tuple(orders), lines)


def _before(poles, shapes):
    yes = np.ones(len(poles), dtype=bool)
    return Order(3, poles, np.ones((len(poles), 1)), shapes, np.arange(len(poles)), yes, yes, yes, np.zeros(1))


class TestWorth:
    """A pole that a rule has found must lower Schwarz's criterion."""

    def test_poles_of_noise_are_dropped(self):
        poles = np.array(SYSTEMS["strong"])
        response = response_of(poles, chain_residues(poles, 2)[0], LINES, noise=0.005)
        chosen = Settings()
        lines = lines_of(response, chosen)
        many = np.array([*poles, pole(20, 0.001), pole(25, 0.3), -1000.0])
        assert significant_poles(lines, many, np.ones((5, 1), dtype=complex), chosen) == [0, 1]

    def test_all_poles_stay_where_there_is_no_noise(self):
        poles = np.array(SYSTEMS["overdamped"])
        response = response_of(poles, chain_residues(poles)[0], LINES)
        lines = lines_of(response, Settings())
        assert significant_poles(lines, poles, np.ones((3, 1), dtype=complex), Settings()) == [0, 1, 2]

    def test_what_is_chosen_by_hand_stays(self):
        poles = SYSTEMS["strong"]
        diagram = stabilisation(response_of(poles, chain_residues(poles)[0], LINES, noise=0.01))
        most = max(diagram.orders, key=lambda order: len(order.poles))
        assert len(identify_modes(diagram, selection=most.order, refined=False)) == len(most.poles) > 2


class TestRefinement:
    @pytest.mark.parametrize("runs", [3, pytest.param(10, marks=pytest.mark.nightly)])
    @pytest.mark.slow
    def test_a_noisy_sensor_weighs_less(self, runs):
        """Against fitting the clean sensor alone: a second one with much noise must not spoil the poles."""
        poles = [pole(8, 0.1)]
        residues = chain_residues(poles, 2)[0]
        worse = []
        for seed in range(runs):
            clean, dirty = (response_of(poles, residues, LINES, noise=n, seed=seed) for n in (1e-4, 0.1))
            values = np.concatenate([clean.values[:, :1], dirty.values[:, 1:]], axis=1)
            found = identify_modes(replace(clean, values=values), selection=2)
            alone = identify_modes(clean.select("y0"), selection=2)
            worse.append(nearest(found.poles, poles)[0] / nearest(alone.poles, poles)[0])
        assert np.median(worse) < 3

    @pytest.mark.parametrize("poles", [SYSTEMS["strong"], SYSTEMS["overdamped"], SYSTEMS["real poles only"]])
    def test_derivatives(self, poles):
        """Of the residual by differences; the shorter form leaves out what is orthogonal to the gradient."""
        response = response_of(poles, chain_residues(poles, 2)[0], LINES, noise=0.01)
        chosen = Settings()
        lines = lines_of(response, chosen)
        sizes, start = factors_of(np.asarray(poles))
        problem = Projection(lines, sizes, chosen)
        point = np.log(start) + 0.01
        step = 1e-6
        left, slopes = problem.residuals(point), problem.jacobian(point)
        for number in range(len(point)):
            move = np.eye(len(point))[number] * step
            numeric = (problem.residuals(point + move) - problem.residuals(point - move)) / (2 * step)
            assert left @ slopes[:, number] == pytest.approx(left @ numeric, rel=1e-4, abs=1e-6 * left @ left)

    @pytest.mark.parametrize("poles", SYSTEMS.values(), ids=SYSTEMS)
    def test_factors_and_back(self, poles):
        sizes, coefficients = factors_of(np.asarray(poles))
        back, slopes = roots_of(sizes, coefficients)
        assert nearest(back, poles).max() < 1e-9
        moved, _ = roots_of(sizes, coefficients * (1 + 1e-7 * np.arange(1, len(coefficients) + 1)))
        predicted = back + slopes @ (1e-7 * np.arange(1, len(coefficients) + 1))
        np.testing.assert_allclose(moved, predicted, rtol=1e-8)


class TestRemarks:
    def notes(self, response, **options):
        return " | ".join(map(str, identify_modes(response, **options).notes))

    @pytest.mark.slow
    def test_bandwidth_under_three_lines(self):
        poles = [pole(20, 0.001)]
        assert "half-power bandwidth under 3 lines at 20 Hz" in self.notes(
            response_of(poles, np.ones((1, 1, 1)), LINES)
        )
        poles = [pole(20, 0.02)]
        assert "lines" not in self.notes(response_of(poles, np.ones((1, 1, 1)), LINES))

    def test_poles_outside_the_band_are_counted(self):
        """A pole at 21 kHz stands for the stiff torque meter: no mode, but a part of the response."""
        response = rig("dmf").frequency_response("theta_1", "T_T", LINES)
        found = identify_modes(response)
        assert (
            found.notes[0] == "1 pole outside the band of 0.5 to 30 Hz stands for what is beyond it and is not listed"
        )
        assert len(found) == len(found.modes) == len(found.shapes.T) == 1
        assert found.outside_poles[0].imag == 0
        np.testing.assert_allclose(found.synthesised.values, response.values, rtol=1e-6)
        given = fit_poles(response, [*found.poles, *found.outside_poles])
        assert any("far outside the band of 0.5 to 30 Hz" in note and "real pole" in note for note in given.notes)

    def test_misfit(self):
        poles = SYSTEMS["medium"]
        response = response_of(poles, chain_residues(poles)[0], LINES)
        assert "leaves" in self.notes(response, selection=2, refined=False)

    def test_uncertain_mode(self):
        poles = SYSTEMS["strong"]
        response = response_of(poles, chain_residues(poles, seed=3)[0], LINES, noise=0.05)
        assert "standard error above 10%" in self.notes(response, selection=4)


class TestUse:
    def test_weights_of_coherence(self):
        poles = [pole(8, 0.1)]
        residues = chain_residues(poles)[0]
        clean, dirty = (response_of(poles, residues, LINES, noise=noise, seed=4) for noise in (1e-4, 0.5))
        bad = LINES > 12
        values = np.where(bad[:, None, None], dirty.values, clean.values)
        coherence = np.where(bad, 0.1, 0.9999)[:, None, None]
        response = replace(clean, values=values, coherence=coherence)
        uniform = nearest(identify_modes(response, selection=2).poles, poles)[0]
        weighted = nearest(identify_modes(response, Settings(weights="coherence"), selection=2).poles, poles)[0]
        assert weighted < 0.1 * uniform

    @pytest.mark.slow
    def test_units_of_outputs_do_not_matter(self):
        """A torque in N m beside an angle in mrad: each transfer function has a weight of its own."""
        poles = SYSTEMS["strong"]
        response = response_of(poles, chain_residues(poles, 2)[0], LINES, noise=0.005)
        other = replace(response, values=response.values * np.array([1.0, 1e6])[:, None])
        np.testing.assert_allclose(identify_modes(other).poles, identify_modes(response).poles, rtol=1e-7)

    def test_shapes_of_velocities_are_angles(self):
        poles = SYSTEMS["strong"]
        residues, shapes = chain_residues(poles, 2)
        angles = response_of(poles, residues, LINES)
        values = angles.values.copy()
        values[:, 1] *= 2j * np.pi * LINES[:, None]
        mixed = replace(angles, values=values, outputs=(Channel("y0", "rad"), Channel("y1", "rad/s")))
        found = identify_modes(mixed)
        np.testing.assert_allclose(found.shapes / found.shapes[:1], shapes / shapes[:1], rtol=1e-6)
        np.testing.assert_allclose(found.shape_at("y1"), found.shapes[1])
        with pytest.raises(UsageError, match='did you mean "y1"'):
            found.shape_at("y11")

    @pytest.mark.slow
    def test_shapes_are_scaled_by_what_moves(self):
        """A torque in N m beside angles of some mrad: 1 is at the largest angle."""
        response = rig("dmf").frequency_response(
            ["T_T", "angle(motor)", "angle(primary)"], "T_M", np.arange(1, 120, 0.5)
        )
        found = identify_modes(response)
        assert np.abs(found.shapes[1:]).max(axis=0) == pytest.approx([1, 1])
        assert np.abs(found.shape_at("T_T")).min() > 10
        modes = rig("dmf").modes()
        np.testing.assert_allclose(
            found.shapes[2] / found.shapes[1], modes.shape_at("primary") / modes.shape_at("motor"), rtol=1e-6
        )

    def test_zero_hertz_and_values_that_are_not_finite_are_left_out(self):
        frequencies = np.concatenate([[0.0], LINES])
        response = response_of([pole(8, 0.1)], np.ones((1, 1, 1)), frequencies)
        response.values[5] = np.nan
        found = identify_modes(response)
        assert nearest(found.poles, [pole(8, 0.1)])[0] < 1e-6
        assert len(found.frequencies) == len(LINES) - 1

    @pytest.mark.slow
    def test_lines_that_a_test_cannot_resolve_are_left_out(self):
        response = response_of([pole(8, 0.1)], np.ones((1, 1, 1)), LINES)
        response.values[LINES > 12] = 1e3
        limited = replace(response, usable_up_to=12.0)
        found = identify_modes(limited)
        assert nearest(found.poles, [pole(8, 0.1)])[0] < 1e-6
        assert found.notes[0].startswith("only up to 12 Hz")
        assert peak_picking(limited).notes[0].startswith("only up to 12 Hz")
        assert identify_modes(limited, Settings(band=(0, 30))).frequencies[-1] > 29

    def test_response_at_other_frequencies(self):
        poles = SYSTEMS["strong"]
        residues = chain_residues(poles, 2)[0]
        found = identify_modes(response_of(poles, residues, LINES, output="rad/s", upper=1e-3))
        elsewhere = np.array([0.01, 1.2345, 55.0])
        np.testing.assert_allclose(
            found.response(elsewhere).values,
            response_of(poles, residues, elsewhere, output="rad/s", upper=1e-3).values,
            rtol=1e-5,
            atol=1e-9,
        )

    def test_accelerance_at_rest_is_that_of_the_rigid_body(self):
        found = identify_modes(response_of([pole(8, 0.1)], np.ones((1, 1, 1)), LINES, output="rad/s^2", lower=3.0))
        np.testing.assert_allclose(found.response(np.array([0.0])).values, 3.0, rtol=1e-8)

    def test_table(self):
        found = identify_modes(rig("II").frequency_response("theta_1", "T_T", LINES))
        table = found.table(tn.Conventions(frequency="rpm"))
        assert table.rows[0][1] == pytest.approx(60 * 3.945, abs=0.1)
        assert "measured" not in table.title
        assert "3.945 Hz (24.5 %)" in repr(found)
        assert len(found.shape_table().rows) == 1

    def test_fewer_lines_than_unknowns_lower_the_order(self):
        response = response_of([pole(8, 0.1)], np.ones((1, 1, 1)), np.linspace(5, 12, 7))
        chosen = Settings(highest_order=40)
        assert largest_order(lines_of(response, chosen), chosen) < 7
        assert nearest(identify_modes(response, chosen).poles, [pole(8, 0.1)])[0] < 1e-5


class TestErrors:
    def wrong(self, message, response=None, error=UsageError, **options):
        response = response_of([pole(8, 0.1)], np.ones((1, 1, 1)), LINES) if response is None else response
        with pytest.raises(error, match=message):
            identify_modes(response, Settings(**options))

    def test_messages(self):
        self.wrong(r'(?s)"lscf".*unknown-word', method="lcsf")
        self.wrong(r"(?s)residuals.*unknown-word", residuals="all")
        self.wrong(r"(?s)highest order.*out-of-range", highest_order=0)
        self.wrong(r"(?s)5, 2.*unordered-rows", band=(5, 2))
        self.wrong(r"(?s) 4 .* 50 to 60 Hz, .* 0.*too-short", band=(50, 60))
        self.wrong(r"(?s)coherence.*missing-data", weights="coherence")
        with pytest.raises(UsageError, match=r"(?s)frequency.*out-of-range"):
            Criteria(frequency=0)
        with pytest.raises(UsageError, match=r"(?s)least_orders=1.*out-of-range"):
            Criteria(least_orders=1)

    def test_response_of_zeros(self):
        response = response_of([pole(8, 0.1)], np.zeros((1, 1, 1)), LINES)
        self.wrong(r"(?s)y0/u0.*needless-entry", response)

    def test_response_of_magnitudes_alone(self):
        response = response_of([pole(8, 0.1)], np.ones((1, 1, 1)), LINES)
        self.wrong("missing-data", replace(response, has_phase=False))

    def test_the_other_sign_of_time(self):
        response = response_of([pole(8, 0.1)], np.ones((1, 1, 1)), LINES)
        self.wrong(
            r"(?s)phase.*no-resonance", replace(response, values=response.values.conj()), SolveError, highest_order=2
        )

    def test_nothing_stable(self):
        rng = np.random.default_rng(2)
        noise = rng.normal(size=(LINES.size, 1, 1)) + 1j * rng.normal(size=(LINES.size, 1, 1))
        response = replace(response_of([pole(8, 0.1)], np.ones((1, 1, 1)), LINES), values=noise)
        with pytest.raises(SolveError, match="no-resonance"):
            identify_modes(response, selection="clusters")

    @pytest.mark.parametrize("poles", [[], [0.0], [np.nan], [[1.0, 2.0]]])
    def test_given_poles(self, poles):
        response = response_of([pole(8, 0.1)], np.ones((1, 1, 1)), LINES)
        with pytest.raises(UsageError, match="poles"):
            fit_poles(response, poles)


def test_match_is_in_the_notes_of_the_model():
    found = identify_modes(rig("dmf").frequency_response("theta_1", "T_T", LINES))
    assert abs(match(found, rig("dmf").modes(measured_input="T_T")).damping_errors[0]) < 1e-6
