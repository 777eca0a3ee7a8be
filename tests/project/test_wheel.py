"""What a user installs: the wheel is complete and works away from the checkout."""

import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from torsionnet.app.cli.commands.model_files import KINDS

pytestmark = pytest.mark.slow

FIND_LIBRARY = """
import json, torsionnet.model.files.library as library
print(json.dumps({"module": library.__file__, "models": {name: str(path) for name, path in library.library_models().items()}}))
"""


def run(*arguments, **options):
    done = subprocess.run(arguments, capture_output=True, text=True, timeout=300, check=False, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory, pytestconfig):
    directory = tmp_path_factory.mktemp("dist")
    run(
        sys.executable, "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check",
        "--no-deps", "--no-build-isolation", "--wheel-dir", str(directory), str(pytestconfig.rootpath),
    )  # fmt: skip
    (path,) = directory.glob("torsionnet-*.whl")
    return path


@pytest.fixture(scope="module")
def library_names(pytestconfig):
    names = {path.stem for path in (pytestconfig.rootpath / "library").glob("*.yaml")}
    assert "dmf_rig" in names
    return names


def test_two_builds_of_a_wheel_have_the_same_bytes(wheel, tmp_path, pytestconfig):
    """Another folder, other times and rights of the files, another time zone: nothing of them is in the wheel."""
    copy = tmp_path / "other checkout"
    for name in ("torsionnet", "library"):
        shutil.copytree(pytestconfig.rootpath / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "hatch_build.py", "README.md", "LICENSE"):
        shutil.copy(pytestconfig.rootpath / name, copy)
    for path in filter(Path.is_file, copy.rglob("*")):
        os.utime(path, (1e9, 1e9))
        path.chmod(0o600)
    run(
        sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(tmp_path), str(copy),
        env={**os.environ, "TZ": "Asia/Tokyo"},
    )  # fmt: skip
    again = tmp_path / wheel.name
    members = [[(entry.filename, entry.CRC) for entry in zipfile.ZipFile(path).infolist()] for path in (wheel, again)]
    assert members[0] == members[1]
    assert again.read_bytes() == wheel.read_bytes()


def test_wheel_holds_models_and_type_marker(wheel, library_names):
    files = set(zipfile.ZipFile(wheel).namelist())
    assert "torsionnet/py.typed" in files
    assert files >= {
        "torsionnet/__init__.pyi",
        "torsionnet/plot/__init__.pyi",
        "torsionnet/model/elements/element_types.pyi",
        "torsionnet/entry_classes.pyi",
    }
    assert files >= {f"torsionnet/library/{name}.yaml" for name in library_names}
    page = ("index.html", "main.js", "style.css", "vendor/uPlot.iife.min.js", "vendor/LICENSE-uPlot.txt")
    page += ("vendor/codemirror.min.js", "vendor/LICENSE-codemirror.txt")
    assert not any(name.startswith("torsionnet/app/explore/bundle/") for name in files)
    assert files >= {f"torsionnet/app/explore/static/{name}" for name in page}
    templates = Path(__file__).parents[2] / "torsionnet" / "report" / "writers" / "templates"
    assert files >= {f"torsionnet/report/writers/templates/{template.name}" for template in templates.iterdir()}
    assert "torsionnet/report/texts.yaml" in files
    assert files >= {f"torsionnet/app/cli/starting_models/{kind}.yaml" for kind in KINDS}
    sources = Path(__file__).parents[2] / "torsionnet" / "io" / "fmu" / "c"
    assert files >= {f"torsionnet/io/fmu/c/{source.name}" for source in sources.iterdir()}
    assert {name.split("/")[0].split("-")[0] for name in files} == {"torsionnet"}


def test_installed_package_finds_its_library(wheel, library_names, tmp_path):
    target, elsewhere = tmp_path / "installed", tmp_path / "elsewhere"
    elsewhere.mkdir()
    run(
        sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check",
        "--no-deps", "--target", str(target), str(wheel),
    )  # fmt: skip
    environment = {**os.environ, "PYTHONPATH": str(target)}
    found = json.loads(run(sys.executable, "-c", FIND_LIBRARY, cwd=elsewhere, env=environment))
    assert Path(found["module"]).is_relative_to(target)
    assert set(found["models"]) == library_names
    for path in map(Path, found["models"].values()):
        assert path.is_relative_to(target)
        assert path.is_file()
