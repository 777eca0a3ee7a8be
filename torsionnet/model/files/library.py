"""Library of the package with its models, benches, studies, parts and catalogues."""

from __future__ import annotations

import re
from itertools import islice
from pathlib import Path

from torsionnet.model.files.yaml_scalars import plain_value

PACKAGE = Path(__file__).resolve().parents[2]
"""Folder of the package ``torsionnet``, in or beside which its library lies."""
HEAD_LINES = 40
"""Number of lines at the beginning of a file that may hold its title and source, as heads in the library are
shorter."""
_END = re.compile("[,:.]")


def library_folder() -> Path:
    """Path of the folder with the library of the package.

    ``torsionnet/library`` where installed, ``library`` beside the package in a checkout.
    """
    installed = PACKAGE / "library"
    return installed if installed.is_dir() else PACKAGE.parent / "library"


def library_models() -> dict[str, Path]:
    """Path of every library model, by name.

    Examples
    --------
    >>> [name for name in library_models() if name.endswith("_rig")]
    ['amt_rig', 'dmf_rig']
    """
    return {path.stem: path for path in sorted(library_folder().glob("*.yaml"))}


def library_benches() -> dict[str, Path]:
    """Path of every test bench in the library, by name.

    Examples
    --------
    >>> list(library_benches())
    ['amt_bench', 'dmf_bench', 'engine_generator_bench', 'marine_run_up']
    """
    return {path.stem: path for path in sorted((library_folder() / "benches").glob("*.yaml"))}


def library_studies() -> dict[str, Path]:
    """Path of every study in the library, by name.

    Examples
    --------
    >>> "amt_tolerances" in library_studies()
    True
    """
    return {path.stem: path for path in sorted((library_folder() / "studies").glob("*.yaml"))}


def library_campaigns() -> dict[str, Path]:
    """Path of every campaign of rotating tests in the library, by name.

    Examples
    --------
    >>> list(library_campaigns())
    ['marine_campaign']
    """
    return {path.stem: path for path in sorted((library_folder() / "campaigns").glob("*.yaml"))}


def library_parts() -> dict[str, Path]:
    """Path of every part in the library, by name; models may use them unless they have a part of that name.

    Examples
    --------
    >>> "half_shaft" in library_parts()
    True
    """
    return {path.stem: path for path in sorted((library_folder() / "parts").glob("*.yaml"))}


def library_catalogues() -> dict[str, Path]:
    """Path of every catalogue in the library, by name.

    Examples
    --------
    >>> "example_couplings" in library_catalogues()
    True
    """
    return {path.stem: path for path in sorted((library_folder() / "catalogues").glob("*.csv"))}


def catalogue_entry(path: Path) -> tuple[str, str]:
    """Title and source of a catalogue, read from the comment in its first line.

    ``# Tyres of cars, data of usual size: ...``.

    Examples
    --------
    >>> catalogue_entry(library_catalogues()["example_couplings"])
    ('Rubber couplings', 'made-up data of usual size')
    """
    with path.open(encoding="utf-8") as file:
        what, _, rest = file.readline().lstrip("# ").partition(",")
    return what.strip(), _END.split(rest, maxsplit=1)[0].strip()


def library_entry(path: Path) -> tuple[str, str]:
    """Texts after ``name:`` and ``source:`` in the head of a model file, without reading the rest."""
    return _texts(path, "name", "source")


def study_entry(path: Path) -> tuple[str, str]:
    """Title of a study file and the name of its model, without reading the rest."""
    name, model = _texts(path, "name", "model")
    return name, f"of {model}"


def _texts(path: Path, *keys: str) -> tuple[str, str]:
    found = dict.fromkeys(keys, "")
    with path.open(encoding="utf-8") as file:
        for line in islice(file, HEAD_LINES):
            key, colon, text = line.partition(":")
            if colon and key in found:
                found[key] = _unquoted(text.strip())
    first, second = found.values()
    return first, second


def _unquoted(text: str) -> str:
    if text[:1] in ('"', "'") and text[-1:] == text[0]:
        return text[1:-1]
    return text if plain_value(text) is not None else ""
