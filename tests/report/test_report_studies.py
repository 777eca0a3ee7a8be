"""The section of a report on studies: what varied, over all variants, answers; in every format."""

import math
from pathlib import Path
from statistics import NormalDist

import pytest
from support.report_blocks import blocks, of, rows

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.report import make_report
from torsionnet.report.document_tree import Facts, Listing, Picture, Remark, TableBlock

J, K = 2.0, 8e3


def model(name="one mass"):
    parts = [
        tn.Inertia("rotor", node="a", inertia=J),
        tn.Spring("shaft", nodes=("a", "ground"), stiffness="k", damping=0.01),
    ]
    return tn.Drivetrain(name, parts, parameters={"k": K})


@pytest.fixture(scope="module")
def result():
    study = tn.study.define(
        model(),
        {"k": {"type": "lognormal", "deviation": "10 %"}},
        {"f_1": {"type": "natural_frequency", "mode": 1}},
        sampling={"method": "sobol", "count": 1024},
        limits={"f_1": {"above": math.sqrt(0.9 * K / J) / (2 * math.pi)}},
        answers={"kept": {"type": "yield"}, "cloud": {"type": "scatter"}},
        name="stiffness of the shaft",
    )
    return tn.study.run_study(study)


@pytest.fixture(scope="module")
def section(result):
    return blocks(make_report(model(), sections=["study"], studies=[result], date=None), "study")


def table(section, caption):
    return next(one for one in of(TableBlock, section) if "".join(map(str, one.caption)).startswith(caption))


def test_how_it_was_sampled(section):
    facts = {word: "".join(map(str, text)) for word, text in of(Facts, section)[0].rows}
    assert facts == {
        "Configurations": "the model as it stands",
        "Draws": "1024: scrambled Sobol sequence, seed 1",
        "Variants": "1024",
    }


def test_what_varied(section):
    [row] = rows(table(section, "What varies"))
    unit, given, kind, numbers, written = row[1:]
    assert (unit, given, kind, written) == ("N·m/rad", "8000", "lognormal", "deviation 10\N{NO-BREAK SPACE}%")
    assert numbers == "mean 8000, standard deviation 800"


def test_what_is_asked_and_its_limits(section):
    [row] = rows(table(section, "What is asked"))
    assert row[0] == "f_{1}"
    limit = math.sqrt(0.9 * K / J) / (2 * math.pi)
    assert row[1:] == ("natural frequency of mode 1, followed by its shape", "Hz", f"{limit:.5g}")


def test_numbers_over_all_variants(section):
    """The frequency of one mass is lognormal, too: its median and mean follow from those of the stiffness."""
    spread = math.sqrt(math.log(1.01))
    median = math.sqrt(K / math.exp(spread**2 / 2) / J) / (2 * math.pi)
    shown = table(section, "Quantities over all variants")
    heads = ["".join(map(str, column.text)).replace("\N{NO-BREAK SPACE}", " ") for column in shown.columns]
    assert heads == ["Mean", "Standard deviation", "2.5 %", "50 %", "97.5 %"]
    assert {column.unit for column in shown.columns} == {"Hz"}
    numbers = dict(zip(heads, map(float, rows(shown)[0]), strict=True))
    assert numbers["50 %"] == pytest.approx(median, rel=2e-3)
    assert numbers["Mean"] == pytest.approx(median * math.exp(spread**2 / 8), rel=2e-3)


def test_answers_have_sentence_and_picture(section):
    assert [one.name for one in of(Picture, section)] == ["study_1_1", "study_1_2"]
    spread = math.sqrt(math.log(1.01))
    share = 100 * NormalDist().cdf((math.log(0.9) + spread**2 / 2) / spread)
    said = " ".join(str(item) for one in of(Listing, section) for item in one.items)
    assert f"{share:.0f}" in said.replace("\N{NO-BREAK SPACE}", " ")


RIG_VARY = {
    "k_1": {"type": "normal", "deviation": "5 %", "low": "0.4 kN*m/rad"},
    "c_O": {"type": "triangular", "low": "-30 %", "high": "+50 %"},
    "k_2": {"type": "range", "low": "4 kN*m/rad", "high": "30 kN*m/rad", "count": 3, "spacing": "log"},
    "c_1": {"type": "list", "values": ["-10 %", "0 %"]},
}


@pytest.fixture(scope="module")
def rig_section():
    rig = tn.load("amt_rig")
    study = tn.study.define(
        rig,
        RIG_VARY,
        {
            "zeta_1": {"type": "damping_ratio", "mode": 1},
            "theta_5": {"type": "response", "output": "theta_1", "input": "T_M", "at": "5 Hz"},
        },
        configurations=["V", "V_c_O_360"],
        sampling={"method": "latin_hypercube", "count": 4, "seed": 7},
        correlation=[{"between": ["k_1", "c_O"], "coefficient": 0.5}],
        limits={"zeta_1": {"above": "10 %"}, "theta_5": {"below": "0.5 deg/(N*m)"}},
        name="everything",
    )
    result = tn.study.run_study(study)
    return blocks(make_report(rig, sections=["study"], studies=[result], date=None), "study"), result


def test_all_kinds_of_variation(rig_section):
    """In the units of the model file, for each configuration that has a value of its own."""
    shown = rows(table(rig_section[0], "What varies"))
    numbers = [(row[0], *row[1:6]) for row in shown]
    assert numbers == [
        ("k_{1}", "", "kN·m/rad", "0.46", "normal, truncated", "mean 0.46, standard deviation 0.023, lowest 0.4"),
        ("c_{O}", "V", "N·m·s/rad", "170", "triangular", "lowest 119, highest 255, most frequent 170"),
        ("c_{O}", "V_c_O_360", "N·m·s/rad", "360", "triangular", "lowest 252, highest 540, most frequent 360"),
        ("k_{2}", "", "kN·m/rad", "12.3", "3 values at equal ratios", "lowest 4, highest 30"),
        ("c_{1}", "", "N·m·s/rad", "4", "2 values", "lowest 3.6, highest 4"),
    ]


def test_grids_draws_and_correlation(rig_section):
    facts = {word: "".join(map(str, text)) for word, text in of(Facts, rig_section[0])[0].rows}
    assert facts["Values in turn"] == "3 × 2, every combination"
    assert facts["Draws"] == "4: Latin hypercube, seed 7"
    assert facts["Variants"] == "48, 24 in each configuration"
    [row] = rows(table(rig_section[0], "Correlation"))
    assert row == ("k_{1}, c_{O}", "0.5")


def test_limits_and_results_in_the_units_they_were_written_in(rig_section):
    section, result = rig_section
    asked = rows(table(section, "What is asked"))
    assert [row[2:] for row in asked] == [("%", "10", ""), ("deg/(N·m)", "", "0.5")]
    assert asked[1][1] == r"magnitude of \theta_{1}/T_{M} at 5 Hz"
    found = rows(table(section, "Quantities over all variants"))
    first, second = (row for row in found if row[1] == "V" and row[0] in (r"\zeta_{1}", r"\theta_{5}"))
    assert float(first[3]) == pytest.approx(100 * result.values("zeta_1", "V").mean(), rel=1e-3)
    assert float(second[3]) == pytest.approx(math.degrees(result.values("theta_5", "V").mean()), rel=1e-3)


def test_an_answer_that_cannot_be_given_is_told():
    study = tn.study.define(
        model(),
        {"k": {"type": "uniform", "low": "-10 %", "high": "+10 %"}},
        {"f": {"type": "natural_frequency", "mode": 1}, "same": {"type": "expression", "of": "0*f + 1"}},
        sampling={"count": 4},
        answers={
            "shares": {"type": "sobol_indices", "quantities": ["same"], "count": 64},
            "alone": {"type": "tornado"},
        },
    )
    report = make_report(model(), sections=["study"], studies=[tn.study.run_study(study)], date=None)
    [remark] = of(Remark, blocks(report, "study"))
    assert "does not vary" in "".join(map(str, remark.text))
    assert len(list(report.pictures)) == 1


def test_nothing_without_a_study():
    assert all(section.name != "study" for section in make_report(model(), date=None).sections)


def test_a_study_of_another_model_is_refused(result):
    with pytest.raises(UsageError, match=r"(?s)one mass.*other.*unlike-results"):
        make_report(model("other"), sections=["study"], studies=[result])


def test_a_study_of_other_values_is_refused_before_anything_is_calculated(result, monkeypatch):
    changed = model().configured(k=9e3)
    monkeypatch.setattr(tn.Drivetrain, "modes", lambda *_, **__: pytest.fail("calculated"))
    with pytest.raises(UsageError, match=r"(?s)one mass .*\(8000 .*9000.*unlike-results"):
        make_report(changed, studies=[result])
    with pytest.raises(UsageError, match=r"parameters\.k"):
        make_report(model(), settings={"k": 9e3}, studies=[result])


def test_another_element_under_the_same_name_is_refused(result):
    parts = [tn.Inertia("rotor", node="a", inertia=J), tn.Spring("shaft", nodes=("a", "ground"), stiffness="k")]
    with pytest.raises(UsageError, match=r"differ in elements\.shaft"):
        make_report(tn.Drivetrain("one mass", parts, parameters={"k": K}), studies=[result])


def test_values_of_elements_that_vary_make_no_other_model():
    vary = {"rotor.inertia": {"type": "list", "values": ["-5 %", "0 %"]}}
    study = tn.study.define(model(), vary, {"f": {"type": "natural_frequency", "mode": 1}})
    report = make_report(model(), sections=["study"], studies=[tn.study.run_study(study)], date=None)
    [row] = rows(table(blocks(report, "study"), "What varies"))
    assert row[:4] == ("rotor.inertia", "kg·m²", "2", "2 values")


def test_words_that_no_result_depends_on_may_differ(result):
    parts = [
        tn.Inertia("rotor", node="a", inertia=J),
        tn.Spring("shaft", nodes=("a", "ground"), stiffness="k", damping=0.01),
    ]
    told = tn.Drivetrain("one mass", parts, parameters={"k": K}, description="of a book")
    assert make_report(told, sections=["study"], studies=[result], date=None).sections


def test_the_command_refuses_before_it_calculates(tmp_path, monkeypatch, capsys):
    """The study takes a while; the model is another one, or has another value for this report."""
    from torsionnet.app.cli import main

    monkeypatch.setattr("torsionnet.study.run.run_chunks.run_study", lambda *_, **__: pytest.fail("calculated"))
    for given in (["dmf_rig"], ["amt_rig", "--set", "k_1=500"]):
        file = tmp_path / "r.html"
        assert main(["report", *given, "-o", str(file), "--study", "amt_two_stiffnesses"]) == 2
        assert "First mode of the AMT rig over its two stiffnesses" in capsys.readouterr().err
        assert not file.exists()


@pytest.mark.few(1)
@pytest.mark.parametrize("ending", [".html", ".md", ".tex"])
def test_every_format(result, tmp_path, ending):
    path = Path(tmp_path, f"report{ending}")
    tn.write_report(model(), path, sections=["study"], studies=[result], date=None)
    text = path.read_text(encoding="utf-8")
    assert "lognormal" in text
    assert "What varies" in text
