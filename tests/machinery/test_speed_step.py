"""Verdicts, utilisations, barred ranges and largest orders do not depend on the step of speeds."""

import csv
import json
import math

import numpy as np
import pytest
from support import campaigns
from support.command_line import run
from support.dense_speeds import HIGH, LOW, RPM, Chain
from support.limit_cases import hump, m68, stressed
from support.ship_plant import SHIP

import torsionnet as tn
from torsionnet.machinery.limits.m68_factors import usual_range
from torsionnet.machinery.orders.refined_response import ExaminedSpeeds
from torsionnet.machinery.orders.speed_refinement import speeds_to_refine
from torsionnet.machinery.verdicts.speed_spans import joined_spans
from torsionnet.model.configurations import combinations
from torsionnet.study.quantities.critical_speed_margin import Utilisation
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.quantities.order_torque import OrderTorque

KNOWN = 1e-3


def spans(found):
    return np.array([(span.low, span.high) for span in found]).reshape(-1, 2) / RPM


def require_known(chain, value, steps, dense=0.2):
    """Utilisation, verdict and ranges are those of a dense grid, whatever the step."""
    checks = [chain.model(step, value).check_limits() for step in steps]
    worst = [float(check.rpm[check.verdicts[0].worst]) for check in checks]
    rpm = np.unique(np.clip(chain.dense([worst[0], worst[-1]], dense), LOW, HIGH))
    half = chain.half_range(rpm)
    for step, check in zip(steps, checks, strict=True):
        (one,) = check.verdicts
        assert one.utilisation.max() == pytest.approx(half.max() / value, rel=KNOWN), step
        assert one.verdict == checks[-1].verdicts[0].verdict, step
        assert spans(one.barred) == pytest.approx(spans(checks[-1].verdicts[0].barred), rel=2e-4), step
        inside = np.any([(rpm >= low) & (rpm <= high) for low, high in spans(one.barred)], axis=0) | np.zeros(
            len(rpm), bool
        )
        if one.verdict == "barred range":
            assert half[~inside].max() < value * 1.02, step
            ends = spans(one.barred).ravel()
            ends = ends[(ends > LOW) & (ends < HIGH)]  # beyond the speeds examined nothing is known
            assert chain.half_range(ends).max(initial=0.0) < value * 1.02, step


@pytest.mark.parametrize("seed", [3, 7, 12])
def test_random_drivetrains(seed):
    chain = Chain.drawn(seed)
    half = chain.half_range(np.arange(LOW, HIGH, 0.5))
    require_known(chain, float(np.quantile(half, 0.9)), (40, 2))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1000, 1000 + campaigns.examples(2, 60)))
def test_random_drivetrains_against_a_dense_grid(seed):
    chain = Chain.drawn(seed)
    half = chain.half_range(np.arange(LOW, HIGH + 0.01, 0.02))
    require_known(chain, float(np.quantile(half, 0.9)), (40, 5, 2, 0.5, 0.1), 0.02)


def at_steps(model, limits, steps, **options):
    """Checks of a model with its range of speeds and other steps, r/min."""
    values = model.definition.speeds.values
    low, high = values[0] / RPM, values[-1] / RPM
    return [
        model.check_limits(limits, speeds=np.append(np.arange(low, high - 1e-6, step), high) * RPM, **options)
        for step in steps
    ]


def test_the_teeth_of_the_ship():
    """A mode of the shafts with a damping ratio of 1e-4 makes a peak of 0.1 r/min, between the speeds of the file.

    The propeller keeps its damping of full power, which saves time.
    """
    ship = tn.load("marine_medium_speed").configured(
        "water=wet,coupling=warm,firing=normal", Q_prop="188.7 kN*m", n_prop="151.8 rpm"
    )
    (coarse,), check = at_steps(ship, "teeth", (7,)), ship.check_limits("teeth")
    one = check.of("teeth", "T_v")
    near = check.speeds[one.worst] + np.linspace(-0.4, 0.4, 401) * RPM
    dense = ship.order_response("T_mesh", speeds=near).half_range[:, 0].max()
    assert one.values.max() == pytest.approx(dense, rel=KNOWN)
    assert coarse.of("teeth", "T_v").utilisation.max() == pytest.approx(one.utilisation.max(), rel=KNOWN)
    grid = ship.order_response("T_mesh").half_range[:, 0].max()
    assert grid < 0.9 * dense, "the grid has this peak: take another case"


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    campaigns.by_day(["marine_medium_speed", "two_stroke_ship", "reciprocating_compressor_train"], "two_stroke_ship"),
)
def test_library_machines(name):
    """Every limit of every configuration: several steps, and the largest of a grid of 0.02 r/min around each worst speed."""
    rig = tn.load(name)
    for choice in combinations(rig.definition.configurations):
        configuration = ",".join(f"{axis}={name}" for axis, name in choice.items())
        case = rig.configured(configuration) if configuration else rig
        checks = at_steps(case, None, (2, 0.5) if len(rig.definition.configurations) > 1 else (2, 0.5, 0.1))
        for place, one in enumerate(checks[0].verdicts):
            for other in checks[1:]:
                again = other.verdicts[place]
                assert again.verdict == one.verdict, (configuration, one.limit, one.criterion)
                if one.worst is not None:
                    assert np.nanmax(again.utilisation) == pytest.approx(np.nanmax(one.utilisation), rel=KNOWN)
                    assert spans(again.barred) == pytest.approx(spans(one.barred), rel=2e-4)
            if one.worst is None:
                continue
            low, high = checks[0].speeds[[0, -1]]
            near = np.clip(checks[0].speeds[one.worst] + np.arange(-1, 1, 0.02) * RPM, low, high)
            dense = case.check_limits(one.limit, speeds=np.unique(near), refine=False).verdicts
            (same,) = [each for each in dense if each.criterion == one.criterion]
            if same.worst is not None:
                assert np.nanmax(same.utilisation) <= np.nanmax(one.utilisation) * (1 + KNOWN)


class TestJumpsOfWhatIsAllowed:
    def test_where_a_table_ends_next_to_a_peak(self):
        """It ends between two speeds, on the rising flank of a peak: the value there counts, and none beyond."""
        chain = Chain.drawn(7)
        rpm = np.arange(LOW + 1, HIGH, 0.1)
        half = chain.half_range(rpm)
        end = float(rpm[np.argmax(half)]) - 0.3
        table = {"over_speed": {f"{LOW} rpm": "1 kN*m", f"{end} rpm": "1 kN*m"}}
        expected = chain.half_range(np.append(rpm[rpm < end], end)).max() / 1000
        for step in (40, 3):
            found = chain.model(step, None, table).check_limits().verdicts[0]
            assert np.nanmax(found.utilisation) == pytest.approx(expected, rel=KNOWN)
            assert f"judged from {LOW:g} to {end:g} rpm" in found.remarks[0]

    @pytest.mark.parametrize("step", ["1.7 rpm", "0.45 rpm"])
    def test_the_ends_of_the_rule_of_class(self, step):
        text = SHIP.replace("30..108 rpm, step: 1 rpm", f"30..112 rpm, step: {step}")
        check = tn.loads(text).configured("normal").check_limits("intermediate")
        passing, whole = check.of("intermediate", "tau_T"), check.of("intermediate", "tau_C")
        assert check.rpm[np.isfinite(passing.allowed)][-1] == pytest.approx(0.8 * 105)
        assert check.rpm[np.isfinite(whole.allowed)][-1] == pytest.approx(1.05 * 105)


class TestBarredRanges:
    def test_around_the_speed_of_the_stress_peak(self):
        """n_c of 16 n_c/(18 - lambda) lies between two speeds that have been examined."""
        (span,) = stressed(hump(90, 50.2), m68())["tau_C"].barred
        usual = usual_range(50.2, 100.0)
        assert (span.low / RPM, span.high / RPM) == pytest.approx((usual.low, usual.high), abs=2e-3)

    def test_not_that_of_the_largest_utilisation(self):
        """Where the stress permitted falls with speed, the stress peak of a broad hump lies below it."""
        text = SHIP.replace("30..108 rpm, step: 1 rpm", "30..108 rpm, step: 1.3 rpm")
        check = tn.loads(text).configured("normal").check_limits("intermediate")
        one = check.of("intermediate", "tau_C")
        top = check.rpm[np.argmax(one.values)]
        (span,) = spans(one.barred)
        assert span == pytest.approx([part * 1.0 for part in _with_tolerance(usual_range(top, 105.0), 0.01)], rel=1e-3)

    @pytest.mark.slow
    def test_of_each_misfire_as_if_it_were_alone(self):
        """The union of what the cylinders need one by one, not what their envelope needs."""
        text = SHIP.replace("engine.misfire: [2]", "engine.misfire: each").replace(
            "30..108 rpm, step: 1 rpm", "40..70 rpm, step: 2.5 rpm"
        )
        text = text.replace("safe_speed: 70 rpm", "tachometer_tolerance: 2 %").replace(
            "tachometer_tolerance: 1 %, ", ""
        )
        each = tn.loads(text).configured("misfire").check_limits("intermediate")
        alone = [
            tn.loads(text.replace("misfire: each", f"misfire: [{number}]")).configured("misfire")
            .check_limits("intermediate")
            for number in range(1, 7)
        ]  # fmt: skip
        wanted = joined_spans([span for check in alone for span in check.of("intermediate", "tau_C").barred])
        assert len(wanted)
        assert spans(each.barred) == pytest.approx(spans(wanted), rel=1e-4)

    def test_the_lower_peak_of_another_cylinder_begins_earlier(self):
        """Two cases whose humps overlap: the rule of thumb around the lower one reaches further down."""
        rpm = np.arange(20.0, 104.01, 0.5)
        cases = np.stack([hump(92, 51.2)(rpm), hump(75, 49.7)(rpm)], axis=1)
        found = stressed(lambda _: cases.max(axis=1), m68(), rpm, misfire=True, cases=cases)["tau_C"]
        (span,) = found.barred
        assert span.low / RPM == pytest.approx(usual_range(49.7, 100.0).low, abs=5e-3)
        assert span.high / RPM == pytest.approx(usual_range(51.2, 100.0).high, abs=5e-3)

    def test_limits_by_curve_have_the_tolerance_of_the_tachometer(self):
        chain = Chain.drawn(7)
        half = chain.half_range(np.arange(LOW, HIGH, 0.2))
        value = float(np.quantile(half, 0.97))
        without = spans(chain.model(4, value).check_limits().barred)
        wide = chain.model(4, value, {"value": value, "tachometer_tolerance": "2 %"}).check_limits()
        expected = joined_spans([span.widened(0.02) for span in chain.model(4, value).check_limits().barred])
        assert len(without)
        assert spans(wide.barred) == pytest.approx(np.clip(spans(expected), LOW, HIGH), rel=1e-4)

    def test_they_end_where_speeds_do_and_that_is_said(self):
        found = stressed(hump(90, 21), m68())["tau_C"]
        assert found.barred[0].low == pytest.approx(20 * RPM)
        assert "the range begins at 20.0 rpm: no lower speed was examined" in found.remarks
        high = stressed(hump(90, 103), m68(), misfire=True)["tau_C"]
        assert high.barred[0].high == pytest.approx(104 * RPM)
        assert "the range ends at 104.0 rpm: no higher speed was examined" in high.remarks
        beyond = stressed(hump(90, 104), m68(), rpm=np.arange(60.0, 115.01, 0.5), misfire=True)["tau_C"]
        assert beyond.barred[0].high == pytest.approx(105 * RPM)
        assert "the range ends at 105.0 rpm: the rule says nothing above lambda = 1.05" in beyond.remarks


def _with_tolerance(span, tolerance):
    return span.low * (1 - tolerance), span.high * (1 + tolerance)


class TestOrders:
    @pytest.mark.slow
    def test_largest_half_range_and_orders(self):
        """Of a random chain, against its own grid; each single order, too."""
        chain = Chain.drawn(12)
        half = chain.half_range(np.unique(np.clip(chain.dense([], 0.05), LOW, HIGH)))
        for step in (30,):
            run = chain.model(step, 1).order_response(f"torque(k{chain.at})", refine=True)
            assert run.half_range.max() == pytest.approx(half.max(), rel=KNOWN)
            alone = [Chain(**{**vars(chain), "orders": (order,), "torques": chain.torques[[place]]})
                     for place, order in enumerate(chain.orders)]  # fmt: skip
            for place, one in enumerate(alone):
                top = one.half_range(
                    np.unique(np.clip(one.dense([run.rpm[run.sizes[:, place, 0].argmax()]], 0.5), LOW, HIGH))
                )
                if top.max() > 0.1 * half.max():
                    assert run.sizes[:, place, 0].max() == pytest.approx(top.max(), rel=KNOWN)

    def test_the_speeds_asked_for_are_among_them(self):
        run = Chain.drawn(12).model(30, 1).order_response("torque(k0)", refine=True)
        assert np.abs(np.arange(300, 801, 30)[:, None] - run.rpm).min(axis=1).max() < 1e-9

    def test_a_list_of_speeds_is_all_that_is_examined(self):
        """An engine of constant speeds never runs between them."""
        model = Chain.drawn(12).model(30, 1)
        rig = tn.Drivetrain("listed", model.elements.values(), excitations=model.definition.excitations,
                            speeds={"of": "n0", "list": ["400 rpm", "600 rpm"]}, limits=model.definition.limits)  # fmt: skip
        assert rig.check_limits().rpm.tolist() == pytest.approx([400, 600])
        assert len(rig.check_limits(refine=True).rpm) > 2
        assert len(rig.order_response("torque(k0)", refine=True).speeds) == 2


@pytest.mark.parametrize(
    ("speeds", "refine", "between"),
    [([50, 60], None, True), ([50], None, False), ([50, 60, 60], None, False), ([60, 50], True, False),
     ([50, 60], False, False), (None, None, False), (None, True, True)],
)  # fmt: skip
def test_speeds_are_added_between_two_or_more_that_rise(speeds, refine, between):
    """Not between those of a list in the model, unless that is asked for."""
    rig = tn.Drivetrain(
        "mass", [tn.Inertia("J", node="a", inertia=2), tn.Spring("s", nodes=("a", "ground"), stiffness=100)],
        speeds={"of": "a", "list": [40, 70]},
        excitations={"e": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": 1}}}},
    )  # fmt: skip
    examined = ExaminedSpeeds.of(rig, speeds, refine=refine)
    assert (examined.refine, examined.ends) == (between, (min(speeds or [40]), max(speeds or [70])))


def test_where_to_look_next():
    """A sharp peak between two speeds, a valley down to a level, and an end of a range."""
    speeds = np.linspace(10, 20, 11)
    curve = lambda n: 1 / np.hypot(1, 20 * (n - 14.3))[:, None]  # noqa: E731
    for _ in range(8):
        more = speeds_to_refine(speeds, curve(speeds))
        speeds = np.sort(np.append(speeds, more))
    assert curve(speeds).max() == pytest.approx(1, rel=KNOWN)
    assert len(speeds) < 40
    assert not len(speeds_to_refine(speeds, np.zeros((len(speeds), 1)), 1.0))
    straight = (speeds - 8)[:, None]
    assert not len(speeds_to_refine(speeds, straight))
    assert np.abs(speeds_to_refine(speeds, straight, 8.45) - 16.45).min() < 0.02
    assert math.isfinite(float(speeds_to_refine(speeds, np.where(speeds > 12, straight.T, np.nan).T, 6.5)[0]))


def test_a_valley_between_two_speeds_falls_below_a_level():
    speeds, curve = np.linspace(10, 20, 11), lambda n: (2 - 1.8 / (1 + (n - 14.5) ** 2))[:, None]
    assert curve(speeds).min() > 0.4
    for _ in range(4):
        speeds = np.sort(np.append(speeds, speeds_to_refine(speeds, curve(speeds), 0.4)))
    assert curve(speeds).min() == pytest.approx(0.2, rel=0.01)


class TestOrdersOfOneFrequency:
    """Engine and propeller on one shaft have order 4 both: apart they are 30 and 20 N m, together what is measured."""

    @staticmethod
    def fan(**more):
        elements = [tn.Inertia("J", node="a", inertia=1), tn.Inertia("K", node="b", inertia=1),
                    tn.Spring("shaft", nodes=("a", "b"), stiffness=1e9)]  # fmt: skip
        acting = {"engine": {"type": "harmonic", "node": "a", "orders": {4: {"amplitude": "60 N*m"}, 2: {"amplitude": 1}}},
                  "screw": {"type": "harmonic", "node": "b", "orders": {4: {"amplitude": "40 N*m", "phase": "120 deg"}}}}  # fmt: skip
        return tn.Drivetrain("ship", elements, speeds={"of": "a", "range": "60..100 rpm", "step": "10 rpm"},
                             excitations=acting, **more)  # fmt: skip

    def test_they_are_listed_apart_and_as_their_sum(self):
        rows = {row[0]: row[2] for row in self.fan().order_response("torque(shaft)", refine=True).table().rows}
        together = abs(30 - 20 * np.exp(2j * np.pi / 3))
        assert rows["engine 4"] == pytest.approx(30, rel=1e-4)
        assert rows["screw 4"] == pytest.approx(20, rel=1e-4)
        assert rows["engine 4 + screw 4"] == pytest.approx(together, rel=1e-4)
        assert not [name for name in rows if "engine 2 +" in name]

    def test_they_are_written_apart_and_as_their_sum(self, tmp_path):
        plant, written = tmp_path / "ship.yaml", tmp_path / "orders.csv"
        plant.write_text(self.fan().to_yaml(), encoding="utf-8")
        text = run("orders", str(plant), "--output", "torque(shaft)", "--csv", str(written), "--json").stdout
        together = abs(30 - 20 * np.exp(2j * np.pi / 3))
        (output,) = json.loads(text)[0]["outputs"]
        (both,) = output["sums"]
        assert (both["lines"], both["of_reference"]) == ("engine 4 + screw 4", 4)
        assert np.hypot(both["real"], both["imag"]).max() == pytest.approx(together, rel=1e-4)
        lines = csv.reader(written.read_text(encoding="utf-8").splitlines())
        rows = [[float(cell) for cell in line[2:]] for line in lines if line[1:2] == ["engine 4 + screw 4"]]
        assert {row[0] for row in rows} == {4}
        assert [row[2:4] for row in rows] == [list(pair) for pair in zip(both["real"], both["imag"], strict=True)]

    def test_a_limit_on_each_order_is_on_the_sum(self):
        limit = {"rule": "curve", "output": "torque(shaft)", "value": "40 N*m", "measure": "each_order", "source": "x"}
        check = self.fan(limits={"all": limit, "two": {**limit, "orders": [2]}}).check_limits()
        assert check.of("all").values.max() == pytest.approx(abs(30 - 20 * np.exp(2j * np.pi / 3)), rel=1e-4)
        assert check.of("all").verdict == "fail"
        assert check.of("two").values.max() == pytest.approx(0.5, rel=1e-4)


def test_what_nothing_damps_is_said():
    elements = [tn.Inertia("J", node="a", inertia=2), tn.Inertia("K", node="b", inertia=1),
                tn.Spring("s", nodes=("a", "b"), stiffness=1e4)]  # fmt: skip
    rig = tn.Drivetrain(
        "undamped", elements, speeds={"of": "a", "range": "400..800 rpm", "step": "25 rpm"},
        excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}},
        limits={"s": {"rule": "curve", "output": "torque(s)", "value": "100 N*m", "source": "x"}},
    )  # fmt: skip
    (one,) = rig.check_limits().verdicts
    assert one.verdict == "barred range"
    assert any("nothing damps the resonance at 584.77" in remark for remark in one.remarks)
    # |T| = 10 * 2 k/(3 k - 2 w^2) is 100 N m
    ends = [math.sqrt((1.5 - sign * 0.1) * 1e4) / 2 for sign in (1, -1)]
    assert (one.barred[0].low, one.barred[0].high) == pytest.approx(ends, rel=1e-4)


def test_the_largest_over_speed_of_a_study():
    """Every variant against its own dense grid, with a step of 30 and of 3 r/min."""
    chain = Chain.drawn(12)
    factors = np.array([0.8, 1.0, 1.3])
    expected = []
    for factor in factors:
        stiffnesses = chain.stiffnesses.copy()
        stiffnesses[0] *= factor
        one = Chain(**{**vars(chain), "stiffnesses": stiffnesses})
        top = one.model(30, 1).order_response(f"torque(k{chain.at})", refine=True)
        near = [float(top.rpm[top.half_range.argmax()])]
        expected.append(one.half_range(np.unique(np.clip(one.dense(near, 0.5), LOW, HIGH))).max())
    asked = {"T": OrderTorque(output=f"torque(k{chain.at})"), "used": Utilisation(limit="shaft")}
    for step in (30, 3):
        model = chain.model(step, 100, parameters={"k": float(chain.stiffnesses[0])}, stiffness="k")
        found = Evaluator(model, ("k",), asked)({"k": factors * chain.stiffnesses[0]})
        assert found["T"] == pytest.approx(expected, rel=KNOWN)
        assert found["used"] == pytest.approx(np.array(expected) / 100, rel=KNOWN)
