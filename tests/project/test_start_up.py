"""Starting is quick because it loads little: heavy packages are imported by the functions that need them."""

import json
import subprocess
import sys
from importlib.util import find_spec

import pytest
from structure.core_use import FOUR_CALLS, OF_BOTH_RIGS, ONE_RESPONSE, use_of
from structure.floors import CORE, LAYERS
from support.patience import PATIENCE

HEAVY = {"sympy", "control", "scipy", "matplotlib", "jinja2"}
ALL_BUT_THE_READER = HEAVY | {"numpy", "networkx", "pint", "pydantic"}

# What is loaded at the very end is the last line on stderr, after all other output.
PROGRAM = """
import atexit, json, sys
atexit.register(lambda: sys.stderr.write("\\n" + json.dumps(sorted(sys.modules))))
{body}
"""


def loaded_modules(body, directory):
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM.format(body=body)],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
        cwd=directory,
    )
    assert done.returncode == 0, done.stderr
    return set(json.loads(done.stderr.splitlines()[-1]))


def loaded_packages(body, directory):
    return {name for name in loaded_modules(body, directory) if "." not in name}


def command(*arguments):
    return f"from torsionnet.app.cli import main\nsys.argv = {['torsionnet', *arguments]}\nsys.exit(main())"


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("body", "unwanted"),
    [
        pytest.param("import torsionnet", ALL_BUT_THE_READER, id="import torsionnet"),
        pytest.param(command("--help"), HEAVY, id="torsionnet --help"),
        pytest.param(command("new", "--help"), ALL_BUT_THE_READER, id="torsionnet new --help"),
        pytest.param(command("check", "dmf_rig"), ALL_BUT_THE_READER, id="torsionnet check dmf_rig"),
        pytest.param(command("check", "examples/files/car.yaml"), ALL_BUT_THE_READER, id="torsionnet check car.yaml"),
    ],
)
def test_loads_no_heavy_package(body, unwanted, pytestconfig):
    loaded = loaded_packages(body, pytestconfig.rootpath)
    assert "torsionnet" in loaded
    assert loaded & unwanted == set()


@pytest.mark.parametrize("name", ["modes", "library", "new", "static", "study"])
def test_help_of_a_command_reads_no_entries(name, pytestconfig):
    """What makes JSON of results, and what a notebook shows, wait until one is asked for."""
    loaded = loaded_modules(command(name, "--help"), pytestconfig.rootpath)
    wanted_later = {"torsionnet.base.entries", "torsionnet.base.expressions", "torsionnet.linear", "base64"}
    assert loaded & wanted_later == set()


SMALL_STUDY = """
torsionnet: 1
name: two stiffnesses
model: amt_rig
configurations: [V]
vary:
  k_1: {}
quantities:
  f_1: {{type: natural_frequency, mode: 1}}
{}
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "varied"),
    [("uniform", "{type: list, values: [400 N*m/rad, 500 N*m/rad]}"), ("normal", "{type: normal, deviation: 5 %}")],
)
def test_a_small_study_loads_no_heavy_package_and_no_kind_it_does_not_name(tmp_path, kind, varied):
    text = SMALL_STUDY.format(varied, "" if kind == "uniform" else "sampling: {count: 2, seed: 1}")
    (tmp_path / "small.yaml").write_text(text, encoding="utf-8")
    loaded = loaded_modules(command("study", "small.yaml"), tmp_path)
    assert {name for name in loaded if "." not in name} & HEAVY == set()
    folders = [f"torsionnet.study.{name}." for name in ("space.variations", "quantities", "answers", "design")]
    kinds = {name for name in loaded if name.startswith(tuple(folders))}
    assert {name.rpartition(".")[2] for name in kinds} == {
        "answer", "evaluator", "natural_frequency", "quantity", kind, "variation",
    }  # fmt: skip


def test_a_heavy_package_would_be_seen(pytestconfig):
    assert "numpy" in loaded_packages("import numpy", pytestconfig.rootpath)


# What a rig without gears, parts, catalogues and an operating point does without; each costs a part of what check may.
NOT_FOR_A_PLAIN_RIG = {
    f"torsionnet.model.{name}"
    for name in (
        "catalogues.catalogue",
        "catalogues.catalogue_reading",
        "checks.operation",
        "elements.clutch",
        "elements.controller",
        "element_base.curves",
        "element_base.dynamic_stiffness",
        "elements.flexible_couplings",
        "elements.gears",
        "elements.mass_elastic",
        "element_base.quantity_table",
        "element_base.speed_path",
        "element_base.stiffness_table",
        "files.model_schema",
        "load.external_torques",
        "load.load_section",
        "operating_values",
        "parts.authored_model",
        "parts.flattening",
        "parts.part",
        "readings",
        "referral",
    )
}


@pytest.mark.slow
def test_a_model_imports_what_it_has(pytestconfig):
    loaded = loaded_modules(command("check", "dmf_rig"), pytestconfig.rootpath)
    assert {"torsionnet.model.elements.masses_and_springs", "torsionnet.model.checks.structure"} <= loaded
    assert not loaded & NOT_FOR_A_PLAIN_RIG
    others = {layer for one in LAYERS for layer in one.names} - {*CORE, "app", "drivetrain", "__main__"}
    strange = {name for name in loaded if name.startswith(tuple(f"torsionnet.{room}." for room in others))}
    assert {name for name in strange if not name.startswith("torsionnet.report.plan")} == set()  # it has that section


@pytest.mark.parametrize("module", sorted(NOT_FOR_A_PLAIN_RIG))
def test_what_is_not_imported_is_there(module):
    assert find_spec(module)


ONLY_DECLARED = {
    "torsionnet/base/errors.py",  # nothing is wrong with the rigs
    "torsionnet/model/element_base/spring_stages.py",  # entries of springs that are not linear
    "torsionnet/report/plan/report_plan.py",  # the section of amt_rig
}
"""Modules that the rigs load for what they declare."""


class TestCore:
    """The four calls for which the package exists: load, modes, measured-input response, symbolic transfer function."""

    def test_no_module_is_loaded_in_vain(self):
        """A module of the core imports an optional one only where the model has what that one is about."""
        assert set(use_of(OF_BOTH_RIGS).idle) <= ONLY_DECLARED

    def test_what_the_calls_load_and_pass_stays_bounded(self):
        four, response = use_of(FOUR_CALLS), use_of(ONE_RESPONSE)
        assert len(four.loaded) <= 92
        assert four.code_lines <= 12_760
        assert len(response.functions) <= 328
        assert len(response.files) <= 46
