"""Pictures of modal identification: what is in them, and in which units."""

import numpy as np
import pytest
from support.modal_cases import chain_residues, pole, response_of

import torsionnet as tn
from torsionnet import plot
from torsionnet.base.errors import UsageError
from torsionnet.modal import Settings, circle_fit, cmif, identify_modes, stabilisation

LINES = np.arange(0.5, 30.01, 0.1)
POLES = [pole(5, 0.02), pole(9, 0.05), pole(9.2, 0.04)]


@pytest.fixture(scope="module")
def diagram():
    return stabilisation(response_of(POLES, chain_residues(POLES, 3, 2)[0], LINES, noise=0.01), Settings("lscf", 12))


def points(axes):
    """Frequency and order of everything drawn as a mark."""
    marks = [line for line in axes.lines if line.get_linestyle() == "None"]
    return {line.get_label(): np.array(line.get_xydata()) for line in marks}


class TestStabilisation:
    def test_every_pole_is_drawn_as_what_it_is(self, diagram):
        axes = plot.stabilisation(diagram).axes[0]
        assert axes.get_ylim() == (0, len(diagram.orders) + 1)
        drawn = points(axes)
        assert sum(len(part) for part in drawn.values()) == sum(len(order.poles) for order in diagram.orders)
        for order in diagram.orders:
            stable = drawn["and in shape"]
            found = np.sort(stable[stable[:, 1] == order.order, 0])
            np.testing.assert_allclose(found, np.sort(np.abs(order.poles[order.stable]) / 2 / np.pi), rtol=1e-12)

    def test_behind_it_is_the_indicator(self, diagram):
        level = plot.stabilisation(diagram).axes[1]
        np.testing.assert_allclose(level.lines[0].get_ydata(), cmif(diagram.response)[:, 0], rtol=1e-12)
        assert len(level.lines) == 2
        assert level.get_ylabel() == "CMIF [rad/(N·m)]"

    def test_modes_are_named_in_the_unit_shown(self, diagram):
        found = identify_modes(diagram, selection="clusters")
        axes = plot.stabilisation(diagram, found, conventions=tn.Conventions(frequency="rpm")).axes[0]
        words = [text.get_text() for text in axes.texts]
        assert words[0] == f"{60 * found.natural_frequencies[0]:.4g} rpm, {100 * found.damping_ratios[0]:.3g} %"
        assert axes.get_xlabel() == "natural frequency |λ|/2π [rpm]"
        lines = [line.get_xdata()[0] for line in axes.lines if len(line.get_xdata()) == 2 and line.get_ydata()[1] == 1]
        np.testing.assert_allclose(lines, 60 * found.natural_frequencies, rtol=1e-12)

    def test_a_mode_beyond_the_band_is_not_named(self):
        response = tn.load("dmf_rig").frequency_response("theta_1", "T_T", LINES)
        full = stabilisation(response)
        found = identify_modes(full)
        assert (len(found), len(found.outside_poles)) == (1, 1)
        assert len(plot.stabilisation(full, found).axes[0].texts) == 1

    def test_names_stand_side_by_side(self):
        from torsionnet.plot.modal_plots import _apart

        assert _apart(np.array([1.0, 5.0]), 1.0, 10) == [1, 5]
        assert _apart(np.array([1.0, 1.2, 1.4]), 1.0, 10) == [1, 2, 3]
        assert _apart(np.array([8.0, 9.5, 9.8]), 1.0, 10) == [8, 9, 10]

    def test_is_written(self, diagram, tmp_path):
        plot.save(plot.stabilisation(diagram, identify_modes(diagram)), tmp_path / "picture.png")
        assert (tmp_path / "picture.png").stat().st_size > 10_000


class TestCircle:
    def test_points_circle_and_pairs(self):
        fit = circle_fit(tn.load("dmf_rig").frequency_response("theta_1", "T_T", LINES), near=8)
        plane, pairs = plot.circle(fit).axes
        around, own, radius, top = plane.lines
        np.testing.assert_allclose(np.hypot(*(around.get_xydata() - [fit.center.real, fit.center.imag]).T), fit.radius)
        np.testing.assert_allclose(own.get_xdata() + 1j * own.get_ydata(), fit.points)
        assert abs(complex(*top.get_xydata()[0]) - fit.center) == pytest.approx(fit.radius)
        assert pairs.lines[0].get_ydata().size == fit.pairs.size
        assert np.median(pairs.lines[0].get_ydata()) == pytest.approx(100 * fit.damping_ratio)
        assert plane.get_ylabel() == "imaginary part [rad/s/(N·m)]"
        assert pairs.get_ylabel() == "damping ratio of each pair [%]"
        assert len(radius.get_xdata()) == 2


class TestMac:
    def test_numbers_and_names(self):
        from matplotlib.colors import to_rgb

        values = np.array([[1.0, 0.25, 0.0], [0.1, np.nan, 0.9]])
        axes = plot.mac_matrix(values, rows=["8.7 Hz", "81 Hz"]).axes[0]
        np.testing.assert_array_equal(np.asarray(axes.images[0].get_array().filled(np.nan)), values)
        assert axes.images[0].get_clim() == (0, 1)
        assert [text.get_text() for text in axes.texts] == ["1.00", "0.25", "0.00", "0.10", "-", "0.90"]
        paper = [text.get_color() == axes.texts[0].get_color() for text in axes.texts]
        assert paper == [True, False, False, False, False, True], "white on dark fields, dark on light ones"
        assert sum(to_rgb(axes.texts[0].get_color())) > sum(to_rgb(axes.texts[1].get_color()))
        assert [tick.get_text() for tick in axes.get_yticklabels()] == ["8.7 Hz", "81 Hz"]
        assert [tick.get_text() for tick in axes.get_xticklabels()] == ["1", "2", "3"]

    def test_many_modes_have_no_numbers(self):
        assert len(plot.mac_matrix(np.eye(30)).axes[0].texts) == 0

    def test_messages(self):
        with pytest.raises(UsageError, match="missing-data"):
            plot.mac_matrix(None)
        with pytest.raises(UsageError, match="wrong-count"):
            plot.mac_matrix(np.eye(2), rows=["a"])
