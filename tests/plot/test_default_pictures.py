"""Pictures and tables at their default call: what says nothing sets no limits."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import torsionnet as tn
from torsionnet import plot
from torsionnet.app.cli.commands.estimate import peak_table
from torsionnet.base.conventions import Conventions
from torsionnet.identification.fit_result import Compared
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.linear.responses.grid import _standing_out
from torsionnet.machinery.design.damper_optimum import DesignParameter
from torsionnet.signals import Recording, Signal, spectrogram
from torsionnet.signals.order_tracking import Harmonics
from torsionnet.signals.orders.tracked_orders import MeasuredOrder, TrackedOrders
from torsionnet.signals.recording import MotionEvent
from torsionnet.signals.stepped_levels import SteppedStiffness
from torsionnet.signals.uncertainty import peak_warnings
from torsionnet.study.study import IN_SI

RATE = 4000.0


def tone(frequency, noise=0.0):
    t = np.arange(20_000) / RATE
    values = np.sin(2 * np.pi * frequency * t) + noise * np.random.default_rng(3).standard_normal(len(t))
    return spectrogram(Recording((Signal("T", "torque", values),), RATE), "T")


@pytest.mark.parametrize(
    ("frequency", "noise", "least", "most"), [(40, 0, 40, 80), (40, 1e-3, 40, 80), (900, 0, 900, 1500)]
)
def test_a_spectrogram_ends_where_the_power_does(frequency, noise, least, most):
    seen = tone(frequency, noise)
    axes = plot.spectrogram(seen).axes[0]
    assert least < axes.get_ylim()[1] < most
    assert axes.collections[0].get_clim()[1] == axes.collections[0].get_array().max()
    assert plot.spectrogram(seen, up_to=1900).axes[0].get_ylim()[1] > 1850


def test_a_spectrogram_of_noise_or_of_nothing_is_shown_whole():
    noise = np.random.default_rng(1).standard_normal(20_000)
    for values in (noise, np.zeros(20_000)):
        seen = spectrogram(Recording((Signal("T", "torque", values),), RATE), "T")
        assert plot.spectrogram(seen).axes[0].get_ylim()[1] > 1950


def estimate(coherent_up_to, usable_up_to=10.0):
    """One mass on a spring up to a frequency, then noise whose phase turns on and on."""
    f = np.linspace(0.5, 2000, 4000)
    values = 1 / (1 - (f / 8) ** 2 + 0.2j * f / 8)
    beyond = f > coherent_up_to
    turns = np.arange(beyond.sum())
    values[beyond] = (1.2 + np.sin(turns)) * 1e-3 * np.exp(-2.5j * turns)
    coherence = np.where(beyond, 0.02, 0.99)
    return FrequencyResponse(
        f, values[:, None, None], (Channel("theta", "rad"),), (Channel("T", "N*m"),), "rig",
        coherence=coherence[:, None, None], usable_up_to=usable_up_to,
    )  # fmt: skip


def test_what_is_not_coherent_turns_no_phase_and_takes_no_room():
    magnitude, phase, _ = plot.bode(estimate(60.0)).axes
    low, high = phase.get_ylim()
    assert low >= -200
    assert high <= 20
    drawn = np.concatenate([line.get_ydata() for line in phase.lines])
    assert np.nanmin(drawn) > -181
    assert 60 < magnitude.get_xlim()[1] < 100


def test_a_response_that_is_coherent_nowhere_is_shown_as_it_is():
    assert plot.bode(estimate(0.1, usable_up_to=0.1)).axes[0].get_xlim()[1] == pytest.approx(2000)


def test_a_model_is_drawn_over_all_its_frequencies():
    response = tn.load("dmf_rig").frequency_response("theta_1", "T_T", np.geomspace(0.1, 1000, 60))
    assert plot.bode(response).axes[0].get_xlim() == pytest.approx((0.1, 1000))


def test_rounding_makes_no_peaks():
    ripple = 1 + 1e-13 * np.random.default_rng(2).standard_normal(500)
    assert _standing_out(ripple) == []
    hill = ripple + np.exp(-(((np.arange(500) - 200) / 10) ** 2))
    (peak,) = _standing_out(np.round(hill, 9))
    assert abs(peak - 200) <= 1
    slope = np.linspace(1, 2, 500) * ripple  # a ripple on a slope rises above nothing
    assert _standing_out(slope) == []
    assert _standing_out(np.array([1.0, np.inf, 1.0])) == [1]


def test_a_coherent_part_is_shown_where_no_sensor_limits_it():
    """As of torque over torque: no steps of an encoder say where it ends, and beyond the sweep is noise."""
    seen = replace(estimate(60.0), usable_up_to=None)
    magnitude, phase, _ = plot.bode(seen).axes
    assert 60 < magnitude.get_xlim()[1] < 100
    assert phase.get_ylim()[0] >= -200
    assert np.nanmin(np.concatenate([line.get_ydata() for line in phase.lines])) > -181
    shares = FrequencyResponse(
        seen.frequencies, np.repeat(seen.values, 2, axis=2), seen.outputs,
        (Channel("T", "N*m"), Channel("T_2", "N*m")), "rig", coherence=np.repeat(seen.coherence / 2, 2, axis=2),
    )  # fmt: skip
    assert 60 < plot.bode(shares).axes[0].get_xlim()[1] < 100  # each of two inputs has half of it


@pytest.mark.parametrize("usable_up_to", [None, 10.0])
def test_a_comparison_ends_where_the_test_does(usable_up_to):
    seen = replace(estimate(60.0), usable_up_to=usable_up_to)
    model = replace(seen, coherence=None, usable_up_to=None)
    assert 60 < plot.comparison(seen, model).axes[0].get_xlim()[1] < 100
    (phase,) = (axes for axes in plot.comparison(seen, model).axes if axes.get_ylabel() == "phase [deg]")
    calculated = phase.lines[0].get_ydata()
    assert phase.get_ylim()[0] < np.nanmin(calculated)
    assert np.nanmax(calculated) < phase.get_ylim()[1]
    nowhere = replace(estimate(0.1), usable_up_to=None)
    assert plot.comparison(nowhere, model).axes[0].get_xlim()[1] == pytest.approx(2000)


def test_peaks_of_noise_are_no_peaks():
    """Higher than what is coherent, they would hide its peak, and be listed by the thousand."""
    seen = replace(estimate(60.0), usable_up_to=None)
    noisy = replace(seen, values=np.where(seen.frequencies[:, None, None] > 60, 1e6 * seen.values, seen.values))
    rows = peak_table(noisy, tn.Conventions()).rows
    assert [(row[2], round(row[3])) for row in rows] == [("first line", 0), ("peak 1", 8)]
    assert peak_warnings(noisy, 0.5) == peak_warnings(noisy.between(0, 60), 0.5)


@pytest.mark.parametrize("decibels", [False, True])
def test_rounding_is_not_enlarged(decibels):
    f = np.linspace(1, 50, 200)
    values = 1 + 1e-16 * np.random.default_rng(2).integers(-1, 2, len(f)) + 0j
    flat = FrequencyResponse(f, values[:, None, None], (Channel("T", "N*m"),), (Channel("T_2", "N*m"),))
    low, high = plot.bode(flat, decibels=decibels).axes[0].get_ylim()
    assert (low, high) == pytest.approx((-4.437, 4.609) if decibels else (0.6, 1.7), rel=1e-3)


LARGE = """torsionnet: 1
name: large fan
parameters: {c: {value: 20 kN*m*s/rad, bounds: [2 kN*m*s/rad, 200 kN*m*s/rad]}}
elements:
  motor: {type: inertia, node: m, inertia: 500 kg*m^2}
  shaft: {type: spring, nodes: [m, f], stiffness: 40 MN*m/rad, damping: c}
  fan: {type: inertia, node: f, inertia: 2000 kg*m^2}
speeds: {of: m, range: 300..900 rpm, step: 20 rpm}
excitations: {motor: {type: harmonic, node: m, orders: {6: {amplitude: 20 kN*m}}}}
sensors: {T_s: {torque: shaft}}
"""


def test_large_torques_are_drawn_in_kilonewtonmetres():
    from torsionnet.plot.order_overlay_plot import order_overlay

    """In every picture with an axis of torque; up to 990 N m in N m."""
    model = tn.loads(LARGE)
    run = model.order_response("T_s")
    largest = float(abs(run.values).max())
    assert largest > 2e4
    test = {"T_s": [MeasuredOrder(6, np.array([40.0, 60.0]), np.array([2e4, 3e4]))]}
    record = Recording((Signal("T_s", "torque", np.array([0, -3e5, 1e5])),), RATE)
    design = model.damper_design("T_s", "c")
    for axes in (
        plot.order_response(run).axes[0], order_overlay(run, test).axes[0],
        plot.time_histories(record).axes[0], *plot.damper_design(design).axes,
    ):  # fmt: skip
        assert axes.get_ylabel().endswith("[kN·m]")
    assert plot.time_histories(record).axes[0].lines[0].get_ydata().tolist() == [0, -300, 100]
    assert order_overlay(run, test).axes[0].lines[1].get_ydata().tolist() == [20, 30]
    levels, effect = plot.damper_design(design).axes
    assert levels.get_xlim() == pytest.approx(tuple(design.curves[0].points[[0, -1]]))
    assert levels.lines[0].get_ydata().max() == pytest.approx(design.before.level / 1e3, rel=1e-3)
    assert effect.lines[1].get_ydata()[0] == pytest.approx(design.after.level / 1e3)
    (bar,) = [text.get_text() for text in plot.waterfall(run).axes[0].texts if "N" in text.get_text()]
    assert bar == f"{float(f'{largest:.1g}') / 1e3:g} kN·m"
    small = Recording((Signal("T_s", "torque", np.array([0, -990.0])),), RATE)
    assert plot.time_histories(small).axes[0].get_ylabel() == "T_s [N·m]"


def test_pictures_have_the_title_that_is_given_and_amplitudes_over_speed_begin_at_zero():
    from torsionnet.plot.order_overlay_plot import order_overlay
    from torsionnet.plot.order_response_plot import half_ranges
    from torsionnet.plot.signal_plots import stepped_stiffness

    run = tn.loads(LARGE).order_response("T_s")
    test = {"T_s": [MeasuredOrder(6, np.array([40.0, 60.0]), np.array([2e4, 3e4]))]}
    record = Recording((Signal("T_s", "torque", np.array([0, -3e5, 1e5])),), RATE)
    over_speed = [
        plot.order_response(run, title="x"), half_ranges([run], title="x"), order_overlay(run, test, title="x")
    ]  # fmt: skip
    for figure in over_speed:
        assert figure.axes[0].get_ylim()[0] == 0
    for figure in over_speed[:2]:
        assert figure.axes[0].get_xlim() == pytest.approx(run.rpm[[0, -1]].tolist())
    for figure in (*over_speed, plot.waterfall(run, title="x"), plot.time_histories(record, title="x")):
        assert figure.get_suptitle() == "x"
    assert [figure.get_suptitle() for figure in (half_ranges([run]), plot.waterfall(run))] == ["T_s", run.title]
    stepped = SteppedStiffness(*np.array([[4.0], [0.1], [46.0], [0], [0], [0]]), title="bench")
    titles = [stepped_stiffness(one, title=title).get_suptitle()
              for one, title in ((stepped, "x"), (stepped, ""), (replace(stepped, title=""), ""))]  # fmt: skip
    assert titles == ["x", "bench", "Stiffness over amplitude"]
    two = half_ranges([run, run], labels=["wet", "dry"])
    assert [text.get_text() for text in two.legends[0].get_texts()] == ["wet", "dry"]


@pytest.mark.parametrize(("rpm", "low", "high"), [([929.9999, 930.0001], 920.7, 939.3), ([870, 990], 870, 990)])
def test_a_steady_speed_stands_in_the_middle_of_plain_numbers(rpm, low, high):
    values = np.ones((1, 2))
    orders = TrackedOrders(
        "T", "torque", np.array([0.5]), np.arange(2.0), np.multiply(rpm, np.pi / 30), values, values / 100
    )
    figure = plot.tracked_orders(orders)
    axes = figure.axes[-1]
    assert axes.get_xlim() == pytest.approx((low, high), abs=0.01)
    figure.canvas.draw()
    assert not axes.xaxis.get_offset_text().get_text()
    assert axes.lines[0].get_marker() == ("o" if high - low < 30 else "None")


def test_measured_orders_are_drawn_over_rising_speeds_with_half_range_and_intervals():
    """An order of 3 and 5 kN m with 1 kN m to either side, falling speeds, and an unclear phase at the slower one."""
    values, widths = np.array([[3e3, 5e3j]]), np.array([[5e2, 4e3]])
    shown = TrackedOrders(
        "T", "torque", np.array([0.5]), np.arange(2.0), np.multiply([990, 870], np.pi / 30), values, widths,
        half_range=np.array([4e3, 6e3]), reference="a pulse",
    )  # fmt: skip
    top, phase = plot.tracked_orders(shown).axes
    lines = {line.get_label(): line.get_xydata().tolist() for line in top.lines}
    assert lines.keys() == {"half range", "order 0.5"}
    assert lines["half range"] == [pytest.approx([870, 6]), pytest.approx([990, 4])]
    assert lines["order 0.5"] == [pytest.approx([870, 5]), pytest.approx([990, 3])]
    band = {tuple(point) for point in np.round(top.collections[0].get_paths()[0].vertices, 6)}
    assert band == {(870, 1), (870, 9), (990, 2.5), (990, 3.5)}
    assert phase.lines[0].get_ydata().tolist() == pytest.approx([np.nan, 0], nan_ok=True)
    assert (phase.get_ylim(), top.get_ylim()[0]) == ((-180, 180), 0)


@pytest.mark.parametrize(("lowest", "unit"), [(90.0, "rpm"), (-1.0, "rad/s")])
def test_the_speed_of_a_shaft_that_turns_on_is_drawn_in_rpm(lowest, unit):
    record = Recording((Signal("n", "velocity", np.linspace(lowest, 100, 50)),), RATE)
    axes = plot.time_histories(record).axes[0]
    assert axes.get_ylabel() == f"n [{unit}]"
    assert axes.lines[0].get_ydata()[-1] == pytest.approx(100 * 30 / np.pi if unit == "rpm" else 100)


@pytest.mark.parametrize(("time", "side"), [(2.0, "left"), (8.0, "right")])
def test_the_name_of_an_event_has_its_room_inside_the_panel(time, side):
    from torsionnet.plot.histories import scenario_motion

    signals = (Signal("T", "torque", np.sin(np.arange(1001.0))),)
    record = Recording(signals, 100.0, events=(MotionEvent(time, "clutch", "sticks"),))
    (text,) = scenario_motion(record).axes[0].texts
    assert (text.get_text(), text.get_ha()) == ("clutch: sticks", side)


def test_harmonics_of_a_sweep_have_the_name_of_their_signal_and_their_orders():
    from torsionnet.plot.signal_plots import sweep_harmonics

    sizes = np.array([[1.0, 0.1], [2.0, 0.2], [1.0, 0.4]])
    found = Harmonics(np.arange(3.0), np.array([10.0, 20, 30]), (1.0, 2.0), sizes, -170 * sizes, "T", "N*m")
    figure = sweep_harmonics(found)
    size, phase = figure.axes
    assert figure.get_suptitle() == "T"
    assert sweep_harmonics(found, title="other").get_suptitle() == "other"
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["1x", "2x"]
    assert [line.get_ydata().tolist() for line in size.lines] == sizes.T.tolist()
    assert np.abs(np.diff(phase.lines[0].get_ydata())).max() < 180  # no jumps by a turn
    assert (size.get_ylabel(), phase.get_xlabel()) == ("amplitude [N·m]", "frequency of the sweep [Hz]")


@pytest.mark.parametrize("step", [20.0, 1e-4])
def test_fitted_orders_are_drawn_over_speed_in_rpm(step):
    """One steady speed stands in the middle."""
    from matplotlib.figure import Figure

    from torsionnet.plot.fits import order_colours, order_column

    speeds = 60.0 + step * np.arange(-1, 2)
    one = Compared(
        "run up", speeds, np.array([1.0, 3, 2j]), np.array([1.0, 2, 2j]), np.full(3, 0.5), 1.0, "N*m",
        orders=np.full(3, 6.0), speeds=speeds,
    )  # fmt: skip
    panels = list(Figure().subplots(3, 1, sharex=True))
    order_column(panels, one, Conventions(), order_colours([one]))
    rpm = speeds * 30 / np.pi
    low, high = panels[2].get_xlim()
    assert low <= rpm[0] < rpm[-1] <= high
    assert high - low < max(1.5 * np.ptp(rpm), 0.03 * rpm[1])
    assert (low + high) / 2 == pytest.approx(rpm[1])
    assert [line.get_xdata().tolist() for line in panels[2].lines] == [pytest.approx(rpm)] * 2
    assert panels[2].lines[0].get_ydata().tolist() == [0, 2, 0]  # residuals over standard deviations


def test_the_worst_condition_of_a_family_has_the_largest_use_of_any_criterion():
    from torsionnet.plot.limit_plot import LimitFamily

    def used(*shares):
        return None, tuple(SimpleNamespace(worst=0, utilisation=np.array([share])) for share in shares)

    assert LimitFamily((used(0.5, 0.6), used(0.2, 0.9), used(0.7, 0.7))).worst == 1
    assert LimitFamily((used(0.5), (None, (SimpleNamespace(worst=None, utilisation=None),)))).worst == 0


@pytest.mark.parametrize("count", [1, 4])
def test_parameters_and_their_bounds_are_inside_the_panel(count):
    """The first on top; little room is left beside the bounds."""
    from matplotlib.figure import Figure

    from torsionnet.plot.study.designs import _draw_places
    from torsionnet.plot.study.distributions import _places

    names = [f"k_{number}" for number in range(count)]
    panels = Figure().subplots(1, 2)
    _draw_places(panels[0], tuple(DesignParameter(name, "N*m/rad", 2.0, 1.0, 3.0, 2.5) for name in names), IN_SI)
    worst = SimpleNamespace(
        variant=dict.fromkeys(names, 2.5), tolerance=dict.fromkeys(names, (1.0, 3.0)), direction="largest"
    )
    _places(panels[1], [worst], names)
    for axes, best in zip(panels, (axes.lines[-1] for axes in panels), strict=True):
        bottom, top = axes.get_ylim()
        assert top < 0 <= count - 1 < bottom
        left, right = axes.get_xlim()
        assert -0.1 < left < 0
        assert 1 < right < 1.1
        assert set(best.get_xdata()) == {0.75}  # three quarters of the way from 1 to 3


def test_labels_of_curves_are_configurations_also_of_a_model_with_brackets_in_its_name():
    def rig(name):
        spring = tn.Spring("s", nodes=("a", "ground"), stiffness="k")
        return tn.Drivetrain(
            name, [tn.Inertia("r", node="a", inertia=0.5), spring], parameters={"k": 100},
            configurations={"soft": {"k": 50}, "stiff": {"k": 200}}, inputs={"T": {"torque": "a"}},
            sensors={"th": {"angle": "a"}},
        )  # fmt: skip

    def said(responses):
        figure = plot.bode(responses)
        legends = [panel.get_legend() for panel in figure.axes if panel.get_legend()] + figure.legends
        return figure.get_suptitle(), [text.get_text() for legend in legends for text in legend.get_texts()]

    f = np.linspace(1, 5, 5)
    left, right = rig("rig (left)"), rig("rig (right)")
    cases = [left.configured(name) for name in ("soft", "stiff")]
    assert said([one.frequency_response("th", "T", f) for one in cases]) == ("rig (left)", ["soft", "stiff"])
    assert said([one.symbolic().transfer_function("th", "T").evaluate(f) for one in cases])[1] == ["soft", "stiff"]
    both = [one.frequency_response("th", "T", f) for one in (left, right)]
    assert said(both) == ("", ["rig (left)", "rig (right)"])
    variants = list(cases[0].frequency_responses("th", "T", f, {"k": [50.0, 60.0]}))
    assert said(variants) == ("rig (left)", ["soft, k = 50", "soft, k = 60"])


def test_colours_of_a_tornado_reach_the_largest_change_of_either_sign():
    from torsionnet.plot.study.study_tornado import _matrix

    swings = SimpleNamespace(at_low=np.array([1.0, np.nan]), at_high=np.array([-2.0, 5.0]))
    result = SimpleNamespace(parameter_units={"k": "", "c": ""}, spans={"a": None}, units={"f": "Hz"})
    result.swings = {("a", "f"): swings}
    assert _matrix(result, IN_SI, None).panels[0].images[0].get_clim() == (-3, 3)


def test_teeth_of_a_wheel_fill_their_axis():
    from matplotlib.figure import Figure

    from torsionnet.plot.signal_plots import _teeth

    pattern = SimpleNamespace(teeth=36, missing=1, positions=np.zeros(36), half_widths=np.ones(36))
    axes = Figure().add_subplot()
    _teeth(axes, SimpleNamespace(pattern=pattern), 1.0)
    assert axes.get_xlim() == (-0.5, 35.5)
    assert axes.lines[-1].get_xdata().tolist() == list(range(35))
