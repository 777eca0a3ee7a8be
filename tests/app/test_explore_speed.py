"""The explore page over speed, without its browser: orders of the library, and closed forms."""

import json
import shlex
from dataclasses import replace

import numpy as np
import pytest
from support import running_fan, running_ship
from support.library_cases import library_cases

import torsionnet as tn
from torsionnet.app.cli import main
from torsionnet.app.explore import Documents, open_session
from torsionnet.app.explore.answers import answer
from torsionnet.app.explore.api import reply
from torsionnet.app.explore.over_speed import CURVES_ALONE, MOST_ORDERS, ROUGH_SPEEDS
from torsionnet.app.explore.state import RequestError, State, read_state

OVER_SPEED = State(output="T", axis="speed")


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return running_fan.write(tmp_path_factory.mktemp("fan"))


@pytest.fixture(scope="module")
def session(path):
    return open_session(path)


class TestAnswers:
    @pytest.mark.parametrize("choice", [{}, {"supply": "rough"}])
    def test_half_range_and_orders_are_those_of_the_library(self, session, path, choice):
        orders = answer(session, State(choice, {"k": "14 kN*m/rad"}, "T", axis="speed"))["orders"]
        rig = tn.load(path).configured(",".join("=".join(pair) for pair in choice.items()), k="14 kN*m/rad")
        run = rig.order_response("T")
        np.testing.assert_array_equal(orders["rpm"], run.rpm)
        np.testing.assert_array_equal(orders["half_range"], run.half_range[:, 0])
        for line in orders["orders"]:
            excitation, order = line["name"].split()
            expected = np.abs(run.of_order(float(order), "T", excitation))
            np.testing.assert_allclose(line["magnitude"], expected, rtol=1e-14)

    def test_an_order_is_that_of_two_masses_and_a_spring(self, session):
        orders = answer(session, OVER_SPEED)["orders"]
        blades = [line for line in orders["orders"] if line["name"].startswith("blades")]
        for line in blades:
            expected = running_fan.shaft_torque(np.array(orders["rpm"]), int(line["name"].split()[1]))
            np.testing.assert_allclose(line["magnitude"], expected, rtol=1e-9)
        assert len(blades) >= MOST_ORDERS - 1

    def test_the_largest_orders_the_largest_first(self, session):
        orders = answer(session, OVER_SPEED)["orders"]
        tops = [max(line["magnitude"]) for line in orders["orders"]]
        assert tops == sorted(tops, reverse=True)
        run = session.base.order_response("T")
        assert tops == sorted(np.abs(run.values[:, :, 0]).max(axis=0), reverse=True)[:MOST_ORDERS]
        assert (len(tops), orders["count"]) == (MOST_ORDERS, 6)

    def test_speeds_and_what_is_said_about_them(self, session):
        orders = answer(session, OVER_SPEED)["orders"]
        assert (orders["reference"], orders["rated"]) == ("motor", pytest.approx(1200))
        assert orders["range"] == pytest.approx([300, 1500])
        assert orders["total"] == "all orders, half range"
        assert orders["units"] == {"rad": "N*m", "deg": "N*m"}

    def test_degrees(self, session):
        orders = answer(session, State(output="twist", axis="speed"))["orders"]
        assert orders["units"] == {"rad": "rad", "deg": "deg"}
        assert orders["scales"] == pytest.approx({"rad": 1, "deg": 180 / np.pi})

    def test_shafts_without_a_common_cycle(self, path):
        model = json.loads(path.read_text(encoding="utf-8"))
        model["elements"]["belt"]["ratio"] = 2.7182818
        session = open_session(str(path), text=json.dumps(model))
        assert answer(session, OVER_SPEED)["orders"]["total"] == "all orders, half range, worst position of shafts"

    def test_the_rest_of_the_page_is_there(self, session):
        found = answer(session, OVER_SPEED)
        assert found["modes"]["natural"] == answer(session, State(output="T"))["modes"]["natural"]
        assert [one["name"] for one in found["parameters"]] == ["k", "c", "J"]
        assert found["cut"] is None
        assert "response" not in found
        assert "orders" not in answer(session, State(output="T"))
        assert json.loads(json.dumps(found, allow_nan=False)) == found


class TestWhileOneDrags:
    def test_fewer_speeds_from_the_first_to_the_last(self, session):
        rough = answer(session, State(output="T", axis="speed", rough=True))["orders"]
        whole = answer(session, OVER_SPEED)["orders"]
        assert (len(rough["rpm"]), rough["thinned"]) == (ROUGH_SPEEDS, True)
        assert (len(whole["rpm"]), whole["thinned"]) == (401, False)
        assert (rough["rpm"][0], rough["rpm"][-1]) == (whole["rpm"][0], whole["rpm"][-1])
        kept = [whole["rpm"].index(rpm) for rpm in rough["rpm"]]
        assert rough["half_range"] == pytest.approx([whole["half_range"][place] for place in kept], rel=1e-9)
        assert set(np.diff(kept)) == {3, 4}

    def test_few_speeds_are_all_taken(self, path):
        model = json.loads(path.read_text(encoding="utf-8"))
        model["speeds"]["step"] = "20 rpm"
        orders = answer(open_session(str(path), text=json.dumps(model)), State(output="T", axis="speed", rough=True))
        assert (len(orders["orders"]["rpm"]), orders["orders"]["thinned"]) == (61, False)


class TestRefusals:
    def test_a_model_in_which_nothing_runs(self):
        session = open_session("amt_rig")
        (said,) = answer(session, State(output="theta_1", axis="speed"))["refused"]
        assert "speeds:" in said
        assert "excitations:" in said

    def test_speeds_without_excitations(self, path):
        model = json.loads(path.read_text(encoding="utf-8"))
        del model["excitations"], model["configurations"]["supply"]
        session = open_session(str(path), text=json.dumps(model))
        assert session.describe()["runs"] is False
        assert "no excitations" in answer(session, OVER_SPEED)["refused"][0]

    def test_an_excitation_on_what_is_locked(self, session):
        (said,) = answer(session, State({"rig": "locked"}, output="T", axis="speed"))["refused"]
        assert "blades" in said
        assert "locked" in said

    def test_an_unknown_output(self, session):
        assert '"twist"' in answer(session, State(output="twisd", axis="speed"))["refused"][0]

    @pytest.mark.parametrize(
        ("body", "said"),
        [
            ({"axis": "sped"}, 'no axis is named "sped"; did you mean "speed"'),
            ({"axis": 1}, "axis is a text"),
            ({"rough": 1}, "rough is true or false"),
            ({"axes": "speed"}, 'did you mean "axis"'),
        ],
    )
    def test_what_is_no_state(self, session, body, said):
        with pytest.raises(RequestError) as caught:
            reply(Documents.of(session), "api/answer", json.dumps(body).encode())
        assert said in str(caught.value)

    def test_a_state_comes_back_as_it_went(self):
        state = State(output="T", axis="speed", rough=True)
        assert read_state(json.loads(json.dumps(state.to_data()))) == state


class TestOutputs:
    @pytest.mark.slow
    def test_stress_of_a_shaft_is_shown_in_newtons_per_square_millimetre(self):
        session = open_session("marine_medium_speed")
        groups = {one["label"]: one["entries"] for one in session.describe()["choices"]["outputs"]}
        assert [one["name"] for one in groups["stresses in shafts"]] == [
            "stress(quill)", "stress(int_shaft)", "stress(prop_shaft)",
        ]  # fmt: skip
        stress, torque = (
            answer(session, State(output=f"{what}(int_shaft)", axis="speed"))["orders"] for what in ("stress", "torque")
        )
        assert stress["units"]["rad"] == "N/mm^2"
        shown = np.multiply(stress["half_range"], stress["scales"]["rad"])
        section = np.pi * 300**3 / 16  # mm^3
        assert shown == pytest.approx(np.multiply(torque["half_range"], 1e3 / section), rel=1e-9)

    @pytest.mark.slow
    def test_stress_over_frequency_has_the_same_unit(self):
        session = open_session("marine_medium_speed")
        found = answer(session, State(output="stress(int_shaft)", input="cyl1.T", band=(1.0, 20.0)))["response"]
        torque = answer(session, State(output="torque(int_shaft)", input="cyl1.T", band=(1.0, 20.0)))["response"]
        assert found["units"]["deg"] == "N/mm^2/(N*m)"
        shown = np.multiply(found["magnitude"], found["scales"]["deg"])
        assert shown == pytest.approx(np.multiply(torque["magnitude"], 1e3 / (np.pi * 300**3 / 16)), rel=1e-9)

    def test_torques_of_what_twists_are_offered_where_something_runs(self, session):
        groups = {
            one["label"]: [entry["name"] for entry in one["entries"]]
            for one in session.describe()["choices"]["outputs"]
        }
        assert groups["torques in elements"] == ["torque(shaft)"]
        assert session.describe()["runs"] is True

    @pytest.mark.few(4, 6)
    @pytest.mark.parametrize("name", library_cases())
    def test_every_library_model_opens_over_speed_or_looks_as_before(self, name):
        session = open_session(name)
        about = session.describe()
        found = answer(session, State(axis="speed"))
        labels = [one["label"] for one in about["choices"]["outputs"]]
        assert about["runs"] is ("orders" in found)
        assert about["runs"] is ("torques in elements" in labels)

    def test_the_page_begins_with_outputs_asked_for(self, path):
        session = open_session(path, over_speed=["torque(shaft)"])
        assert (session.start.axis, session.start.output) == ("speed", "torque(shaft)")
        groups = {
            one["label"]: [entry["name"] for entry in one["entries"]]
            for one in session.describe()["choices"]["outputs"]
        }
        assert groups["asked for"] == ["torque(shaft)"]
        assert "torques in elements" not in groups


class TestCommand:
    @pytest.mark.parametrize(
        "state",
        [
            OVER_SPEED,
            State({"supply": "rough"}, {"k": "14 kN*m/rad"}, "torque(shaft)", "motor", quantity="mobility",
                  band=(1.0, 9.0), decibels=True, axis="speed"),
            State({"rig": "free"}, output="twist", angle="deg", axis="speed"),
        ],
    )  # fmt: skip
    def test_it_prints_the_same_numbers(self, session, state, capsys):
        found = answer(session, state)
        words = shlex.split(found["command"])
        assert words[:2] == ["torsionnet", "orders"]
        assert main([*words[1:], "--json"]) == 0
        (printed,) = json.loads(capsys.readouterr().out)
        # The command examines more speeds where a peak lies between those of the page.
        shown = found["orders"]
        places = np.searchsorted(printed["speeds_rpm"], np.multiply(shown["rpm"], 1 - 1e-9))
        assert np.take(printed["speeds_rpm"], places) == pytest.approx(shown["rpm"], rel=1e-12)
        assert np.take(printed["outputs"][0]["half_range"], places) == pytest.approx(shown["half_range"], rel=1e-9)
        assert ("--angle-unit deg" in found["command"]) is (state.angle == "deg")

    @pytest.mark.parametrize(
        ("arguments", "said"),
        [
            (["amt_rig", "--over-speed", "theta_1"], "speeds:"),
            (["FAN", "--over-speed", "torque(shift)"], 'did you mean "shaft"'),
        ],
    )
    def test_wrong_use_opens_nothing(self, arguments, said, path, capsys):
        given = [str(path) if word == "FAN" else word for word in arguments]
        assert main(["explore", "--no-browser", *given]) == 2
        captured = capsys.readouterr()
        assert captured.out == ""
        assert said in captured.err


def peak(verdict, low, high):
    """Largest value over value allowed between two speeds in r/min."""
    rpm = verdict.speeds * 30 / np.pi
    inside = (rpm >= low - 1e-6) & (rpm <= high + 1e-6)
    return np.nanmax((verdict.values / verdict.allowed)[inside])


class TestLimits:
    """Values allowed and barred ranges beside those of the command, which examines all speeds of the page and more."""

    @staticmethod
    def printed(capsys, model, *arguments):
        main(["limits", model, "--json", *arguments])
        (found,) = json.loads(capsys.readouterr().out)
        return found

    @staticmethod
    def allowed(printed, name, criterion, rpm):
        (one,) = [one for one in printed["limits"] if (one["limit"], one["criterion"]) == (name, criterion)]
        known = [np.nan if value is None else value for value in one["allowed_over_speed"]]
        return np.take(known, np.searchsorted(printed["speeds_rpm"], np.multiply(rpm, 1 - 1e-9)))

    def test_stress_of_a_shaft_with_a_barred_range(self, capsys):
        orders = answer(open_session("bulk_carrier"), State(output="stress(int_shaft)", axis="speed"))["orders"]
        expected = self.printed(capsys, "bulk_carrier", "--limit", "intermediate")
        assert [one["name"] for one in orders["limits"]] == ["intermediate tau_C", "intermediate tau_T"]
        for one in orders["limits"]:
            shown = [np.nan if value is None else value for value in one["allowed"]]
            own = self.allowed(expected, *one["name"].split(), orders["rpm"])
            np.testing.assert_allclose(shown, own, rtol=1e-9)
        assert [one["in_passing"] for one in orders["limits"]] == [False, True]
        band, beside = orders["barred"]  # those of the other shaft count too
        assert beside["name"] == "propeller_shaft tau_C"
        assert [[band["from"], band["to"]]] == [pytest.approx(span, rel=1e-3) for span in expected["barred_rpm"]]
        assert any("torsionnet limits" in note for note in orders["limit_notes"])

    def test_torque_that_a_limit_of_stress_allows(self):
        session = open_session("bulk_carrier")
        stress, torque = (
            answer(session, State(output=f"{what}(int_shaft)", axis="speed"))["orders"] for what in ("stress", "torque")
        )
        section = np.pi * 0.440**3 / 16  # m^3
        assert torque["limits"][0]["allowed"] == pytest.approx(np.multiply(stress["limits"][0]["allowed"], section))
        assert torque["barred"] == stress["barred"]

    def test_a_value_of_a_maker_over_speed_ratio(self):
        orders = answer(open_session("bulk_carrier"), State(output="torque(k6f)", axis="speed"))["orders"]
        (one,) = orders["limits"]
        expected = np.interp(np.array(orders["rpm"]) / 105, [0.2, 1.05], [1500e3, 900e3])
        assert one["name"] == "crank"
        barred = [verdict.barred for verdict in tn.load("bulk_carrier").check_limits(refine=False).verdicts]
        assert len(orders["barred"]) == sum(map(len, barred)) > 0  # by shafts, none by the crankshaft
        assert one["allowed"] == pytest.approx(expected, rel=1e-9)

    def test_a_constant_value_and_an_output_without_limit(self):
        session = open_session("marine_medium_speed")
        orders = answer(session, State(output="torque(cyl3.shaft)", axis="speed", rough=True))["orders"]
        assert orders["limits"] == [{"name": "crankshaft", "allowed": [149e3] * ROUGH_SPEEDS, "in_passing": False}]
        orders = answer(session, State(output="phi_free", axis="speed", rough=True))["orders"]
        assert (orders["limits"], orders["barred"], orders["limit_notes"]) == ([], [], [])

    def test_what_else_is_judged_is_said(self):
        session = open_session("marine_medium_speed")
        orders = answer(session, State(output="torque(coupling)", axis="speed", rough=True))["orders"]
        assert [(one["name"], one["allowed"][0]) for one in orders["limits"]] == [("rubber T_KW", 15e3)]
        assert orders["limit_notes"] == ["torsionnet limits judges also rubber T_KN, rubber T_Kmax, rubber P_KV"]

    def test_ranges_of_several_cases_are_the_union_of_those_of_each(self):
        """Misfires of the cylinders each in turn, beside each alone: lowest and highest ends, the worst case by name."""
        text, own = running_ship.misfiring(), running_ship.CASES
        session = open_session("ship", text=text)
        state = State({"firing": "each"}, output="stress(int_shaft)", axis="speed")
        orders = answer(session, state)["orders"]
        alone = {case: session.base.configured(f"firing={case}") for case in own}
        speeds = np.array(orders["rpm"]) * np.pi / 30
        checks = {case: rig.check_limits(speeds=speeds, refine=False) for case, rig in alone.items()}
        for limit in ("intermediate", "propeller_shaft"):
            ends = sorted(
                {(span.low, span.high) for check in checks.values() for span in check.of(limit, "tau_C").barred}
            )
            joined = []
            for low, high in ends:
                if joined and low <= joined[-1][1]:
                    joined[-1][1] = max(joined[-1][1], high)
                else:
                    joined.append([low, high])
            shown = [one for one in orders["barred"] if one["name"] == f"{limit} tau_C"]
            assert [[one["from"], one["to"]] for one in shown] == [
                pytest.approx([end * 30 / np.pi for end in span], rel=2e-3) for span in joined
            ]
            for one in shown:
                used = {case: peak(check.of(limit, "tau_C"), one["from"], one["to"]) for case, check in checks.items()}
                assert one["case"] == own[max(used, key=used.get)]
        rough = answer(session, replace(state, rough=True))["orders"]
        assert (rough["barred"], rough["limit_notes"][0]) == ([], CURVES_ALONE)
        np.testing.assert_allclose(
            np.interp(rough["rpm"], orders["rpm"], orders["limits"][0]["allowed"]),
            rough["limits"][0]["allowed"],
            rtol=1e-3,  # a parabola between few speeds
        )
