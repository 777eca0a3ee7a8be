"""What pyproject.toml says of the project, and hatch_build.py adds, as far as other files of a release repeat it."""

from __future__ import annotations

import re
import tomllib
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
PLACEHOLDER = re.compile(r"https?://(?:[\w-]+\.)+example(?![\w.-])[^\s\"'<>)]*")  # RFC 2606: .example leads nowhere
LOWER_BOUND = re.compile(r"([A-Za-z0-9._-]+)>=([0-9][\w.]*)$")


def project(root: Path = ROOT) -> dict[str, Any]:
    """Table [project] of pyproject.toml with what the builder adds: version, extras, long description."""
    from torsionnet.base.version import __version__

    read = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    about = read["project"] | {"version": __version__}
    about.pop("dynamic")
    spec = spec_from_file_location("hatch_build", root / "hatch_build.py")
    assert spec is not None
    assert spec.loader is not None
    spec.loader.exec_module(added := module_from_spec(spec))
    added.ReleaseMetadata(str(root), read["tool"]["hatch"]["metadata"]["hooks"]["custom"]).update(about)
    return about


def lower_bounds(requirements: list[str]) -> dict[str, str]:
    """Oldest version by name, both as written; a requirement of another form is an error."""
    found = {}
    for requirement in requirements:
        match = LOWER_BOUND.match(requirement)
        if match is None:
            raise ValueError(f"pyproject.toml: {requirement} should be NAME>=VERSION")
        found[match[1]] = match[2]
    return found


def all_lower_bounds(about: dict[str, Any]) -> dict[str, str]:
    """Oldest versions of the dependencies and of every extra but ``all``, which repeats the others."""
    extras = [line for name, lines in about["optional-dependencies"].items() if name != "all" for line in lines]
    return lower_bounds(about["dependencies"]) | lower_bounds(extras)


def unpublishable(about: dict[str, Any], tag: str = "") -> list[str]:
    """Reasons why this version must not go to an index: addresses that lead nowhere, a tag of another version."""
    said = [
        f"pyproject.toml: {name} of [project.urls] is {address}, which leads nowhere: docs/releasing.md"
        for name, address in about["urls"].items()
        if PLACEHOLDER.match(address)
    ]
    if tag and tag != f"v{about['version']}":
        said.append(f"the tag is {tag}, but pyproject.toml has version {about['version']}: tag v{about['version']}")
    return said
