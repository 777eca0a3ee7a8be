"""MAC, MSF, MPC, CMIF and the comparison of identified modes with a model's."""

import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from support.modal_cases import chain_residues, pole, response_of

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import Channel
from torsionnet.modal import cmif, identify_modes, match
from torsionnet.modal.matching import mac, mpc, msf
from torsionnet.model.channels import Input
from torsionnet.signals import frac

LINES = np.arange(0.5, 30.01, 0.1)
numbers = st.floats(-10, 10).map(lambda x: round(x, 3))
shapes = arrays(float, (4, 3), elements=numbers)


def random_shapes(seed=0, count=3, sensors=5):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(sensors, count)) + 1j * rng.normal(size=(sensors, count))


@pytest.fixture
def tools():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pytest.importorskip("sdypy.EMA").tools


class TestAgainstSdypy:
    def test_mac(self, tools):
        a, b = random_shapes(1), random_shapes(2, count=4)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            theirs = tools.MAC(a, b)
        np.testing.assert_allclose(mac(a, b), theirs, rtol=1e-12)

    def test_msf_of_real_shapes(self, tools):
        a, b = random_shapes(1).real, random_shapes(2).real
        np.testing.assert_allclose(msf(a, b), tools.MSF(a, b), rtol=1e-12)

    def test_mpc_is_what_their_complexity_lacks_to_one(self, tools):
        a = random_shapes(3)
        np.testing.assert_allclose(mpc(a), 1 - tools.MCF(a), rtol=1e-12)


class TestProperties:
    @given(shapes, shapes, st.complex_numbers(min_magnitude=0.1, max_magnitude=10))
    def test_factors_change_nothing_but_the_scale_factor(self, x, y, factor):
        a = x + 1j * y
        if (np.linalg.norm(a, axis=0) < 1e-2).any():
            return
        np.testing.assert_allclose(np.diag(mac(a, factor * a)), 1, rtol=1e-9)
        np.testing.assert_allclose(msf(a, factor * a), factor, rtol=1e-9)
        np.testing.assert_allclose(mpc(factor * a), mpc(a), atol=1e-9)
        assert np.all((mac(a, a) >= 0) & (mac(a, a) <= 1 + 1e-12))
        np.testing.assert_allclose(mpc(x[:, np.linalg.norm(x, axis=0) > 1e-2]), 1, rtol=1e-12)

    def test_orthogonal_shapes(self):
        q = np.linalg.qr(random_shapes(4))[0]
        np.testing.assert_allclose(mac(q, q), np.eye(3), atol=1e-12)

    def test_scale_factor_brings_closest(self):
        a, b = random_shapes(5, 1), random_shapes(6, 1)
        factor = msf(a, b)[0]
        best = np.linalg.norm(factor * a - b)
        for other in (1.01, 0.99, 1 + 0.01j, 1 - 0.01j):
            assert np.linalg.norm(other * factor * a - b) > best

    def test_circular_motion_has_no_collinearity(self):
        turn = np.exp(2j * np.pi * np.arange(7) / 7)
        assert mpc(turn) == pytest.approx(0, abs=1e-12)

    def test_rows_that_are_unknown_are_left_out(self):
        a, b = random_shapes(1), random_shapes(2)
        gap = a.copy()
        gap[2] = np.nan
        kept = [0, 1, 3, 4]
        np.testing.assert_allclose(mac(gap, b), mac(a[kept], b[kept]), rtol=1e-12)
        assert np.isnan(mac(np.zeros(3), np.ones(3))).all()

    @pytest.mark.parametrize(
        ("call", "message"),
        [
            (lambda: mac(np.ones(3), np.ones(4)), "wrong-count"),
            (lambda: mac(np.full(3, np.nan), np.ones(3)), "missing-data"),
            (lambda: msf(np.ones((3, 2)), np.ones(3)), "wrong-count"),
            (lambda: mpc(np.ones((2, 2, 2))), "sensors by modes"),
        ],
    )
    def test_messages(self, call, message):
        with pytest.raises(UsageError, match=message):
            call()


class TestCmif:
    def test_two_by_two_in_closed_form(self):
        """Singular values of a 2 x 2 matrix from its norm and determinant."""
        poles = [pole(6, 0.02), pole(11, 0.03)]
        response = response_of(poles, chain_residues(poles, 2, 2)[0], LINES)
        total = np.sum(response.magnitude**2, axis=(1, 2))
        values = response.values
        product = np.abs(values[:, 0, 0] * values[:, 1, 1] - values[:, 0, 1] * values[:, 1, 0])
        root = np.sqrt(total**2 / 4 - product**2)
        np.testing.assert_allclose(cmif(response)[:, 0], np.sqrt(total / 2 + root), rtol=1e-9)
        np.testing.assert_allclose(cmif(response)[:, 1] * cmif(response)[:, 0], product, rtol=1e-9)

    def test_one_input_gives_the_length(self):
        poles = [pole(6, 0.02)]
        response = response_of(poles, chain_residues(poles, 3)[0], LINES)
        np.testing.assert_allclose(cmif(response)[:, 0], np.linalg.norm(response.values[:, :, 0], axis=1), rtol=1e-12)

    def test_a_repeated_pole_lifts_two_curves(self):
        poles = [pole(11, 0.01), pole(11, 0.01)]
        curves = cmif(response_of(poles, chain_residues(poles, 3, 2)[0], LINES))
        assert [LINES[np.argmax(curve)] for curve in curves.T] == pytest.approx([11, 11], abs=0.11)

    def test_unlike_quantities_are_balanced(self):
        poles = [pole(6, 0.02)]
        response = response_of(poles, chain_residues(poles, 2)[0], LINES)
        response.values[:, 1] *= 1e9
        mixed = tn.FrequencyResponse(
            LINES, response.values, (Channel("a", "rad"), Channel("T", "N*m")), response.inputs
        )
        response.values[:, 1] *= 1e-6
        other = tn.FrequencyResponse(LINES, response.values, mixed.outputs, mixed.inputs)
        np.testing.assert_allclose(cmif(mixed), cmif(other), rtol=1e-9)


def test_frac_of_a_fit_is_one():
    poles = [pole(6, 0.2), pole(11, 0.3)]
    response = response_of(poles, chain_residues(poles, 2)[0], LINES)
    np.testing.assert_allclose(frac(identify_modes(response).synthesised, response), 1, atol=1e-10)


class TestMatch:
    def rig(self):
        return tn.load("amt_rig").configured("II")

    def identified(self, outputs=("angle(motor)", "angle(input_shaft)")):
        return identify_modes(self.rig().frequency_response(list(outputs), "T_T", LINES))

    def test_with_the_cut_system(self):
        names = {"angle(motor)": "motor", "angle(input_shaft)": "input_shaft"}
        paired = match(self.identified(), self.rig().modes(measured_input="T_T"), nodes=names)
        assert np.abs(paired.frequency_errors).max() < 1e-6
        assert np.abs(paired.damping_errors).max() < 1e-6
        np.testing.assert_allclose(np.diag(paired.mac), 1, atol=1e-9)
        row = paired.table().rows[0]
        assert row[:2] == (1, 1)
        assert row[8] == pytest.approx(1)

    @pytest.mark.slow
    def test_with_the_whole_rig_shows_what_is_wrong(self):
        """Against a measured torque the first mode is 16 % higher than that of the whole rig: 3.945 to 3.409 Hz."""
        paired = match(self.identified(), self.rig().modes())
        assert paired.frequency_errors[0] == pytest.approx(3.94533 / 3.40910 - 1, rel=1e-4)
        assert paired.damping_errors[0] == pytest.approx(0.244878 / 0.229278 - 1, rel=1e-4)
        assert paired.mac is None
        assert "two or more common sensors" in paired.notes[0]

    @pytest.mark.slow
    def test_shapes_tell_crossed_modes_apart(self):
        """Two modes whose frequencies have changed sides between test and model."""
        poles = [pole(10, 0.02), pole(10.4, 0.02)]
        residues, shapes = chain_residues(poles, 4)
        found = identify_modes(response_of(poles, residues, LINES))
        paired = match(found, poles, shapes=shapes[:, ::-1])
        assert paired.model.tolist() == [1, 0]
        assert match(found, poles).model.tolist() == [0, 1]

    def test_modes_without_partner_are_listed(self):
        poles = [pole(5, 0.02), pole(12, 0.02)]
        found = identify_modes(response_of(poles, chain_residues(poles, 2)[0], LINES))
        paired = match(found, [pole(5.1, 0.02), pole(28, 0.02), pole(29, 0.02)])
        assert (paired.identified.tolist(), paired.model.tolist()) == ([0], [0])
        rows = paired.table().rows
        assert [row[:2] for row in rows] == [(1, 1), (2, None), (None, 2), (None, 3)]
        assert rows[0][4] == pytest.approx(100 * (5 / 5.1 - 1), rel=1e-4)
        assert len(match(found, [pole(28, 0.02)]).identified) == 0

    def test_rigid_bodies_are_left_out(self):
        free = tn.Drivetrain(
            "free",
            [
                tn.Inertia("a", "motor", inertia=1),
                tn.Spring("k", ["motor", "load"], stiffness=1000, damping=1),
                tn.Inertia("b", "load", inertia=2),
            ],
            inputs={"T": Input("torque", "motor")},
        )
        response = free.frequency_response(["angle(motor)", "angle(load)"], "T", LINES)
        found = identify_modes(response)
        paired = match(found, free.modes(), nodes={"angle(motor)": "motor", "angle(load)": "load"})
        assert len(paired.model_poles) == 1
        assert paired.frequency_errors == pytest.approx(0, abs=1e-6)
        assert paired.mac[0, 0] == pytest.approx(1)

    @pytest.mark.slow
    def test_messages(self):
        found = self.identified()
        with pytest.raises(UsageError, match=r'did you mean "angle\(motor\)"'):
            match(found, self.rig().modes(), nodes={"angle(moter)": "motor"})
        with pytest.raises(UsageError, match=r'(?s)"moter".*"motor".*unknown-node'):
            match(found, self.rig().modes(), nodes={"angle(motor)": "moter"})
        with pytest.raises(UsageError, match=r"2 .* 3 by 1"):
            match(found, [pole(4, 0.2)], shapes=np.ones((3, 1)))
