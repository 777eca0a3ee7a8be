"""The section of a report on studies: what varied, over all variants, answers; in every format."""

import math
from pathlib import Path
from statistics import NormalDist

import pytest
from test_document import blocks, of, rows

import torsionnet as tn
from torsionnet.core.errors import UsageError
from torsionnet.report import make_report
from torsionnet.report.document_tree import Listing, Paragraph, Picture, TableBlock

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


def test_what_varied(section):
    assert "1024 variants. Drawn: sobol, 1024 draws, seed 1." in str(of(Paragraph, section)[0].text)
    assert rows(of(TableBlock, section)[0])[0][1:] == ("8000", "N·m/rad", "lognormal, deviation 10 %")


def test_numbers_over_all_variants(section):
    """The frequency of one mass is lognormal, too: its median and mean follow from those of the stiffness."""
    spread = math.sqrt(math.log(1.01))
    median = math.sqrt(K / math.exp(spread**2 / 2) / J) / (2 * math.pi)
    numbers = dict(
        zip(("mean", "deviation", "low", "median"), map(float, rows(of(TableBlock, section)[1])[0][2:6]), strict=True)
    )
    assert numbers["median"] == pytest.approx(median, rel=2e-3)
    assert numbers["mean"] == pytest.approx(median * math.exp(spread**2 / 8), rel=2e-3)


def test_answers_have_sentence_and_picture(section):
    assert [one.name for one in of(Picture, section)] == ["study_1_1", "study_1_2"]
    spread = math.sqrt(math.log(1.01))
    share = 100 * NormalDist().cdf((math.log(0.9) + spread**2 / 2) / spread)
    said = " ".join(str(item) for one in of(Listing, section) for item in one.items)
    assert f"{share:.0f}" in said.replace("\N{NO-BREAK SPACE}", " ")


def test_nothing_without_a_study():
    assert all(section.name != "study" for section in make_report(model(), date=None).sections)


def test_a_study_of_another_model_is_refused(result):
    with pytest.raises(UsageError, match="is of one mass, and the report of other"):
        make_report(model("other"), sections=["study"], studies=[result])


@pytest.mark.parametrize("ending", [".html", ".md", ".tex"])
def test_every_format(result, tmp_path, ending):
    path = Path(tmp_path, f"report{ending}")
    tn.write_report(model(), path, sections=["study"], studies=[result], date=None)
    text = path.read_text(encoding="utf-8")
    assert "lognormal" in text
    assert "What varies" in text
