"""A verdict covers every configuration, or says first which it does not, and is no pass."""

import copy
import json

import pytest
from support.command_line import run
from support.running_fan import MODEL

import torsionnet as tn
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion
from torsionnet.report.document_tree import Strong, TableBlock, inlines
from torsionnet.report.report import make_report

LOUD, TITLE = "supply=rough,rig=n6", "rough, n6"
BELOW = "starts and stops not examined: speeds below 300 rpm of motor"
"""The only one of fourteen configurations in which the limit does not hold; a report shows twelve."""


def fan(**more):
    """The fan with seven alternatives on a second axis, the last one with the least damping."""
    model = copy.deepcopy(MODEL)
    model["speeds"]["step"] = "60 rpm"
    model["configurations"]["rig"] = {f"n{number}": {"c": f"{4 + number} N*m*s/rad"} for number in range(7)}
    model["configurations"]["rig"]["n6"] = {"c": "1 N*m*s/rad"}
    model["configurations"]["supply"]["rough"] = {"poles.orders": {3: {"amplitude": "400 N*m"}}}
    model["limits"] = {"shaft": {"rule": "curve", "output": "T", "value": "1 kN*m", "source": "maker"}, **more}
    return model


@pytest.fixture(scope="module")
def strict():
    """With a value allowed between those of the worst configuration and of all others."""
    model = fan()
    rig = tn.loads(json.dumps(model))
    worst = {name: float(rig.configured(name).check_limits().verdicts[0].values.max()) for name in rig.configurations}
    loud, rest = worst.pop(LOUD), max(worst.values())
    assert loud > 1.01 * rest
    model["limits"]["shaft"]["value"] = f"{(loud + rest) / 2} N*m"
    return model


@pytest.fixture
def file(strict, tmp_path):
    path = tmp_path / "fan.json"
    path.write_text(json.dumps(strict), encoding="utf-8")
    return path


@pytest.mark.slow
def test_a_report_judges_the_configurations_it_does_not_show(strict):
    rig = tn.loads(json.dumps(strict))
    assert LOUD not in rig.configurations[:12]
    report = make_report(rig, kind="rig", sections=["summary", "limits"], date=None)
    for section in report.sections:
        lead = section.blocks[0].text
        assert lead[2] == Strong("barred range")
        assert TITLE in "".join(map(str, lead))
    assert "(of 14; limits are examined in all)" in "".join(dict(report.facts.rows)["Configurations"])
    tables = [block for block in report.sections[-1].blocks if isinstance(block, TableBlock)]
    shown = [
        {text for group in one.groups for row in group.rows for text in (group.title, inlines(row[0])[0])}
        for one in tables
    ]
    assert all(any(TITLE in str(name).lower() for name in names) for names in shown)


def test_a_report_on_some_says_first_which_were_left_out(strict):
    rig = tn.loads(json.dumps(strict))
    report = make_report(rig, sections=["limits"], configurations=["supply=mains,rig=n0"], date=None)
    lead = report.sections[0].blocks[0].text
    assert lead[2] == Strong("incomplete")
    said = "".join(map(str, lead[3:]))
    assert said.startswith(". 13 of 14 configurations not examined: all but mains, n0. Starts and stops not")
    assert ". All limits hold" in said


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("arguments", "code", "told"),
    [
        ((), 6, f"fan: incomplete: 14 of 14 configurations not examined: all but the model as written; {BELOW}; all limits hold in"),
        (("-c", LOUD), 6, f"fan: incomplete: 13 of 14 configurations not examined: all but {LOUD}; {BELOW}; limits hold with 328 to 333 rpm of motor barred in {LOUD}"),
        (("-c", "all"), 0, f"fan: barred range: {BELOW}; limits hold with "),
    ],
)  # fmt: skip
def test_the_last_line_is_the_verdict_on_the_model(file, arguments, code, told):
    assert run("limits", file, *arguments, code=code).stdout.splitlines()[-1].startswith(told)
    (*_, last) = json.loads(run("limits", file, *arguments, "--json", code=code).stdout)
    assert last["overall"]["verdict"] == told.split(": ")[1]
    assert len(last["overall"]["not_examined"]) == {(): 14, ("-c", "all"): 0}.get(arguments, 13)


def test_a_limit_or_excitation_left_out_is_no_pass():
    rig = tn.loads(json.dumps(fan(other={"rule": "curve", "output": "T", "value": "1 N*m", "source": "maker"})))
    rig = rig.configured("supply=mains,rig=n0")
    found = LimitConclusion((rig.check_limits("shaft", excitation=["blades"]),))
    assert found.verdict == "incomplete"
    assert found.left_out == ("limits not examined: other", "excitations not examined: poles")
    assert "the limits examined hold" in found.sentence


def test_the_model_as_written_is_a_configuration_that_changes_nothing():
    model = fan()
    model["configurations"] = {"supply": {"mains": {}, "rough": {"J": "1.01 kg*m^2"}}}
    rig = tn.loads(json.dumps(model))
    assert rig.other_configurations == ("rough",)
    assert rig.check_limits().verdict == "incomplete"
    assert rig.check_limits().conclusion.startswith(
        "1 of 2 configurations not examined: rough; starts and stops not examined: speeds below "
    )
    assert LimitConclusion((rig.check_limits(), rig.configured("rough").check_limits())).verdict == "pass"
    del model["configurations"]
    assert tn.loads(json.dumps(model)).check_limits().verdict == "pass"


def test_what_one_configuration_switches_off_is_judged_by_the_others():
    model = fan(brake={"rule": "curve", "output": "torque(brake)", "value": "1 MN*m", "source": "maker"})
    model["elements"]["brake"] = {"type": "damper", "nodes": ["fan", "ground"], "damping": 1, "enabled": False}
    model["configurations"] = {"brake": {"free": {}, "held": {"on": ["brake"]}}}
    rig = tn.loads(json.dumps(model))
    free, braked = (rig.configured(name).check_limits() for name in rig.configurations)
    assert isinstance(free, LimitCheck)
    assert (free.verdict, braked.verdict) == ("not judged", "pass")
    assert LimitConclusion((free, braked)).verdict == "pass"
    assert LimitConclusion((free,)).verdict == "not judged"


@pytest.mark.slow
def test_sections_about_some_configurations_say_so(strict):
    report = make_report(tn.loads(json.dumps(strict)), sections=["critical_speeds", "orders"], date=None)
    assert [section.blocks[0].text[-1] for section in report.sections] == [
        " Of 14 configurations 12 are examined here."
    ] * 2
