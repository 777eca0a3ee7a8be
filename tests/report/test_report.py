"""Pictures: what is in them, that they collide nowhere, and how they get into files."""

import re

import numpy as np
import pytest
from support.drawn_models import MODELS, chain, full_mesh, inertia, planetary_of_gears, two_sets
from support.models import geared_line
from support.pictures import (
    EXAMPLES,
    collisions,
    crossed,
    drawable,
    drawn,
    each_example,
    is_round,
    on_paper,
    outside,
    texts,
)
from validation.build import build, read_case

import torsionnet as tn
from torsionnet import plot
from torsionnet.base.number_text import NumberText
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.linear.phase import unwrapped_phase
from torsionnet.plot.drawing.labels import quantity, symbol
from torsionnet.plot.drawing.pieces import ROLES
from torsionnet.plot.schematics.line_routes import idle_nodes, node_axis

DEGREES = tn.Conventions(angle="deg", frequency="cpm")
FREQUENCIES = np.geomspace(0.3, 40, 60)


def amt(configuration="", output="theta_1", **changes):
    rig = tn.load("amt_rig")
    return rig.configured(configuration, **changes).frequency_response(output, "T_T", FREQUENCIES)


def made(values, frequencies=None, **extra):
    """A response with one output and one input from plain values."""
    values = np.asarray(values, dtype=complex).reshape(-1, 1, 1)
    frequencies = np.arange(1.0, len(values) + 1) if frequencies is None else np.asarray(frequencies, dtype=float)
    return FrequencyResponse(frequencies, values, (Channel("y", "rad"),), (Channel("u", "N*m"),), **extra)


def curve(axes, number=0):
    return np.asarray(axes.lines[number].get_xdata()), np.asarray(axes.lines[number].get_ydata())


def legend(figure):
    return [text.get_text() for box in figure.legends for text in box.get_texts()]


def transaxle():
    """An engine on gears to an open differential, with two gears that idle, in a block on its mount."""
    inertias = {"engine": "engine", "first": "cage", "two": "left", "three": "right", "roll": "block"}
    return tn.Drivetrain(
        "transaxle",
        [
            *(tn.Inertia(name, node=node, inertia=1) for name, node in inertias.items()),
            tn.Spring("clutch", nodes=("engine", "pinion"), stiffness=100),
            tn.Gear("final", nodes=("pinion", "cage"), ratio=3, housing="block"),
            tn.Gear("idle_3", nodes=("pinion", "third"), ratio=2, housing="block"),
            tn.Gear("idle_4", nodes=("pinion", "fourth"), ratio=4, housing="block"),
            tn.Inertia("wheel_3", node="third", inertia=0.1),
            tn.Inertia("wheel_4", node="fourth", inertia=0.1),
            tn.Differential("diff", cage="cage", left="left", right="right"),
            tn.Spring("mount", nodes=("block", "ground"), stiffness=1e4),
        ],
    )


def free_planetary(operating_point=None):
    return tn.Drivetrain(
        "free set",
        [
            *(tn.Inertia(node, node=node, inertia=1) for node in ("c", "r", "s")),
            tn.Planetary("set", sun="s", carrier="c", ring="r", ratio=3),
        ],
        operating_point=operating_point,
    )


class TestBode:
    def test_lines_are_the_response_in_the_units_shown(self):
        response = amt("V")
        magnitude, phase = plot.bode(response, conventions=DEGREES).axes
        x, y = curve(magnitude)
        np.testing.assert_allclose(x, 60 * FREQUENCIES, rtol=1e-12)
        np.testing.assert_allclose(y, np.degrees(np.abs(response.values[:, 0, 0])), rtol=1e-12)
        np.testing.assert_allclose(curve(phase)[1], response.phase[:, 0, 0], rtol=1e-12)

    def test_axes_say_what_and_in_which_unit(self):
        magnitude, phase = plot.bode(amt("V"), conventions=DEGREES).axes
        assert magnitude.get_ylabel() == "|theta_1/T_T| [deg/(N·m)]"
        assert phase.get_ylabel() == "phase [deg]"
        assert phase.get_xlabel() == "frequency [cpm]"

    def test_decibels_are_those_of_the_response(self):
        shown = tn.Conventions(angle="deg", db_reference=0.01)
        axes = plot.bode(amt("V"), conventions=shown, decibels=True).axes[0]
        assert axes.get_ylabel() == "|theta_1/T_T| [dB re 0.01 deg/(N·m)]"
        np.testing.assert_allclose(curve(axes)[1], amt("V").decibels(shown)[:, 0, 0], rtol=1e-12)

    def test_configurations_are_told_apart(self):
        figure = plot.bode([amt("II"), amt("V")])
        assert legend(figure) == ["II", "V"]
        assert figure.get_suptitle() == "AMT test rig"
        first, second = figure.axes[0].lines
        assert first.get_color() != second.get_color()
        assert first.get_linestyle() != second.get_linestyle()

    def test_own_labels_and_title(self):
        figure = plot.bode([amt("II"), amt("V")], labels=["model", "test"], title="T")
        assert legend(figure) == ["model", "test"]
        assert figure.get_suptitle() == "T"

    def test_every_pair_is_a_curve_unless_one_is_chosen(self):
        response = amt(output=["theta_1", "hub", "input_shaft"])
        assert legend(plot.bode(response)) == ["theta_1/T_T", "hub/T_T", "input_shaft/T_T"]
        assert len(plot.bode(response, output="hub").axes[0].lines) == 1

    def test_unlike_units_are_refused(self):
        response = amt(output=["theta_1", "torque(dmf)"])
        with pytest.raises(tn.UsageError, match="choose with output="):
            plot.bode(response)
        plot.bode(response, output="torque(dmf)")

    def test_wrong_number_of_labels_is_refused(self):
        with pytest.raises(tn.UsageError, match="2 labels"):
            plot.bode(amt(), labels=["a", "b"])

    def test_nothing_to_plot_is_refused(self):
        with pytest.raises(tn.UsageError):
            plot.bode([])

    def test_infinite_values_are_left_out(self):
        y = curve(plot.bode(made([1, np.inf, 2, 0, 3])).axes[0])[1]
        np.testing.assert_array_equal(np.isnan(y), [False, True, False, True, False])

    def test_zero_frequency_only_on_a_linear_axis(self):
        response = made([1, 2, 3], [0, 1, 2])
        assert len(curve(plot.bode(response).axes[0])[0]) == 2
        assert len(curve(plot.bode(response, x_log=False).axes[0])[0]) == 3

    def test_coherence_where_there_is_one(self):
        response = made([1, 2, 3], coherence=np.array([0.9, 0.5, 1.0]).reshape(-1, 1, 1))
        figure = plot.bode(response)
        assert figure.axes[2].get_ylabel() == "coherence [-]"
        np.testing.assert_array_equal(curve(figure.axes[2])[1], [0.9, 0.5, 1.0])
        assert len(plot.bode(response, coherence=False).axes) == 2
        with pytest.raises(tn.UsageError, match="none of the responses"):
            plot.bode(made([1, 2]), coherence=True)

    def test_poor_conditioning_is_marked(self):
        figure = plot.bode(made([1, 2, 3, 4], conditioning=np.array([1, 1e-14, 1e-12, 1])))
        (patch,) = figure.axes[0].patches
        assert patch.get_x() == pytest.approx(1.5)
        assert patch.get_x() + patch.get_width() == pytest.approx(3.5)
        assert "measured input nearly zero: not to be trusted" in legend(figure)
        assert plot.bode(made([1, 2], conditioning=np.ones(2))).legends == []

    def test_phase_goes_on_below_a_half_turn(self):
        turns = np.exp(-1j * np.radians(np.arange(0, 720, 30)))
        np.testing.assert_allclose(unwrapped_phase(turns), -np.arange(0.0, 720, 30), atol=1e-9)

    def test_opposite_phase_is_a_lag(self):
        np.testing.assert_array_equal(unwrapped_phase(np.array([complex(-1, 0.0), complex(-2, -0.0)])), [-180, -180])

    @pytest.mark.parametrize("span", [0, 100, 300, 2000])
    def test_phase_ticks_are_multiples_of_45(self, span):
        values = np.exp(-1j * np.radians(np.linspace(0, span, 200)))
        axes = plot.bode(made(values)).axes[1]
        low, high = axes.get_ylim()
        ticks = [tick for tick in axes.get_yticks() if low <= tick <= high]
        assert 2 <= len(ticks) <= 13
        np.testing.assert_array_equal(np.remainder(ticks, 45), 0)


def dots(axes):
    """Real parts of the nodes, without those that stand again where a branch begins."""
    return np.asarray([line for line in axes.lines if line.get_marker() == "o"][-1].get_ydata())


class TestColoursAndDashes:
    def patterns(self, *responses, **options):
        axes = plot.bode(list(responses), **options).axes[0]
        return {line.get_label(): (line.get_color(), str(line._dash_pattern)) for line in axes.lines}

    def test_outputs_by_colour_and_inputs_by_dashes(self):
        rig = tn.load("oil_engine")
        one, two, three = rig.nodes
        found = self.patterns(rig.frequency_response([one, two, three], [one, three], [1.0, 2.0]))
        colour, dash = ({label: look[side] for label, look in found.items()} for side in (0, 1))
        for output in rig.nodes:
            assert colour[f"{output}/{one}"] == colour[f"{output}/{three}"]
            assert (
                dash[f"{output}/{one}"] == dash[f"{one}/{one}"] != dash[f"{output}/{three}"] == dash[f"{one}/{three}"]
            )
        assert len(set(colour.values())) == 3

    def test_responses_of_several_outputs(self):
        rig = tn.load("amt_rig")
        gears = [rig.configured(gear).frequency_response(["theta_1", "hub"], "T_M", [1.0, 2.0]) for gear in ("II", "V")]
        found = self.patterns(*gears)
        assert len(set(found.values())) == 4
        assert found["II, theta_1/T_M"][0] == found["V, theta_1/T_M"][0] != found["II, hub/T_M"][0]
        assert found["II, theta_1/T_M"][1] == found["II, hub/T_M"][1] != found["V, hub/T_M"][1]


class TestModeShapes:
    def test_a_panel_for_each_mode(self):
        rig = tn.load("amt_rig")
        modes = rig.modes()
        figure = plot.mode_shapes(modes, rig)
        assert len(figure.axes) == len(modes)
        assert figure.axes[0].get_title() == "1: 3.409 Hz, zeta = 22.9 %"
        assert [text.get_text() for text in figure.axes[0].get_xticklabels()] == list(rig.nodes)

    def test_points_are_the_shape_of_the_modes_alone(self):
        modes = geared_line().modes()
        points = [line for line in plot.mode_shapes(modes).axes[1].lines if line.get_marker() == "o"]
        np.testing.assert_array_equal(np.asarray(points[-1].get_ydata()), modes.shapes[:, 1].real)

    def test_angles_are_referred_so_that_a_rigid_gear_makes_no_jump(self):
        rig = tn.load("amt_rig")
        modes = rig.modes()
        figure = plot.mode_shapes(modes, rig)
        y = dots(figure.axes[1])
        np.testing.assert_allclose(y[2], y[3], rtol=1e-9)
        own = modes.shapes[:, 1] * [1, 1, 1, 7.96, 7.96]
        np.testing.assert_allclose(y, (own / own[np.argmax(abs(own))]).real, atol=1e-12)
        assert figure.get_supylabel() == "angle referred to motor [-]"

    def test_reference_scales_all_angles_alike(self):
        rig = tn.load("marine_steam_turbine")
        modes = rig.modes()
        one, other = (
            plot.mode_shapes(modes, rig, mode=[2, 5], referred_to=node) for node in ("propeller", "lp_turbine")
        )
        for first, second in zip(one.axes, other.axes, strict=True):
            np.testing.assert_allclose(np.abs(dots(first)), np.abs(dots(second)), atol=1e-9)
        assert other.get_supylabel() == "angle referred to lp_turbine [-]"

    def test_own_angles_jump_at_a_gear_by_its_ratio(self):
        rig = tn.load("wind_turbine_5mw")
        y = dots(plot.mode_shapes(rig.modes(), rig, own_angles=True).axes[0])
        assert y[2] / y[1] == pytest.approx(97)

    def test_branches_stand_in_the_order_of_the_schematic_and_begin_with_the_node_they_leave(self):
        ship = tn.load("marine_steam_turbine")
        names = [text.get_text() for text in plot.mode_shapes(ship.modes(), ship, mode=[3]).axes[0].get_xticklabels()]
        low = ["lp_pinion", "lp_wheel", "lp_turbine_pinion", "lp_turbine"]
        assert names[:8] == ["propeller", "bull_gear", *low, "(bull_gear)", "hp_pinion"]
        assert sorted(name for name in names if name[0] != "(") == sorted(ship.nodes)

    def test_only_nodes_that_share_an_element_are_joined(self):
        ship = tn.load("marine_steam_turbine")
        axes = plot.mode_shapes(ship.modes(), ship, mode=[3]).axes[0]
        names = dict(zip(axes.get_xticks(), [text.get_text() for text in axes.get_xticklabels()], strict=True))
        joined = {
            frozenset(names[x].strip("()") for x in line.get_xdata())
            for line in axes.lines
            if line.get_label() == "_join"
        }
        edges = {frozenset(pair) for pair in ship.graph().edges() if "ground" not in pair}
        assert joined == edges
        alone = plot.mode_shapes(ship.modes()).axes[0]
        assert not [line for line in alone.lines if line.get_label() == "_join"]

    def test_gears_are_marked_with_their_ratio(self):
        rig = tn.load("amt_rig")
        assert r"$\tau$ = 7.96" in [text.get_text() for text in plot.mode_shapes(rig.modes(), rig).axes[0].texts]

    def test_stations_within_a_shaft_stand_between_its_ends(self):
        rig = tn.load("drill_string")
        names = [station.node for station in node_axis(rig).stations]
        assert names == ["table", *rig.elements["pipe"].internal_nodes, "bit"]

    def test_phases_that_scatter_are_told(self):
        rig = tn.Drivetrain(
            "one-sided damping",
            [
                inertia("a", "x"),
                tn.Spring("k", nodes=("x", "y"), stiffness=100),
                inertia("b", "y"),
                tn.Spring("s", nodes=("y", "ground"), stiffness=100),
                tn.Damper("c", nodes=("x", "ground"), damping=12),
            ],
        )
        modes = rig.modes()
        figure = plot.mode_shapes(modes, rig)
        shape = modes.shapes[:, 1]
        angles = np.abs(np.degrees(np.angle(shape / shape[np.argmax(abs(shape))])))
        mean = np.average(np.minimum(angles, 180 - angles), weights=abs(shape))
        (note,) = [text.get_text() for text in figure.axes[1].texts]
        assert note == f"phases scatter by {mean:.0f}°"
        assert legend(figure)[:2] == ["real part", "imaginary part"]
        still = plot.mode_shapes(tn.load("oil_engine").modes(), tn.load("oil_engine"))
        assert "imaginary part" not in legend(still)

    def test_outputs_of_an_open_differential_turn_alike(self):
        from torsionnet.plot.shapes import shape_view

        rig = transaxle()
        modes = rig.modes()
        assert modes.kinds[:2] == ("rigid body", "rigid body")
        view = shape_view(modes, rig)
        expected = {"engine": 1, "pinion": 1, "cage": 3, "left": 3, "right": 3, "block": 1}
        assert dict(zip(modes.nodes, view.factors, strict=True)) == pytest.approx(expected | {"third": 2, "fourth": 4})
        assert view.free == ()
        assert view.standing == ("block",)  # on its mount, while the engine turns
        assert "own angle of block" in legend(plot.mode_shapes(modes, rig))

    def test_a_planetary_set_without_a_held_member_has_no_fixed_ratio(self):
        rig = free_planetary()
        assert "no fixed ratio to r, s" in legend(plot.mode_shapes(rig.modes(), rig, referred_to="c"))

    def test_speeds_of_the_operating_point_come_first(self):
        from torsionnet.plot.shapes import shape_view

        rig = free_planetary({"speed": {"c": 100, "r": 50}})  # s from the kinematics of the set
        view = shape_view(rig.modes(), rig, "c")
        factors = dict(zip(rig.nodes, view.factors, strict=True))
        assert factors["r"] == pytest.approx(2)
        assert factors["s"] == pytest.approx(100 / (100 * (1 + 3) - 3 * 50))
        assert view.free == ()

    def test_idle_gear_wheels_are_left_out_unless_asked_for(self):
        from torsionnet.plot.shapes import shape_view

        rig = transaxle()
        modes = rig.modes()
        names = {station.node for station in shape_view(modes, rig).axis.stations}
        assert names == set(rig.nodes) - {"third", "fourth"}
        assert "2 idle gear wheels not shown" in legend(plot.mode_shapes(modes, rig))
        every = plot.mode_shapes(modes, rig, idle=True)
        assert {station.node for station in shape_view(modes, rig, idle=True).axis.stations} == set(rig.nodes)
        assert not [text for text in legend(every) if "idle" in text]

    def test_a_load_behind_a_gear_is_no_idler(self):
        rig = geared_line()
        assert idle_nodes(rig) == set()
        assert idle_nodes(tn.load("geared_branch")) == set()

    def test_in_a_rigid_body_mode_every_branch_turns_alike(self):
        from torsionnet.plot.shapes import shape_view

        rig = transaxle()
        modes = rig.modes()
        view = shape_view(modes, rig)
        turning = modes.shapes[:, 0] * view.factors
        other = modes.shapes[:, 1] * view.factors
        place = {node: index for index, node in enumerate(modes.nodes)}
        # The motion in which both wheels turn alike, out of the two of the open differential.
        weight = np.linalg.solve(
            [[turning[place[n]], other[place[n]]] for n in ("left", "right")], np.array([1.0, 1.0], dtype=complex)
        )
        together = weight[0] * turning + weight[1] * other
        assert np.delete(together, place["block"]) == pytest.approx(np.ones(len(together) - 1))

    @pytest.mark.parametrize("example", [name for name in MODELS if name != "mesh"])
    def test_every_node_is_shown_once(self, example):
        model = MODELS[example]()
        modes = model.modes()
        axis = node_axis(model)
        assert sorted(station.node for station in axis.stations if not station.again) == sorted(modes.nodes)
        places = [station.x for station in axis.stations]
        assert places == sorted(set(places))

    def test_referring_without_a_drivetrain_is_refused(self):
        modes = geared_line().modes()
        with pytest.raises(tn.UsageError, match="drivetrain"):
            plot.mode_shapes(modes, referred_to="m")
        with pytest.raises(tn.UsageError, match="unknown-node"):
            plot.mode_shapes(modes, geared_line(), referred_to="motr")

    @pytest.mark.slow
    def test_at_most_twelve_unless_asked(self):
        rig = build(read_case("uniform_chain_50_free_free"))
        modes = rig.modes()
        figure = plot.mode_shapes(modes, rig)
        assert len(figure.axes) == 12
        assert figure.get_figheight() <= 10
        assert "12 of 50 modes shown" in legend(figure)
        titles = [axes.get_title() for axes in figure.axes]
        assert not [title for title in titles if "Hz" not in title]
        titles = [axes.get_title() for axes in plot.mode_shapes(modes, rig, mode=[49, 2, 3]).axes]
        assert [title.split(":")[0] for title in titles] == ["49", "2", "3"]

    @pytest.mark.slow
    def test_vibrations_alone_in_two_columns_on_one_page(self):
        """Of a ship with rigid-body mode, real poles and 18 stations."""
        ship = tn.load("marine_medium_speed")
        figure = plot.mode_shapes(ship.modes().first(7), ship)
        assert len(figure.axes) == 4
        assert not [axes for axes in figure.axes if "Hz" not in axes.get_title()]
        assert len({round(axes.get_position().x0, 3) for axes in figure.axes}) == 2
        assert figure.get_figheight() <= 10

    @pytest.mark.parametrize("number", [0, 50, -1])
    def test_no_such_mode(self, number):
        modes = build(read_case("uniform_chain_50_free_free")).modes()
        with pytest.raises(tn.UsageError, match=r"(?s)49.*unknown-mode"):
            plot.mode_shapes(modes, mode=[number])

    def test_drawn_without_complaint_with_an_odd_number_of_panels(self, tmp_path):
        rig = tn.load("oil_engine")
        plot.save(plot.mode_shapes(rig.modes(), rig), tmp_path / "shapes.png")
        assert (tmp_path / "shapes.png").stat().st_size > 0


class TestSchematic:
    @pytest.mark.few(1, 25)
    @each_example
    def test_texts_meet_no_texts_and_no_lines_and_lie_inside(self, example):
        figure = drawn(example)
        assert collisions(figure) == []
        assert crossed(figure) == []
        assert outside(figure) == []
        assert on_paper(figure) > 6.0 - 1e-9

    @pytest.mark.few(1)
    @pytest.mark.parametrize("width", [100, *(pytest.param(width, marks=pytest.mark.slow) for width in (250, 400))])
    @pytest.mark.parametrize("example", ["marine_steam_turbine", "hybrid", "crankshaft"])
    def test_lines_are_broken_to_the_width_of_the_page(self, example, width):
        figure = drawable(plot.schematic(EXAMPLES[example](), width=width))
        assert figure.get_size_inches()[0] * 25.4 <= width * 7 / 6 + 1e-6
        assert collisions(figure) == []
        assert crossed(figure) == []

    def test_a_page_too_narrow_is_refused(self):
        with pytest.raises(tn.UsageError, match="at least 100 mm"):
            plot.schematic(tn.load("dmf_rig"), width=30)

    def test_a_text_on_a_symbol_would_be_found(self):
        figure = drawable(plot.schematic(tn.load("dmf_rig")))
        disc = next(patch for patch in figure.axes[0].patches if patch.get_path().get_extents().width == 13)
        wide = next(text for text in figure.axes[0].texts if text.get_text() == "torque_meter")
        x, y = disc.get_path().vertices.mean(axis=0)
        wide.set_position((x, y + 12))
        assert crossed(figure)

    def test_a_line_through_a_text_would_be_found(self):
        figure = drawable(plot.schematic(tn.load("dmf_rig")))
        shaft = max(figure.axes[0].patches, key=lambda patch: patch.get_path().get_extents().width)
        figure.axes[0].texts[0].set_position(shaft.get_path().vertices.mean(axis=0) - [0, 3])
        assert crossed(figure)

    def test_a_collision_would_be_found(self):
        figure = drawable(plot.schematic(tn.load("dmf_rig")))
        first, second = figure.axes[0].texts[:2]
        second.set_position(first.get_position())
        assert collisions(figure)

    def test_a_text_outside_would_be_found(self):
        figure = drawable(plot.schematic(tn.load("dmf_rig")))
        figure.axes[0].texts[0].set_x(-100)
        assert len(outside(figure)) == 1

    @each_example
    def test_everything_is_named_once(self, example):
        model = EXAMPLES[example]()
        figure = drawn(example)
        # A name may be broken into lines, which follow each other.
        running = "".join(texts(figure))
        for node in model.nodes:
            assert node in running or node in {n for e in model.elements.values() for n in e.internal_nodes}
        if len(model.nodes) <= 40:
            names = [text.get_text() for text in figure.axes[0].texts if text.get_fontsize() == ROLES["name"].size]
            for name in model.elements:
                assert name in "".join(names), name
                assert names.count(name) <= 1, name
            for name in (*model.inputs, *model.sensors):
                assert symbol(name) in running, name

    def test_values_in_engineering_units(self):
        shown = texts(plot.schematic(tn.load("amt_rig").configured("V")))
        for text in (
            r"$k_{\mathrm{1}}$ = 460 N·m/rad",
            r"$k_{\mathrm{2}}$ = 12.3 kN·m/rad",
            r"$c_{\mathrm{1}}$ = 4 N·m·s/rad",
            r"$I_{\mathrm{F}}$ = 0.152 kg·m²",
            r"$\tau$ = 3.26",
        ):
            assert text in shown

    @pytest.mark.slow
    def test_title(self):
        assert "AMT test rig (V)" in texts(plot.schematic(tn.load("amt_rig").configured("V")))
        assert "own" in texts(plot.schematic(tn.load("amt_rig"), title="own"))
        assert "AMT test rig" not in texts(plot.schematic(tn.load("amt_rig"), title=""))

    def test_switched_off_elements_are_not_drawn(self):
        assert "bearing" not in texts(plot.schematic(tn.load("amt_rig").switched(off=["bearing"])))

    @pytest.mark.slow
    def test_long_chain_is_cut_into_lines_and_fits(self):
        figure = plot.schematic(chain(200))
        width, height = figure.get_size_inches()
        assert max(width, height) <= 24.0 + 1e-9
        assert 0.25 < width / height < 2.5
        assert any(text.startswith("200 nodes") for text in texts(figure))

    def test_loop_is_led_back_by_a_line_of_level_and_upright_pieces(self):
        import matplotlib as mpl

        lines = [
            patch.get_path().vertices
            for patch in plot.schematic(two_sets()).axes[0].patches
            if patch.get_edgecolor() == mpl.colors.to_rgba("#6b6b6b") and patch.get_linewidth() == pytest.approx(1.2)
        ]
        lines = [points for points in lines if len(points) < 8]
        assert lines
        for points in lines:
            assert np.all(np.isclose(np.diff(points, axis=0), 0).any(axis=1))

    def test_many_loops_are_tagged_with_the_name_of_the_node(self):
        shown = texts(plot.schematic(full_mesh()))
        assert sum(shown.count(f"n{i}") for i in range(6)) == 6 + 10

    def test_a_planetary_set_of_gears_is_drawn_as_one(self):
        figure = plot.schematic(planetary_of_gears())
        shown = texts(figure)
        assert {"sun", "ring", "carrier", "planet: planet"} <= set(shown)
        circles = [patch for patch in figure.axes[0].patches if patch.get_fill() and is_round(patch)]
        assert sorted({round(patch.get_path().get_extents().width) for patch in circles}, reverse=True)[:2] == [47, 41]

    def test_gears_that_are_no_planetary_set_stay_gears(self):
        elements = list(planetary_of_gears().elements.values())
        more = tn.Spring("planet_shaft", nodes=("planet", "elsewhere"), stiffness=1)
        model = tn.Drivetrain("not a planet", [*elements, more, inertia("mass", "elsewhere")])
        assert "planet: planet" not in texts(plot.schematic(model))

    @pytest.mark.parametrize(
        ("gear", "text"),
        [
            ({"teeth": (17, -61)}, r"$\tau$ = −61/17 = −3.588"),
            ({"ratio": "z_b/z_a"}, r"$\tau$ = $z_{\mathrm{b}}$/$z_{\mathrm{a}}$ = 2.5"),
            ({"ratio": -2}, r"$\tau$ = −2"),
        ],
    )
    def test_ratio_as_it_was_given(self, gear, text):
        elements = [inertia("a", "x"), tn.Gear("g", nodes=("x", "y"), **gear), inertia("b", "y")]
        model = tn.Drivetrain("stage", elements, parameters={"z_a": 20, "z_b": 50} if "ratio" in gear else {})
        assert text in texts(plot.schematic(model))

    def test_drawing_shows_the_ratio_of_the_inertias(self):
        small, large = (
            tn.Drivetrain(
                "two", [inertia("a", "x", 1), tn.Spring("k", nodes=("x", "y"), stiffness=1), inertia("b", "y", value)]
            )
            for value in (10, 1000)
        )
        heights = []
        for model in (small, large):
            boxes = [patch.get_path().get_extents() for patch in plot.schematic(model).axes[0].patches]
            discs = [box.height for box in boxes if box.width == pytest.approx(13)]
            heights.append(max(discs) - min(discs))
        assert 0 < heights[0] < heights[1]


class TestLabels:
    @pytest.mark.parametrize(
        ("value", "text"),
        [
            (0, "0"),
            (460, "460"),
            (12345.6, "12350"),
            (0.0780, "0.078"),
            (-3.5, "−3.5"),
            (2.5e-5, "2.5·10⁻⁵"),
            (38759227, "3.876·10⁷"),
            (999999.9, "1000000"),
        ],
    )
    def test_number(self, value, text):
        assert str(NumberText(value)) == text

    @pytest.mark.parametrize(
        ("value", "dimension", "text"),
        [
            (1.2e6, "stiffness", "1.2 MN·m/rad"),
            (0.3, "damping", "0.3 N·m·s/rad"),
            (0.028, "length", "28 mm"),
            (1.5, "length", "1.5 m"),
            (3, "1", "3"),
        ],
    )
    def test_quantity(self, value, dimension, text):
        assert quantity(value, dimension) == text

    @pytest.mark.parametrize(
        ("name", "text"),
        [
            ("theta_1", r"$\theta_{\mathrm{1}}$"),
            ("k", "$k$"),
            ("c_a_b", r"$c_{\mathrm{a\_b}}$"),
            ("rotor_speed", "rotor_speed"),
        ],
    )
    def test_symbol(self, name, text):
        assert symbol(name) == text


class TestSave:
    @pytest.mark.few(1)
    @pytest.mark.parametrize(
        ("ending", "start"), [("svg", b"<?xml"), ("png", b"\x89PNG"), ("pdf", b"%PDF"), ("SVG", b"<?xml")]
    )
    def test_form_by_the_ending(self, tmp_path, ending, start):
        path = tmp_path / f"picture.{ending}"
        plot.save(plot.schematic(tn.load("dmf_rig")), path)
        assert path.read_bytes().startswith(start)

    @pytest.mark.slow
    @pytest.mark.parametrize("ending", ["svg", pytest.param("png", marks=pytest.mark.slow), "pdf"])
    def test_equal_figures_give_equal_files(self, tmp_path, ending):
        contents = set()
        for copy in range(2):
            path = tmp_path / f"{copy}.{ending}"
            plot.save(plot.bode([amt("II"), amt("V")]), path)
            contents.add(path.read_bytes())
        assert len(contents) == 1

    def test_resolution_of_a_png(self, tmp_path):
        figure = plot.schematic(tn.load("dmf_rig"))
        plot.save(figure, tmp_path / "a.png")
        header = (tmp_path / "a.png").read_bytes()[16:24]
        size = [int.from_bytes(header[:4]), int.from_bytes(header[4:])]
        np.testing.assert_allclose(size, 150 * figure.get_size_inches(), atol=1)

    @pytest.mark.few(1)
    @pytest.mark.parametrize("name", ["picture.jpg", "picture", ".svg", "picture.svg.txt"])
    def test_other_endings_are_refused(self, tmp_path, name):
        with pytest.raises(tn.UsageError, match=re.escape(".svg, .png or .pdf")):
            plot.save(plot.schematic(tn.load("dmf_rig")), tmp_path / name)
        assert list(tmp_path.iterdir()) == []

    def test_a_failure_leaves_nothing_behind(self, tmp_path):
        figure = plot.schematic(tn.load("dmf_rig"))
        target = tmp_path / "old.svg"
        target.write_text("old")
        figure.axes[0].text(0, 0, "$\\nosuchcommand$")
        with pytest.raises(ValueError, match="nosuchcommand"):
            plot.save(figure, target)
        assert target.read_text() == "old"
        assert [path.name for path in tmp_path.iterdir()] == ["old.svg"]

    @pytest.mark.slow
    def test_a_users_style_does_not_disturb_pictures_with_places_of_their_own(self, tmp_path):
        """Under ``constrained_layout.use`` matplotlib warns of axes that stand in no grid."""
        import matplotlib as mpl

        from torsionnet.plot.shape_grid import shape_grid

        rig = tn.load("dmf_rig")
        with mpl.rc_context(plot.STYLE):
            for figure in (plot.schematic(rig), shape_grid([rig.modes()], [rig], [""])):
                plot.save(figure, tmp_path / "a.svg")

    @pytest.mark.slow
    def test_global_settings_stay_as_they_are(self, tmp_path):
        import matplotlib as mpl

        before = dict(mpl.rcParams)
        rig = tn.load("dmf_rig")
        for figure in (plot.schematic(rig), plot.mode_shapes(rig.modes(), rig), plot.bode(amt())):
            plot.save(figure, tmp_path / "a.svg")
        assert dict(mpl.rcParams) == before
