"""Every study of the library loads, runs and answers what it is asked."""

import json
from dataclasses import replace

import pytest
import yaml
from click.testing import CliRunner

from torsionnet.app.cli.app import app
from torsionnet.base.errors import UsageError
from torsionnet.model.files.library import library_studies
from torsionnet.study import load_study, run_study
from torsionnet.study.space.space import Space

LONGEST = "inline_six_damper"
LONG = {LONGEST, "marine_yield"}
"""Running speeds are calculated one variant after the other."""


@pytest.mark.few(2)
@pytest.mark.parametrize("name", library_studies())
def test_every_study_loads_without_a_warning(name):
    study = load_study(name)
    assert study.name
    assert study.quantities
    assert study.answers
    assert not study.findings


@pytest.mark.few(1)
@pytest.mark.parametrize("name", library_studies())
def test_editors_find_nothing_wrong_in_any_study(name):
    import jsonschema

    text = library_studies()[name].read_text(encoding="utf-8")
    schema = library_studies()[name].parent / text.splitlines()[0].partition("$schema=")[2]
    jsonschema.validate(yaml.safe_load(text), json.loads(schema.read_text(encoding="utf-8")))


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] * (name in LONG) + [pytest.mark.nightly] * (name == LONGEST))
        for name in library_studies()
    ],
)
def test_every_study_answers_with_a_few_variants(name):
    study = few(load_study(name), 2 if name in LONG else 12)
    result = run_study(study)
    for answer in study.answers.values():
        found = answer.conclude(study, result)
        assert found.sentences or found.table().rows


def few(study, count):
    """The same study with so few variants that only its way is tried."""
    if study.space.sampling is None:
        return study
    sampling = replace(study.space.sampling, count=count, method="random")
    space, faults = Space.of(replace(study.space.entries, sampling=sampling), study.model)
    assert not [fault for fault in faults if fault.severity == "error"]
    return replace(study, space=space, configurations=study.configurations[:1])


def test_a_name_that_no_study_has_is_refused_with_one_that_is():
    with pytest.raises(UsageError, match=r'(?s)"amt_tolerance".*"amt_tolerances".*unknown-name'):
        load_study("amt_tolerance")
    with pytest.raises(UsageError, match=r"(?s)amt_tolerances, .*unknown-name"):
        load_study("qqqq")


@pytest.mark.slow
def test_the_command_takes_a_name():
    found = CliRunner().invoke(app, ["study", "amt_two_stiffnesses"])
    assert found.exit_code == 0, found.output
    assert "zeta_1" in found.output
