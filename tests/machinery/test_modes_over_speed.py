"""Critical speeds of modes that follow the speed: every crossing and the least distance, against searches in numpy."""

import csv
import json
import math

import numpy as np
import pytest
from support import campaigns
from support.command_line import run

import torsionnet as tn
from torsionnet.machinery.criticals import modes_over_speed
from torsionnet.machinery.criticals.critical_speed_search import order_margins
from torsionnet.machinery.criticals.modes_over_speed import ModesOverSpeed

RPM = np.pi / 30
TORQUE = 1e4


def propeller_coupling(excitation, *, damping=0.02, **more):
    """Two masses on a coupling that stiffens with the mean torque of a propeller: k at 10 kN m (n/1500 r/min)^2."""
    rows = {"0 kN*m": "40 kN*m/rad", "5 kN*m": "42 kN*m/rad", "7 kN*m": "120 kN*m/rad", "10 kN*m": "320 kN*m/rad"}
    return tn.Drivetrain(
        "propeller coupling",
        [tn.Inertia("engine", node="fly", inertia=60), tn.Inertia("screw", node="prop", inertia=78),
         tn.Spring("coupling", nodes=("fly", "prop"), stiffness="k", damping={"zeta": damping, "at": "8 Hz"})],
        parameters={"k": {"by": "mean_torque", "of": "coupling", "table": rows}},
        speeds={"of": "fly", "range": "600..1500 rpm", "step": "10 rpm", "rated": "1500 rpm"},
        load={"absorbed_at": "prop", "torque": TORQUE, "torque_exponent": 2, "driven_by": {"fly": 1}},
        excitations={"misfire": {"type": "harmonic", "node": "fly", **excitation}}, **more,
    )  # fmt: skip


def coupling_frequency(rpm):
    k = np.interp(TORQUE * (np.asarray(rpm) / 1500) ** 2, [0, 5e3, 7e3, 1e4], [4e4, 4.2e4, 1.2e5, 3.2e5])
    return np.sqrt(k * (1 / 60 + 1 / 78)) / (2 * np.pi)


def halved(side, low, high):
    """Speed between two at which ``side`` changes."""
    first = side(low)
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if side(middle) == first else (low, middle)
    return (low + high) / 2


HALF_ORDER = {"orders": {0.5: {"amplitude": "100 N*m"}}}
TWICE = [halved(lambda n: coupling_frequency(n) > n / 120, *ends) for ends in ((600, 900), (1000, 1500))]


class TestProgressiveCoupling:
    def test_an_order_meets_the_mode_twice(self):
        found = propeller_coupling(HALF_ORDER).critical_speeds(margin="api684")
        assert [one.natural_speed / RPM for one in found.crossings] == pytest.approx(TWICE, rel=1e-9)
        assert [one.undamped_speed / RPM for one in found.crossings] == pytest.approx(TWICE, rel=1e-9)
        assert [(one.margin, one.passes) for one in found.crossings] == [(0, False)] * 2
        assert [one.mode.natural_frequency for one in found.crossings] == pytest.approx(np.array(TWICE) / 120)
        with pytest.raises(tn.UsageError, match=r"(?s)662\.28.*1305\.8.*ambiguous-name"):
            found.of(1, 0.5)

    def test_a_single_speed_has_its_own_margin(self):
        (one,) = order_margins(propeller_coupling(HALF_ORDER), speeds=[1000 * RPM])
        assert one.margin == pytest.approx(1 - coupling_frequency(1000) * 120 / 1000, rel=1e-9)

    def test_beyond_the_table_nothing_is_made_up(self):
        """With the stiffness of 1500 r/min held it would be met at 1855 r/min, where the coupling is stiffer still."""
        found = propeller_coupling(HALF_ORDER).critical_speeds(reach=0.9)
        assert [one.natural_speed / RPM for one in found.crossings] == pytest.approx(TWICE)
        assert "tables and laws give the modes from 60 to 1500 rpm; critical speeds beyond are unknown" in found.notes

    def test_a_line_at_a_fixed_frequency_meets_it(self):
        found = propeller_coupling({"frequencies": {"10 Hz": {"amplitude": "100 N*m"}}}).critical_speeds(
            margin="api684"
        )
        (one,) = found.crossings
        assert one.natural_speed / RPM == pytest.approx(halved(lambda n: coupling_frequency(n) > 10, 600, 1500))
        assert (one.margin, one.passes, one.line) == (0, False, "10 Hz")

    @pytest.mark.parametrize(("zeta", "step"), [(0.0005, 0.7), (0.0005, 10), (0.0005, 300), (0.01, 8), (0.01, 300)])
    def test_every_peak_of_an_order_is_resolved(self, zeta, step):
        """The peak of two masses on k + j w c, of which 100 N m twist 78/138; half widths are 0.3 to 8 r/min."""
        ends = {"of": "fly", "range": "600..1500 rpm", "step": f"{step} rpm", "rated": "1500 rpm"}
        rig = propeller_coupling(HALF_ORDER, damping=zeta)
        rig = tn.Drivetrain("fine", rig.elements.values(), parameters=rig.definition.parameters, speeds=ends,
                            load=rig.definition.load, excitations=rig.definition.excitations)  # fmt: skip
        run_up = rig.order_response("torque(coupling)", refine=True)
        for critical in TWICE:
            near = np.linspace(critical - 20, critical + 20, 40001)
            w, reduced = 2 * np.pi * near / 120, 60 * 78 / 138
            k = (2 * np.pi * coupling_frequency(near)) ** 2 * reduced
            k = k * (1 + 2j * zeta * w / (2 * np.pi * 8))
            peak = np.abs(100 * 78 / 138 * k / (k - reduced * w**2)).max()
            around = np.abs(run_up.rpm - critical) < 20
            assert run_up.sizes[around].max() == pytest.approx(peak, rel=3e-3)

    def test_a_mode_that_is_higher_at_the_operating_point_is_in_the_picture(self):
        from torsionnet.plot import interference_diagram

        (axes,) = interference_diagram(propeller_coupling(HALF_ORDER).critical_speeds(margin="api684")).axes
        assert axes.get_ylim()[1] > coupling_frequency(1500)
        marks = np.concatenate(
            [np.asarray(one.get_offsets()) for one in axes.collections if len(one.get_offsets()) > 1]
        )
        assert marks[:, 0] == pytest.approx(TWICE)
        assert marks[:, 1] == pytest.approx(np.array(TWICE) / 120)

    def test_the_command(self, tmp_path):
        (tmp_path / "plant.yaml").write_text(propeller_coupling(HALF_ORDER).to_yaml(), encoding="utf-8")
        table = tmp_path / "critical.csv"
        printed = run("critical-speeds", tmp_path / "plant.yaml", "--margin", "api684", "--csv", table).stdout
        assert printed.count("under 10 %") == 2
        rows = csv.DictReader(line for line in table.read_text(encoding="utf-8").splitlines() if line[0] != "#")
        assert [float(row["|lambda| /2pi [rpm]"]) for row in rows] == pytest.approx(TWICE, rel=1e-5)


def two_masses(stiffness, parameters, excitations, **more):
    return tn.Drivetrain(
        "two", [tn.Inertia("A", node="a", inertia=60), tn.Inertia("B", node="b", inertia=78),
                tn.Spring("s", nodes=("a", "b"), stiffness=stiffness)],
        parameters=parameters, excitations=excitations,
        **{"speeds": {"of": "a", "range": "600..1500 rpm", "step": "50 rpm", "rated": "1500 rpm"}, **more},
    )  # fmt: skip


def order(value):
    return {"e": {"type": "harmonic", "node": "a", "orders": {value: {"amplitude": 1}}}}


class TestNearAndTouching:
    TABLE = {"600 rpm": 6e4, "1000 rpm": 1e5, "1500 rpm": 4e5}  # noqa: RUF012

    @staticmethod
    def frequency(k):
        return np.sqrt(k * (1 / 60 + 1 / 78)) / (2 * np.pi)

    def model(self, value):
        return two_masses("k", {"k": {"by": "speed", "of": "a", "table": self.TABLE}}, order(value))

    def test_a_line_that_passes_near_is_listed_where_a_rule_asks(self):
        found = self.model(0.5).critical_speeds(margin="api684")
        (one,) = found.crossings
        # The table bends at 1000 r/min, where the line of half the speed is nearest.
        assert one.margin == pytest.approx(self.frequency(1e5) * 120 / 1000 - 1, rel=1e-7)
        assert one.nearest_speed == pytest.approx(1000 * RPM)
        assert np.isnan([one.undamped_speed, one.natural_speed, one.damped_speed]).all()
        assert one.remark == "no crossing: nearest at 1000 rpm"
        assert not one.passes
        assert not self.model(0.5).critical_speeds().crossings
        assert not self.model(0.5).critical_speeds(margin="3 %").crossings

    @pytest.mark.parametrize(("aside", "count"), [(-1e-9, 1), (1e-9, 1), (-1e-4, 2), (1e-4, 0)])
    def test_a_line_that_touches_at_a_row_of_the_table(self, aside, count):
        touching = self.frequency(1e5) * 60 / 1000
        found = self.model(touching * (1 - aside)).critical_speeds().crossings
        assert len(found) == count
        for one in found:
            assert one.undamped_speed / RPM == pytest.approx(1000, rel=2e-3)
            assert one.margin == 0

    @pytest.mark.parametrize("rpm", [600.0, 1000.0, 1500.0, 1234.5])
    def test_a_crossing_on_a_row_or_an_end(self, rpm):
        k = np.interp(rpm, [600, 1000, 1500], list(self.TABLE.values()))
        found = self.model(float(self.frequency(k) * 60 / rpm)).critical_speeds(margin="api684").crossings
        at = [one.undamped_speed / RPM for one in found]
        assert min(np.abs(np.array(at) / rpm - 1)) < 1e-6
        assert len(at) == len({round(one, 2) for one in at})
        assert {one.margin for one in found} == {0.0}

    @pytest.mark.parametrize("aside", [-1e-2, -1e-5, 0.0, 1e-5, 1e-2])
    def test_a_line_that_touches_a_smooth_curve(self, aside):
        """k = k0 + k1 n^3 under a load with exponent 3: (f/n)^2 = a/n^2 + b n turns at n^3 = 2 a/b, between all rows."""
        turning, bound = 1000.0, 3 * TORQUE
        k0 = 5e4
        k1 = 2 * k0 / (TORQUE * (turning / 1500) ** 3)  # N m/rad per N m of the mean torque at the turning point
        load = {"absorbed_at": "b", "torque": TORQUE, "torque_exponent": 3, "driven_by": {"a": 1}}
        table = {"0 N*m": k0, f"{bound} N*m": k0 + k1 * bound}
        nearest = self.frequency(3 * k0) / turning * 60
        rig = two_masses(
            "k", {"k": {"by": "mean_torque", "of": "s", "table": table}}, order(nearest * (1 + aside)), load=load
        )
        found = rig.critical_speeds(margin="5 %").crossings
        a, b = (self.frequency(1.0) * 60) ** 2 * np.array([k0, 2 * k0 / turning**3])
        roots = np.roots([b, -((nearest * (1 + aside)) ** 2), 0, a])
        meant = np.sort([one.real for one in roots if abs(one.imag) < 1e-9 and 480 < one.real < 1900])
        if aside < 0:
            (one,) = found
            assert np.isnan([one.undamped_speed, one.natural_speed, one.damped_speed]).all()
            assert one.margin == pytest.approx(1 / (1 + aside) - 1, rel=1e-4)
            assert one.nearest_speed / RPM == pytest.approx(turning, rel=1e-4)
        elif aside > 0:
            assert [one.undamped_speed / RPM for one in found] == pytest.approx(meant, rel=1e-7)
            assert len(meant) == 2
        else:
            (one,) = found
            assert one.undamped_speed / RPM == pytest.approx(turning, rel=1e-4)
            assert one.margin < 1e-6

    def test_two_crossings_between_neighbouring_speeds(self):
        """A notch of 0.02 r/min in the table, far narrower than any grid."""
        table = {"600 rpm": 9e4, "1000 rpm": 9e4, "1000.01 rpm": 2e4, "1000.02 rpm": 9e4, "1500 rpm": 9e4}
        rig = two_masses("k", {"k": {"by": "speed", "of": "a", "table": table}}, order(self.frequency(5e4) * 60 / 1000))
        at = [one.undamped_speed / RPM for one in rig.critical_speeds().crossings]
        meant = [halved(lambda n: np.interp(n, [1e3, 1e3 + 0.01, 1e3 + 0.02], [9e4, 2e4, 9e4]) > 5e4 * (n / 1000) ** 2, *ends)
                 for ends in ((1000, 1000.01), (1000.01, 1000.02))]  # fmt: skip
        inside = [one for one in at if 600 <= one <= 1500 and abs(one - 1000) < 1]
        assert inside == pytest.approx(meant, abs=1e-6)

    def test_a_mode_that_runs_along_its_order_is_one_critical_speed(self):
        """A field of springs that grows with the square of the speed, as in pendulums: one row, not one a row of rounding."""
        rig = tn.Drivetrain(
            "field", [tn.Inertia("J", node="a", inertia=2), tn.Spring("s", nodes=("a", "ground"), stiffness="c*w^2")],
            parameters={"w": {"by": "speed", "of": "a"}, "c": "18 N*m*s^2/rad^3"}, excitations=order(3.0),
            speeds={"of": "a", "range": "600..1500 rpm", "step": "50 rpm", "rated": "1500 rpm"},
        )  # fmt: skip
        (one,) = rig.critical_speeds().crossings
        assert one.margin == 0


class TestStages:
    """A staged spring under mean torque: its tangent leaps where the torque passes from one stage to the next."""

    def rig(self, value):
        stages = [{"stiffness": 5e4, "to_torque": 4e3}, {"stiffness": 2e5}]
        spring = tn.Spring("s", nodes=("a", "b"), stages=stages)
        load = {"absorbed_at": "b", "torque": TORQUE, "torque_exponent": 2, "driven_by": {"a": 1}}
        plain = two_masses(1.0, {}, order(value), load=load)
        elements = [spring if one.name == "s" else one for one in plain.elements.values()]
        return tn.Drivetrain("staged", elements, speeds=plain.definition.speeds, load=load, excitations=order(value))

    def test_the_mode_leaps_over_the_line(self):
        """Half order at 948.7 r/min is 7.9 Hz, between 6.11 and 12.2 Hz of the two stages."""
        corner = 1500 * math.sqrt(0.4)
        found = self.rig(0.5).critical_speeds(margin="api684").crossings
        low, high = (120 * TestNearAndTouching.frequency(k) for k in (5e4, 2e5))
        assert [one.undamped_speed / RPM for one in found] == pytest.approx([low, corner, high])
        assert [one.leaps for one in found] == [False, True, False]
        assert "the mode leaps over the line" in found[1].remark


class TestWhichMode:
    """Two masses on springs of their own to a heavy hub, one of which stiffens with the speed."""

    def rig(self, coupling, **more):
        parts = [
            tn.Inertia("hub", node="r", inertia=1e9),
            tn.Inertia("A", node="a", inertia=1), tn.Spring("ka", nodes=("a", "r"), stiffness="k"),
            tn.Inertia("B", node="b", inertia=1), tn.Spring("kb", nodes=("b", "r"), stiffness=1e4),
            *([tn.Spring("kc", nodes=("a", "b"), stiffness=coupling)] if coupling else []),
        ]  # fmt: skip
        table = {"500 rpm": 4e3, "2500 rpm": 2.5e4}
        acting = {
            "e": {
                "type": "harmonic",
                "node": "r",
                "frequencies": {"13 Hz": {"amplitude": 1}, "20 Hz": {"amplitude": 1}},
            }
        }
        return tn.Drivetrain(
            "beats", parts, parameters={"k": {"by": "speed", "of": "r", "table": table}}, excitations=acting,
            speeds={"of": "r", "range": "500..2500 rpm", "step": "100 rpm", "rated": "500 rpm"}, **more,
        )  # fmt: skip

    @pytest.mark.parametrize("coupling", [0.0, 1e-3])
    def test_a_mode_that_crosses_another_keeps_its_number(self, coupling):
        """At 500 r/min a is the lower mode, at 2500 r/min the higher one; its shape goes through the other's frequency."""
        found = self.rig(coupling).critical_speeds()
        slope = (2.5e4 - 4e3) / 2000
        for line in (13, 20):
            (one,) = [each for each in found.crossings if each.fixed == line and each.mode.number == 1]
            assert one.undamped_speed / RPM == pytest.approx(500 + ((2 * np.pi * line) ** 2 - 4e3) / slope, rel=1e-6)
            shape = dict(zip(found.nodes, np.abs(one.mode.shape), strict=True))
            assert shape["a"] == 1
            assert shape["b"] < 1e-3

    @pytest.mark.parametrize("least", [1e4, 3e4])
    def test_a_vibration_ends_where_it_is_overdamped(self, least, monkeypatch):
        """Of two masses where c(n) = 2 sqrt(k J); its speed is halved in, with few sets of modes."""
        solved = []
        monkeypatch.setattr(modes_over_speed, "modes", lambda rig: solved.append(rig) or rig.modes())
        rig = tn.Drivetrain(
            "film", [tn.Inertia("A", node="a", inertia=60), tn.Inertia("B", node="b", inertia=78),
                     tn.Spring("s", nodes=("a", "b"), stiffness=4e5), tn.Damper("d", nodes=("a", "b"), damping="c")],
            parameters={"c": {"by": "speed", "of": "a", "table": {"600 rpm": 1e3, "1500 rpm": least}}},
            speeds={"of": "a", "range": "600..1500 rpm", "step": "50 rpm", "rated": "600 rpm"},
        )  # fmt: skip
        pieces = ModesOverSpeed(rig, "a", (600 * RPM, 1500 * RPM)).pieces
        inertia = 1 / (1 / 60 + 1 / 78)
        end = 600 + 900 * (2 * math.sqrt(4e5 * inertia) - 1e3) / (least - 1e3)
        vibrates = [np.isfinite(piece.values[:, 1]).all() for piece in pieces]
        last = max(piece.speeds[-1] for piece, whole in zip(pieces, vibrates, strict=True) if whole)
        assert 0 <= end - last / RPM < 0.1
        assert len(solved) < 100

    def test_modes_that_veer_keep_their_order(self):
        """Coupled by a tenth they exchange their shapes over hundreds of r/min and never meet."""
        rig = self.rig(1e3)
        over = ModesOverSpeed(rig, "r", (500 * RPM, 2500 * RPM), [1, 2])
        for rpm in (500, 1100, 1700, 2500):
            first, second = sorted(over.at(rpm * RPM), key=lambda mode: mode.number)
            k = np.interp(rpm, [500, 2500], [4e3, 2.5e4])
            meant = np.sqrt(np.linalg.eigvalsh([[k + 1e3, -1e3], [-1e3, 1.1e4]])) / (2 * np.pi)
            assert (first.undamped_frequency, second.undamped_frequency) == pytest.approx(tuple(meant))


# --- random chains --------------------------------------------------------------------------------------------------


def cubic_tangent(torque, k, c):
    twist = np.zeros_like(torque)
    for _ in range(100):
        twist = twist - (k * twist + c * twist**3 - torque) / (k + 3 * c * twist**2)
    return k + 3 * c * twist**2


def drawn_spring(rng, name, low, high, torque):
    """Entries and parameters of a spring, and its stiffness over r/min: constant, over speed or torque, cubic, staged."""
    k = float(rng.uniform(3e4, 4e5))
    kind = rng.choice(["constant", "speed", "mean_torque", "cubic", "stages", "rows"])
    if kind == "constant":
        return {"stiffness": k}, {}, lambda n: np.full_like(n, k), []
    if kind in ("speed", "mean_torque"):
        ends, unit, of = ([low / 2, high * 1.5], "rpm", "n0") if kind == "speed" else ([0.0, 4 * TORQUE], "N*m", name)
        middle = (low, high) if kind == "speed" else (0.0, TORQUE)
        keys = np.sort([*ends, *rng.uniform(*middle, int(rng.integers(0, 5)))])
        values = k * np.exp(rng.uniform(-1, 1.3, len(keys)))
        table = {f"{key!r} {unit}": value for key, value in zip(keys.tolist(), values.tolist(), strict=True)}
        over = (lambda n: n) if kind == "speed" else torque
        return {"stiffness": f"k_{name}"}, {f"k_{name}": {"by": kind, "of": of, "table": table}}, (
            lambda n: np.interp(over(n), keys, values)
        ), [(over, key) for key in keys]  # fmt: skip
    if kind == "cubic":
        c = float(k**3 / TORQUE**2 * np.exp(rng.uniform(-2, 2)))
        return {"stiffness": k, "cubic": c}, {}, lambda n: cubic_tangent(torque(n), k, c), []
    if kind == "stages":
        end, after = float(rng.uniform(0.1, 0.9) * TORQUE), float(k * np.exp(rng.uniform(-0.5, 1.5)))
        entries = {"stages": [{"stiffness": k, "to_torque": end}, {"stiffness": after}]}
        return entries, {}, lambda n: np.where(torque(n) < end, k, after), [(torque, end)]
    twists, slopes = np.cumsum(rng.uniform(0.01, 0.05, 3)), k * np.exp(rng.uniform(-1, 1, 3))
    torques = np.cumsum(np.diff([0, *twists]) * slopes)
    factor = 4 * TORQUE / torques[-1]
    rows = [[0.0, 0.0], *([float(a), float(factor * b)] for a, b in zip(twists, torques, strict=True))]
    found = lambda n: factor * slopes[np.minimum(np.searchsorted(factor * torques, torque(n)), 2)]  # noqa: E731
    return {"torque_over_twist": rows}, {}, found, [(torque, one) for one in factor * torques]


class DrawnChain:
    """Two or three masses under a load over speed, with rising, falling and constant lines, and its frequencies."""

    def __init__(self, seed):
        rng = np.random.default_rng(seed)
        self.inertias = rng.uniform(20, 100, int(rng.integers(2, 4)))
        self.low = float(rng.uniform(300, 700))
        self.high = self.low * float(rng.uniform(1.8, 3))
        exponent = float(rng.choice([1, 2, 3]))
        torque = lambda n: TORQUE * (n / self.high) ** exponent  # noqa: E731
        elements = {
            f"J{i}": {"type": "inertia", "node": f"n{i}", "inertia": float(J)} for i, J in enumerate(self.inertias)
        }
        parameters, self.stiffnesses, corners = {}, [], []
        for i in range(len(self.inertias) - 1):
            entries, more, stiffness, own = drawn_spring(rng, f"s{i}", self.low, self.high, torque)
            elements[f"s{i}"] = {"type": "spring", "nodes": [f"n{i}", f"n{i + 1}"], **entries}
            parameters |= more
            self.stiffnesses.append(stiffness)
            corners += own
        grid = np.linspace(self.low, self.high, 1501)
        kinks = [halved(lambda n: over(n) > key, self.low, self.high) for over, key in corners  # noqa: B023
                 if over(self.low) < key < over(self.high)]  # fmt: skip
        self.grid = np.unique([*grid, *(kink * (1 + side) for kink in kinks for side in (-1e-12, 1e-12))])
        self.model = tn.loads(json.dumps({
            "torsionnet": 1,
            "name": f"chain {seed}", "elements": elements, "parameters": parameters,
            "speeds": {"of": "n0", "range": [f"{self.low!r} rpm", f"{self.high!r} rpm"], "step": "20 rpm",
                       "rated": f"{self.high!r} rpm"},
            "load": {"absorbed_at": f"n{len(self.inertias) - 1}", "torque": TORQUE, "torque_exponent": exponent,
                     "driven_by": {"n0": 1}},
            "excitations": {
                "h": {"type": "harmonic", "node": "n0", "orders": {float(rng.choice([0.5, 1, 1.5, 2])): {"amplitude": 1}},
                      "frequencies": {f"{float(rng.uniform(4, 30))!r} Hz": {"amplitude": 1}}},
                "start": {"type": "electric_machine", "node": "n0", "pole_pairs": int(rng.integers(1, 4)), "rated_torque": 1e4,
                          "slip": {"frequency": f"{float(rng.uniform(8, 40))!r} Hz", "amplitude": [["0 rpm", 1], ["9000 rpm", 1]]}},
            },
        }))  # fmt: skip

    def frequencies(self, rpm):
        """Natural frequencies (n, n_modes) in Hz by rank."""
        rpm = np.atleast_1d(np.asarray(rpm, dtype=float))
        K = np.zeros((len(rpm), len(self.inertias), len(self.inertias)))
        for i, stiffness in enumerate(self.stiffnesses):
            K[:, [i, i + 1], [i, i + 1]] += stiffness(rpm)[:, None]
            K[:, [i, i + 1], [i + 1, i]] -= stiffness(rpm)[:, None]
        weights = 1 / np.sqrt(self.inertias)
        return np.sqrt(np.linalg.eigvalsh(K * weights[:, None] * weights)[:, 1:]) / (2 * np.pi)


def require_all_crossings(chain):
    found = chain.model.critical_speeds(margin="10 %", reach=0.1)
    every = chain.frequencies(chain.grid)
    for line in found.lines:
        meant = lambda n, line=line: np.abs(line.frequency(np.asarray(n) * RPM))  # noqa: E731
        counted = (every < meant(chain.grid)[:, None]).sum(axis=1)  # modes below the line, an integer
        crossed = 0
        for rank in range(every.shape[1]):
            below = every[:, rank] < meant(chain.grid)
            side = lambda n, rank=rank, meant=meant: bool(chain.frequencies(n)[0, rank] < meant(n))  # noqa: E731
            roots = [halved(side, *chain.grid[at : at + 2]) for at in np.flatnonzero(below[1:] != below[:-1])]
            crossed += len(roots)
            with np.errstate(divide="ignore"):
                apart = np.abs(every[:, rank] - meant(chain.grid)) / meant(chain.grid)
            rows = [one for one in found.crossings if one.mode.number == rank + 1
                    and (one.excitation, one.order, one.fixed) == (line.excitation, line.order, line.fixed)]  # fmt: skip
            at = np.array([one.natural_speed / RPM for one in rows])
            own = at[(at > chain.low * (1 - 1e-9)) & (at < chain.high * (1 + 1e-9))]
            assert own == pytest.approx(roots, rel=1e-7), (str(line), rank)
            margin = 0.0 if roots else apart.min()
            assert {round(one.margin, 12) for one in rows} <= {round(rows[0].margin, 12)} if rows else margin > 0.0999
            if rows:
                assert rows[0].margin == pytest.approx(margin, abs=1e-5), (str(line), rank)
        assert crossed >= np.abs(np.diff(counted)).sum()


@pytest.mark.parametrize("seed", [1, 3, 39])
def test_random_chains(seed):
    require_all_crossings(DrawnChain(seed))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 100 + campaigns.examples(8, 300)))
def test_more_random_chains(seed):
    require_all_crossings(DrawnChain(seed))
