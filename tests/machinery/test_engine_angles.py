"""Several engines in one drivetrain: angles between their crankshafts that are given, and those that are not."""

import json
from fractions import Fraction

import numpy as np
import pytest
from support.command_line import run
from support.twin_engines import ENGINE, PORT, plant, text

import torsionnet as tn
from torsionnet.linear.frequency_response import Channel
from torsionnet.machinery.excitations.reciprocating_engine import conditions_running_alone
from torsionnet.machinery.orders.engine_angles import at_worst_angles
from torsionnet.machinery.orders.order_line import OrderLine
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.worst_response import at_least_range_angles


def response(given, output="torque(sh)"):
    return given.order_response(output)


def over_phases(known, degrees=1.0):
    """Half ranges (n_phases, n_speeds) of a response of which all phases are known, with the second engine later by phases."""
    orders = np.array([line.order * (line.excitation == "star") for line in known.lines])
    phases = np.radians(np.arange(0, 720, degrees))
    values = known.values[None] * np.exp(-1j * np.outer(phases, orders))[:, None, :, None]
    shape = values.shape[:2]
    stacked = OrderResponse(
        np.tile(known.speeds, shape[0]), known.reference, known.lines, values.reshape(-1, *values.shape[2:]),
        known.outputs,
    )  # fmt: skip
    return stacked.half_range.reshape(shape)


class TestTwins:
    def test_the_angle_that_is_not_given_is_the_worst_of_all(self):
        """Against a grid of declared phases in steps of a degree; a propeller behind the gear has its own."""
        found, known = response(plant()), response(plant(star=", phase: 0 deg"))
        assert not getattr(known, "angles", ())
        sizes = over_phases(known)
        assert found.half_range[:, 0] == pytest.approx(sizes.max(axis=0), rel=1e-4)
        assert found.least.half_range[:, 0] == pytest.approx(sizes.min(axis=0), rel=2e-3)
        assert (found.least.half_range[:, 0] < 0.9 * found.half_range[:, 0]).all()

    def test_what_is_shown_is_what_a_declared_phase_gives(self):
        """Amplitudes of all orders and half ranges at the angles that are named, both of them."""
        found = response(plant())
        for shown in (found, found.least):
            angle = shown.angles[0].degrees[1, 0]
            declared = response(plant(star=f", phase: {angle} deg"))
            assert declared.half_range[1] == pytest.approx(shown.half_range[1], rel=1e-9)
            assert declared.values[1] == pytest.approx(shown.values[1], rel=1e-6, abs=1e-6)
            assert shown.cases()[1] == f"star fires {round(angle, 1):g} deg after port"

    def test_a_declared_phase_is_later_firing(self):
        """As firing angles that are larger by it."""
        engine = ENGINE.replace("firing_order: [1, 2, 3]", "firing_angles: {1: 100 deg, 2: 340 deg, 3: 580 deg}")
        by_angles = text(star=", phase: 0 deg").replace(f"phase: 0 deg, {ENGINE}", f"phase: 0 deg, {engine}")
        known = response(plant(star=", phase: 100 deg"))
        assert response(tn.loads(by_angles)).values == pytest.approx(known.values, rel=1e-9, abs=1e-9)

    @pytest.mark.few(1)
    @pytest.mark.parametrize("side", ["port", "star"])
    def test_a_misfire_of_either_engine_has_an_angle_of_its_own(self, side):
        """Each cylinder of one engine, against a grid of phases for each."""
        found = response(plant(**{side: ", misfire: each"}))
        singly = []
        for number in (1, 2, 3):
            more = {"star": ", phase: 0 deg"}
            more[side] = f", misfire: [{number}]{more.get(side, '')}"
            singly.append(over_phases(response(plant(**more))).max(axis=0))
        assert found.half_range[:, 0] == pytest.approx(np.max(singly, axis=0), rel=3e-4)
        # At a free angle it makes no difference which cylinder of the other engine misfires.
        said = "misfire of cylinder" if side == "port" else "all cases alike"
        assert all(case.startswith(said) for case in found.cases())

    @pytest.mark.slow
    def test_scatter_is_worst_together_with_the_angle(self):
        """All signs of the cylinders of one engine, each with its worst angle."""
        found = response(plant(star=", spread: 10 %")).half_range[:, 0]
        sizes = [
            over_phases(response(plant(star=f", phase: 0 deg, factors: {{1: {a}, 2: {b}, 3: {c}}}")), degrees=2.0)
            for a in (0.9, 1.1)
            for b in (0.9, 1.1)
            for c in (0.9, 1.1)
        ]
        assert found == pytest.approx(np.max(sizes, axis=(0, 1)), rel=2e-3)

    def test_unequal_speeds_add_their_half_ranges(self):
        """A propeller keeps its phase to the first engine; a declared phase is honoured, as the wheels mesh for good."""
        found = plant(ratio=-2).order_response("torque(sh)")
        first = plant(ratio=-2).order_response("torque(sh)", excitation=["port", "screw"])
        second = plant(ratio=-2).order_response("torque(sh)", excitation=["star"])
        assert found.half_range == pytest.approx(first.half_range + second.half_range, rel=1e-9)
        assert found.engine_notes == (
            "port and star turn at unequal speeds with no phase between them: half ranges are added",
        )
        declared = plant(ratio=-2, star=", phase: 0 deg").order_response("torque(sh)")
        assert declared.revolutions == 6
        assert not declared.engine_notes
        assert (declared.half_range < found.half_range).all()

    def test_dissipated_power_has_its_own_worst_angle(self):
        """Power in a spring: against declared phases; it is a sum of few waves of the phase."""
        found = plant().dissipated_power("sh").values[:, 0]
        declared = [plant(star=f", phase: {one} deg").dissipated_power("sh").values[:, 0] for one in range(0, 240, 20)]
        assert found == pytest.approx(np.max(declared, axis=0), rel=2e-2)
        assert (found >= np.max(declared, axis=0) * (1 - 1e-9)).all()

    def test_one_engine_alone_keeps_its_phase_to_the_propeller(self):
        alone = plant().configured("port").order_response("torque(sh)")
        assert type(alone) is OrderResponse
        assert alone.half_range == pytest.approx(
            plant().order_response("torque(sh)", excitation=["port", "screw"]).half_range, rel=1e-12
        )

    def test_largest_amplitude_of_an_order_in_both(self):
        found = response(plant()).case_responses[0]
        each = [abs(found.of_order(1.5, excitation=name)) for name in ("port", "star")]
        assert found.amplitude_of_order(1.5) == pytest.approx(sum(each), rel=1e-12)
        with pytest.raises(tn.UsageError, match="no order 7 acts"):
            found.amplitude_of_order(7)

    @pytest.mark.slow
    def test_parameters_that_follow_the_speed_change_nothing_of_it(self):
        """Solved speed by speed and put together: with a damping of each speed against that value fixed."""
        following = text().replace("damping: 900}", "damping: c}")
        table = "parameters: {c: {by: speed, of: a, table: {400 rpm: 800, 800 rpm: 1200}}}\nspeeds:"
        found = response(tn.loads(following.replace("speeds:", table)))
        for at, rpm in enumerate(found.rpm):
            value = f"parameters: {{c: {800 + rpm - 400}}}\nspeeds:"
            fixed = response(tn.loads(following.replace("speeds:", value)))
            assert found.half_range[at] == pytest.approx(fixed.half_range[at], rel=1e-6)
            assert found.cases()[at] == fixed.cases()[at]
            assert found.least.half_range[at] == pytest.approx(fixed.least.half_range[at], rel=1e-6)

    def test_weighted_orders_have_a_worst_angle_of_their_own(self):
        """A coupling whose orders above 10 Hz count for more: against declared phases."""
        limit = "rubber: {rule: coupling, element: sh, T_KW: 1 kN*m, frequency_factor: din_740_2, source: own}"

        def judged(star):
            given = tn.loads(text(star=star).replace("limits: {", f"limits: {{{limit}, "))
            return given.check_limits("rubber").of("rubber").values

        declared = np.max([judged(f", phase: {one} deg") for one in range(0, 240, 40)], axis=0)
        assert (judged("") >= declared * (1 - 1e-9)).all()
        assert judged("") == pytest.approx(declared, rel=0.05)


class TestClosedForms:
    @staticmethod
    def one_order(order, sizes):
        """Lines of one order on engines of one speed, each with its amplitude."""
        lines = tuple(OrderLine(str(n), order, Fraction(1), engine=str(n)) for n in range(len(sizes)))
        values = np.array(sizes, dtype=complex).reshape(1, -1, 1)
        return OrderResponse(np.array([50.0]), "a", lines, values, (Channel("T", "N*m"),))

    @pytest.mark.parametrize("order", [0.5, 3.0])
    def test_two_equal_engines_add_up_at_0_and_cancel_half_a_period_later(self, order):
        case = self.one_order(order, [7.0, 7.0])
        assert case.half_range.item() == pytest.approx(14.0, rel=1e-6)
        worst, least = at_worst_angles(case.values, case.lines), at_least_range_angles(case)
        assert worst.angles[0].degrees.item() == pytest.approx(0.0, abs=1e-3)
        assert least.angles[0].degrees.item() == pytest.approx(180 / order, abs=0.05)
        assert abs(least.values.sum()) < 0.01

    @pytest.mark.parametrize("size", [0.3, 0.8, 3.0])
    def test_waves_of_two_orders_rise_together(self, size):
        """cos(phi) is steepest at -pi/2 and cos(2 phi) at -pi/4, whatever its size: it comes 3 pi/4 later, modulo pi."""
        lines = [OrderLine(str(order), order, Fraction(1), engine=str(order)) for order in (1, 2)]
        found = at_worst_angles(np.array([[[1.0], [size]]], dtype=complex), lines)
        assert np.radians(found.angles[0].degrees.item()) % np.pi == pytest.approx(3 * np.pi / 4, rel=1e-9)

    @pytest.mark.slow
    def test_three_engines_make_the_sum_of_their_sizes(self):
        """Whatever their phases; and with two smaller ones against the third what is left of it."""
        case = self.one_order(2.0, [5.0, 3.0j, -1.0])
        assert case.half_range.item() == pytest.approx(9.0, rel=1e-6)
        assert abs(at_least_range_angles(case).values.sum()) == pytest.approx(1.0, rel=1e-2)


@pytest.mark.few(1)
@pytest.mark.parametrize("engines", [2, 3])
def test_no_angle_makes_more_of_many_orders(engines):
    """Random amplitudes of half orders up to 3, and of a shaft that turns a third as fast: against random angles."""
    draw = np.random.default_rng(engines)
    names = [f"engine {number}" for number in range(engines)]
    lines = [OrderLine(name, h / 2, Fraction(1), engine=name) for name in names for h in range(1, 7)]
    if engines == 2:
        lines.append(OrderLine("screw", 4.0, Fraction(1, 3)))
    values = draw.normal(size=(1, len(lines), 2)) + 1j * draw.normal(size=(1, len(lines), 2))
    case = OrderResponse(np.array([50.0]), "a", tuple(lines), values, (Channel("x", "rad"), Channel("y", "rad")))
    least = at_least_range_angles(case)
    smallest = OrderResponse(case.speeds, "a", least.lines, least.values, case.outputs).half_range[0]
    angles = draw.uniform(0, 4 * np.pi, (800, engines - 1))
    rates = np.array([[line.order * (line.excitation == name) for line in lines] for name in names[1:]])
    turned = values * np.exp(-1j * angles @ rates)[:, :, None]
    tried = OrderResponse(np.ones(800), "a", least.lines, turned, case.outputs).half_range
    assert (tried.max(axis=0) <= case.half_range[0] * (1 + 1e-4)).all()
    assert (tried.max(axis=0) > 0.8 * case.half_range[0]).all()
    assert (tried.min(axis=0) >= smallest * (1 - 1e-3 if engines == 2 else 1)).all()


class TestWhatIsSaid:
    def test_check_says_that_a_phase_is_missing(self):
        notes = [fault.message for fault in plant().check()]
        assert any(note.startswith("no phase is given between star and port") for note in notes)
        assert not any("phase" in fault.message for fault in plant(star=", phase: 20 deg").check())
        assert not any("phase" in fault.message for fault in plant().configured("port").check())

    def test_engines_on_one_crankshaft_are_fixed_to_each_other(self):
        """As stages of a compressor, whose angles count from the same one."""
        both = plant().definition.excitations
        stage = plant(more="stage: {" + PORT + ", " + ENGINE + "}").order_response("torque(sh)")
        assert [line.engine for line in stage.lines if line.excitation == "stage"] == ["port"] * 6
        assert conditions_running_alone([("", both)]) == {"port": [], "star": []}

    @pytest.fixture(autouse=True)
    def folder(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "twins.yaml").write_text(text())

    def test_limits_take_the_worst_angle_and_say_which_engines_run(self):
        found = run("limits", "twins.yaml", "-c", "all", code=5)
        assert "both: no phase is given between star and port: for every output and speed the worst" in found.stdout
        assert "worst at 410 rpm: star fires 0 deg after port" in found.stdout
        assert "running on port alone: examined in port" in found.stdout
        assert "running on star alone: not examined" in found.stdout
        verdict = plant().check_limits().of("shaft")
        assert verdict.values == pytest.approx(response(plant()).half_range[:, 0], rel=1e-12)

    @pytest.mark.slow
    def test_orders_say_both_angles(self):
        found = run("orders", "twins.yaml", "-c", "both", "--output", "torque(sh)")
        assert (
            "at 410 rpm largest where star fires 0 deg after port; smallest, 0.114 of that, where star fires 120 deg"
            in found.stdout
        )
        shown = json.loads(run("orders", "twins.yaml", "-c", "both", "--output", "torque(sh)", "--json").stdout)
        output = shown["orders"][0]["outputs"][0] if "orders" in shown else shown[0]["outputs"][0]
        assert output["angles_deg"]["star"][0] == pytest.approx(240.0, abs=0.1)
        assert output["smallest_half_range"][0] == pytest.approx(response(plant()).least.half_range[0, 0], rel=1e-6)
