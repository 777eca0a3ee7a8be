"""Pictures of studies: what stands on their axes, in which units, and that odd studies have pictures too."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.units import RPM
from torsionnet.study import define, run_study
from torsionnet.study.answers.map_and_scatter import MapResult, ParallelCoordinatesResult, ParameterMap
from torsionnet.study.answers.yield_answer import PercentileBandsResult, YieldResult, limited_values
from torsionnet.study.quantities.quantity import QuantityForm, QuantityLimit
from torsionnet.study.study import IN_SI, ShownUnits, shown_units

X = np.geomspace(10.0, 1000.0, 5)
Y = np.linspace(1.0, 2.0, 4)


def a_map(values, x=X, y=Y, limit=None, cases=("",)):
    maps = {case: ParameterMap(x, y, values) for case in cases}
    return MapResult("map", ("k_1", "N*m/rad"), ("c", ""), ("theta", "rad"), "fixed", maps, limit)


def rising():
    return np.add.outer(np.arange(5.0), np.arange(4.0)) + 1


def drawn(figure, path):
    """Everything is laid out once, so that whatever cannot be is seen."""
    figure.savefig(path / "figure.png", dpi=40)
    return figure


class TestContourMap:
    def test_an_axis_has_equal_factors_where_its_values_have(self):
        axes = a_map(rising()).figure().axes[0]
        assert (axes.get_xscale(), axes.get_yscale()) == ("log", "linear")

    def test_units_of_the_author(self):
        units = ShownUnits({"k_1": "kN*m/rad", "theta": "deg"})
        found = a_map(rising(), limit=QuantityLimit(below=3.0))
        figure = found.figure(units=units)
        axes, bar = figure.axes
        assert axes.get_xlim() == pytest.approx((0.01, 1.0))
        assert "kN·m/rad" in axes.get_xlabel()
        assert "deg" in bar.get_ylabel()
        assert bar.lines[-1].get_ydata()[0] == pytest.approx(np.degrees(3.0))

    def test_values_over_decades_have_colours_by_factors(self):
        assert a_map(10.0 ** rising()).figure().axes[1].get_yscale() == "log"

    @pytest.mark.few(1)
    @pytest.mark.parametrize("values", [np.full((5, 4), 3.0), np.zeros((5, 4)), np.full((5, 4), np.nan)])
    def test_constants_and_nothing(self, values, tmp_path):
        figure = drawn(a_map(values).figure(), tmp_path)
        said = [text.get_text() for text in figure.axes[0].texts]
        assert said == (["no point has a value"] if np.isnan(values).any() else [])

    def test_each_configuration_keeps_its_own_axis(self):
        """Values in per cent are those of each configuration."""
        found = a_map(rising(), cases=("a", "b"))
        found.maps["b"] = ParameterMap(2 * X, Y, rising())
        first, second = found.figure().axes[:2]
        assert first.get_xlim() == pytest.approx((10, 1000))
        assert second.get_xlim() == pytest.approx((20, 2000))


LONG = (
    "torsional_stiffness_of_the_intermediate_shaft_behind_the_gearbox",
    "dampingOfTheElasticCouplingBetweenEngineAndGearbox",
    "largest vibratory torque of the elastic coupling in all firing conditions",
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cases", "limit"), [(1, 300.0), (2, 3.0), (5, 300.0), pytest.param(12, 3.0, marks=pytest.mark.nightly)]
)
def test_labels_of_maps_stay_in_the_picture(cases, limit):
    """Names that are sentences, with units, in one map and in many; a limit on the bar of colours and beyond it."""
    labels = [f"firing=misfire_of_cylinder_{n}, temperature=warm" for n in range(cases)] if cases > 1 else [""]
    maps = {case: ParameterMap(X, Y, np.where(rising() > 7, np.nan, rising())) for case in labels}
    x, y, quantity = zip(LONG, ("N*m/rad", "N*m*s/rad", "N*m"), strict=True)
    found = MapResult("map", x, y, quantity, "largest", maps, QuantityLimit(below=limit))
    assert _misplaced(found.figure(title="A title of so many words that it takes two lines " * 3)) == []


def test_names_of_cases_that_take_more_lines_make_a_picture_of_maps_higher():
    """Names of one line, of two, and of four, above the one row of maps."""
    from torsionnet.plot.study.over_parameters import LABEL_LINE

    names = ("a", "a b" * 25, "a b" * 50)
    heights = [a_map(rising(), cases=(name, "other")).figure().get_figheight() for name in names]
    assert np.diff(heights) == pytest.approx([LABEL_LINE, 2 * LABEL_LINE])


def _misplaced(figure):
    """Texts that are not within the picture, and pairs of them that lie over each other."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.text import Text

    FigureCanvasAgg(figure).draw()
    texts = [one for one in figure.findobj(Text) if one.get_visible() and one.get_text().strip()]
    # Ticks beyond the ends of an axis are not drawn; numbers on lines of a map may touch them.
    outside = {
        id(label)
        for axes in figure.axes
        for axis in (axes.xaxis, axes.yaxis)
        for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks())
        for label in (tick.label1, tick.label2)
        if not min(axis.get_view_interval()) <= tick.get_loc() <= max(axis.get_view_interval())
    }
    on_lines = {id(one) for axes in figure.axes for one in axes.texts if not one.get_text().startswith("limit")}
    boxes = [(one.get_text(), one.get_window_extent()) for one in texts if id(one) not in outside | on_lines]
    edge = figure.bbox
    found = [text for text, box in boxes if min(box.x0, box.y0) < 0 or box.x1 > edge.x1 or box.y1 > edge.y1]
    return found + [
        (text, other)
        for place, (text, box) in enumerate(boxes)
        for other, beside in boxes[place + 1 :]
        if box.shrunk(0.95, 0.8).overlaps(beside.shrunk(0.95, 0.8))
    ]


class _Asked:
    """What a histogram asks of its study."""

    def __init__(self, limit):
        self.limits = {"f_1": limit}
        self.quantities = {"f_1": self}
        self.configurations = ("",)

    def model_in(self, _):
        return None

    def measured(self, *_):
        return QuantityForm("rad")


def histogram(values, limit=QuantityLimit(below=3.0)):  # noqa: B008 - frozen
    found = limited_values(_Asked(limit), "as given", "f_1", np.asarray(values, dtype=float))
    return YieldResult("yield", (), 0.95, 0, "", exhaustive=False, distributions=found)


class TestLimitShares:
    def test_all_variants_are_in_the_histogram(self):
        """Of few variants the outermost lie beyond percentiles that are read between them."""
        assert histogram(np.arange(40.0)).distributions[0].counts.sum() == 40

    def test_constants_are_a_line_at_their_value_with_the_limit(self):
        axes = histogram([2.0, 2.0, 2.0]).figure().axes[0]
        value, limit = axes.lines
        assert list(value.get_xdata()) == [2.0, 2.0]
        assert list(limit.get_xdata()) == [3.0, 3.0]
        assert axes.get_xlim()[0] < 2 < 3 < axes.get_xlim()[1]

    def test_a_limit_far_off_is_told(self):
        axes = histogram([2.0, 2.1, 2.2], QuantityLimit(below=300.0)).figure().axes[0]
        assert axes.get_xlim()[1] < 3
        assert [text.get_text() for text in axes.texts] == ["limit 300 rad →"]

    def test_in_degrees(self):
        axes = histogram([2.0, 2.5, 3.5]).figure(units=ShownUnits({"f_1": "deg"})).axes[0]
        assert axes.lines[0].get_xdata()[0] == pytest.approx(np.degrees(3.0))
        assert "deg" in axes.get_xlabel()

    def test_the_largest_values_of_a_curve_have_its_unit(self):
        axes = histogram([[1.0, 2.0], [1.5, 2.5]]).figure(units=ShownUnits({"f_1": "deg"})).axes[0]
        assert axes.get_xlabel() == "largest f_1 [deg]"
        assert axes.lines[0].get_xdata()[0] == pytest.approx(np.degrees(3.0))

    def test_no_values(self, tmp_path):
        axes = drawn(histogram([np.nan, np.nan]).figure(), tmp_path).axes[0]
        assert [text.get_text() for text in axes.texts] == ["no variant has a value"]


def test_bands_over_speed_are_over_revolutions_a_minute():
    speeds = np.array([600.0, 900.0, 1500.0]) / RPM
    lines = {"": np.array([[1.0, 2, 1], [2.0, 3, 2], [3.0, 4, 3]])}
    found = PercentileBandsResult("bands", "T", QuantityForm("N*m", "speed", speeds), (2.5, 50.0, 97.5), lines)
    axes = found.figure().axes[0]
    assert axes.get_xlim() == pytest.approx((600, 1500))
    assert "r/min" in axes.get_xlabel()


def rig(count, cases=1):
    """A chain whose springs have names that are sentences."""
    names = [f"torsional_stiffness_of_the_intermediate_shaft_{n}" for n in range(count)]
    parts = [tn.Inertia(f"disc_{n}", node=f"n_{n}", inertia=0.1) for n in range(count)]
    parts += [
        tn.Spring(f"s_{n}", nodes=(f"n_{n}", f"n_{n + 1}" if n < count - 1 else "ground"), stiffness=name, damping="c")
        for n, name in enumerate(names)
    ]
    more = {f"firing_condition_{n}": {names[0]: f"{2 + n / 10} kN*m/rad"} for n in range(cases)} if cases > 1 else {}
    values = dict.fromkeys(names, "2 kN*m/rad") | {"c": "2 N*m*s/rad"}
    return tn.Drivetrain(
        "chain", parts, parameters=values, configurations=more, inputs={"T": {"torque": "n_0"}},
        sensors={"theta": {"angle": "n_0"}},
    ), names  # fmt: skip


ASKED = {
    "first_natural_frequency_of_the_chain": {"type": "natural_frequency", "mode": 1},
    "twist": {"type": "response", "output": "theta", "input": "T", "at": "5 Hz"},
    "never": {"type": "expression", "of": "sqrt(-twist*twist)"},
    "curve": {"type": "response", "output": "theta", "input": "T", "band": "1..50 Hz", "points": 12},
}
LIMITS = {"twist": {"below": "0.1 deg/(N*m)"}, "never": {"below": 1.0}}
ANSWERS = {
    "yield": {"type": "yield"},
    "tornado": {"type": "tornado"},
    "bands": {"type": "percentile_bands", "quantity": "curve"},
    "lines": {"type": "parallel_coordinates"},
    "scatter": {"type": "scatter", "quantities": ["twist"]},
    "shares": {"type": "sobol_indices", "quantities": ["twist"], "count": 64},
    "rare": {"type": "failure_probability", "limits": ["twist"], "method": "subset", "count": 200},
}


def test_ends_of_parallel_axes_have_four_digits():
    columns = {"k": np.array([123.456, 234.567]), "f": np.array([1.23456, 2.34567])}
    found = ParallelCoordinatesResult("lines", dict.fromkeys(columns, ""), {"": columns}, {"": np.zeros(2, bool)}, {})
    (axes,) = found.figure().axes
    assert [text.get_text() for text in axes.texts] == ["123.5", "234.6", "1.235", "2.346"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("parameters", "cases"),
    [(1, 1), (2, 3), *(pytest.param(*wide, marks=pytest.mark.nightly) for wide in ((2, 18), (12, 1)))],
)
def test_odd_studies_have_pictures(parameters, cases, tmp_path):
    """One parameter or many with long names, many configurations, a quantity without values."""
    model, names = rig(parameters, cases)
    vary = {name: {"type": "normal", "deviation": "5 %"} for name in names}
    answers = ANSWERS | {"worst": {"type": "worst_case", "quantity": "twist", "tried": 5}} if cases == 1 else ANSWERS
    study = define(
        model, vary, ASKED, configurations="all" if cases > 1 else (), sampling={"count": 20}, limits=LIMITS,
        answers=answers,
    )  # fmt: skip
    result, units = run_study(study), shown_units(study)
    for name, answer in study.answers.items():
        figure = drawn(answer.conclude(study, result).figure(units=units), tmp_path)
        assert figure.get_figheight() < 40, name
        assert _overlapping(figure) == [], name


def _overlapping(figure):
    """Numbers and names that lie over each other on one axis, and titles over those of the panels beside them."""
    figure.canvas.draw()
    groups = [
        [label for label in axis.get_ticklabels() if label.get_visible()]
        for axes in figure.axes
        for axis in (axes.xaxis, axes.yaxis)
    ]
    found = []
    for group in [*groups, [axes.title for axes in figure.axes]]:
        boxes = [(one.get_text(), one.get_window_extent().shrunk(0.9, 0.75)) for one in group if one.get_text()]
        for place, (text, box) in enumerate(boxes):
            found += [(text, other) for other, beside in boxes[place + 1 :] if box.overlaps(beside)]
    return found


class TestShownUnits:
    def test_of_the_study_before_those_of_the_model(self):
        """The model has k_1 in kN*m/rad and c_1 in N*m*s/rad."""
        vary = {
            "k_1": {"type": "range", "low": "400 N*m/rad", "high": "0.5 kN*m/rad", "count": 3},
            "k_2": {"type": "range", "low": "4 MN*m/rad", "high": "5 MN*m/rad", "count": 3},
            "c_1": {"type": "list", "values": ["-10 %", "0 %"]},
        }
        study = define(tn.load("amt_rig"), vary, {"f_1": {"type": "natural_frequency", "mode": 1}})
        assert shown_units(study).written == {"k_1": "kN*m/rad", "k_2": "MN*m/rad", "c_1": "N*m*s/rad"}

    def test_angles_are_in_degrees_where_a_limit_has_them_so(self):
        asked = {name: {"type": "response", "output": "theta_1", "input": "T_M", "at": at}
                 for name, at in (("near", "5 Hz"), ("far", "9 Hz"))}  # fmt: skip
        vary = {"k_1": {"type": "list", "values": [400, 500]}}
        for unit, other in (("deg", "deg/(N*m)"), ("mrad", "rad/(N*m)")):
            study = define(tn.load("amt_rig"), vary, asked, limits={"near": {"below": f"1 {unit}/(N*m)"}})
            assert shown_units(study).unit("near") == f"{unit}/(N*m)"
            assert shown_units(study).unit("far") == other

    def test_per_cent_and_what_is_no_unit(self):
        units = ShownUnits({"zeta": "%"}, {"zeta": "", "level": "dB"})
        assert units.scale("zeta") == pytest.approx(100)
        assert (units.unit("level"), units.scale("level")) == ("dB", 1.0)
        assert IN_SI.scale("k", "N*m/rad") == 1.0
