"""Starting is quick because it loads little: heavy packages are imported by the functions that need them."""

import json
import subprocess
import sys

import pytest

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
        timeout=60,
        check=False,
        cwd=directory,
    )
    assert done.returncode == 0, done.stderr
    return set(json.loads(done.stderr.splitlines()[-1]))


def loaded_packages(body, directory):
    return {name for name in loaded_modules(body, directory) if "." not in name}


def command(*arguments):
    return f"from torsionnet.cli import main\nsys.argv = {['torsionnet', *arguments]}\nsys.exit(main())"


@pytest.mark.parametrize(
    ("body", "unwanted"),
    [
        pytest.param("import torsionnet", ALL_BUT_THE_READER, id="import torsionnet"),
        pytest.param(command("--help"), HEAVY, id="torsionnet --help"),
        pytest.param(command("check", "dmf_rig"), ALL_BUT_THE_READER, id="torsionnet check dmf_rig"),
    ],
)
def test_loads_no_heavy_package(body, unwanted, pytestconfig):
    loaded = loaded_packages(body, pytestconfig.rootpath)
    assert "torsionnet" in loaded
    assert loaded & unwanted == set()


def test_a_heavy_package_would_be_seen(pytestconfig):
    assert "numpy" in loaded_packages("import numpy", pytestconfig.rootpath)


def test_a_model_imports_the_element_types_that_it_has(pytestconfig):
    loaded = loaded_modules(command("check", "dmf_rig"), pytestconfig.rootpath)
    assert "torsionnet.model.elements.inertia" in loaded
    assert not loaded & {f"torsionnet.model.elements.{kind}" for kind in ("mass_elastic", "clutch", "controller")}
