"""``python -m release``: validate, build and try what a release consists of, as far as that needs no network but the package index."""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from release.codemeta import codemeta
from release.dockerfile import Build
from release.project import ROOT, project, unpublishable
from release.recipe import conda_requirements, rendered

BIN = Path(sys.executable).parent
NEVER_RUN_HERE = (
    "docker build: needs a Docker daemon; the container job of tests.yml builds and starts the image",
    "rattler-build build: needs a conda channel",
    "trusted publishing, attestations, documentation by version: only the release workflow itself shows that they work",
)
SCHEMAS = {
    "github-workflows": ".github/workflows/*.yml",
    "github-issue-forms": ".github/ISSUE_TEMPLATE/[!c]*.yml",
    "github-issue-config": ".github/ISSUE_TEMPLATE/config.yml",
    "dependabot": ".github/dependabot.yml",
    "citation-file-format": "CITATION.cff",
}


def call(*words: str | Path, folder: Path = ROOT, **settings: str) -> None:
    print("+", *(Path(word).name if Path(word).is_absolute() else word for word in words), flush=True)
    subprocess.run([str(word) for word in words], check=True, cwd=folder, env={**os.environ, **settings})


def stop(reason: str) -> None:
    sys.exit(f"error: {reason}")


def validate(cffconvert: Path) -> list[str]:
    """Say what the offline checkers find; return which of them are not here."""
    not_run = []
    for schema, pattern in SCHEMAS.items():
        files = sorted(path.relative_to(ROOT) for path in ROOT.glob(pattern))
        call(BIN / "check-jsonschema", "--builtin-schema", f"vendor.{schema}", *files)
    call(BIN / "validate-pyproject", "pyproject.toml")
    call(BIN / "zizmor", "--offline", "--no-progress", ".github")
    if cffconvert.exists():
        call(cffconvert, "--validate")
    else:
        not_run.append("cffconvert: `make release-files` installs it in .venv-citation")
    if actionlint := shutil.which("actionlint"):
        call(actionlint)
    else:
        not_run.append("actionlint: no package of the index carries its program; install it and run again")
    return not_run


def compare() -> None:
    """End with an error if a file says something else than pyproject.toml."""
    about = project()
    if (ROOT / "codemeta.json").read_text(encoding="utf-8") != codemeta(about):
        stop("codemeta.json is not what pyproject.toml says: PYTHONPATH=tests python -m release.codemeta")
    recipe = rendered()
    if recipe["requirements"]["run"] != conda_requirements(about):
        stop("recipe/recipe.yaml: requirements differ from pyproject.toml")
    print("codemeta.json and the rendered recipe agree with pyproject.toml")


def try_source_archive(archive: Path, folder: Path) -> None:
    """Run the tests of the project's own files from an unpacked source archive, as a distributor does."""
    shutil.unpack_archive(archive, folder, filter="data")
    (source,) = folder.iterdir()
    tests = ("-m", "pytest", "-q", "-n", "2", "-m", "not slow", "tests/project", "tests/base")
    call(sys.executable, *tests, folder=source, PYTHONPATH=str(source))


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m release", description=__doc__)
    parser.add_argument("--publish", action="store_true", help="addresses that lead nowhere are errors")
    parser.add_argument("--tag", default="", help="tag of the release, compared with the version")
    parser.add_argument("--keep", type=Path, help="folder for wheel, source archive and bill of materials")
    parser.add_argument("--cffconvert", type=Path, default=ROOT / ".venv-citation" / "bin" / "cffconvert")
    given = parser.parse_args()
    reasons = unpublishable(project(), given.tag)
    if reasons and given.publish:
        stop("; ".join(reasons))
    not_run = validate(given.cffconvert)
    compare()
    with tempfile.TemporaryDirectory() as scratch:
        kept = given.keep.resolve() if given.keep else Path(scratch) / "dist"
        call(sys.executable, "-m", "build", "--outdir", kept)
        call(sys.executable, "-m", "twine", "check", "--strict", *kept.glob("torsionnet-*"))
        try_source_archive(*kept.glob("torsionnet-*.tar.gz"), Path(scratch) / "source archive")
        build = Build(ROOT, Path(scratch))
        python = build.run()
        call(
            BIN / "cyclonedx-py",
            "environment",
            "--output-reproducible",
            "--output-file",
            kept / "torsionnet.cdx.json",
            python,
        )
    print("not run:", *not_run, *build.not_run, *NEVER_RUN_HERE, sep="\n  ")
    print(*(f"not to be published: {reason}" for reason in reasons), sep="\n")


if __name__ == "__main__":
    main()
