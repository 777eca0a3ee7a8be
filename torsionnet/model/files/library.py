"""Library of the package with its models, benches, studies, parts and catalogues.

Here as well: hints how library parts, catalogues and studies are used, for those who load them as models; decoding of
the bytes of a model file to text.
"""

from __future__ import annotations

import codecs
import re
from itertools import islice
from pathlib import Path

from torsionnet.base.errors import Fault, ModelError, Position
from torsionnet.model.files.located_yaml import compose, plain_value

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
    ['amt_bench', 'dmf_bench', 'dmf_component_bench', 'engine_generator_bench', 'marine_run_up']
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
    texts = dict.fromkeys(keys, "")
    with path.open(encoding="utf-8") as file:
        for line in islice(file, HEAD_LINES):
            key, colon, text = line.partition(":")
            if colon and key in texts:
                texts[key] = _unquoted(text.strip())
    first, second = texts.values()
    return first, second


def _unquoted(text: str) -> str:
    if text[:1] in ('"', "'") and text[-1:] == text[0]:
        return text[1:-1]
    return text if plain_value(text) is not None else ""


def other_use(name: str) -> str:
    """Message on how a part, catalogue or study of that name is used, which is no model; empty if there is none.

    Examples
    --------
    >>> print(other_use("rotor_blade").partition("; ")[0])
    "rotor_blade" is a part (Rotor blade, edgewise), no model
    """
    parts, catalogues = library_parts(), library_catalogues()
    if name in parts:
        return _part(name, parts[name])
    if name in catalogues:
        text = f"give an element the entries catalogue: {name} and size: ..."
        return f'"{name}" is a catalogue, no model; {text}; its sizes are in {catalogues[name]}'
    if name in library_studies():
        return f'"{name}" is a study, no model; torsionnet study {name} calculates it'
    return ""


def _part(name: str, path: Path) -> str:
    data = compose(path.read_text(encoding="utf-8"), str(path)).data
    nodes = ", ".join(f"{port}: ..." for port in data["ports"])
    text = f'"{name}" is a part ({library_entry(path)[0]}), no model'
    text += f"; put it into a model with use: {{NAME: {{part: {name}, at: {{{nodes}}}}}}}"
    values = ", ".join(data["parameters"])
    return f"{text}; its parameters are {values}, its elements {', '.join(data['elements'])}; its file is {path}"


MOST_BYTES = 4_000_000
"""Size in bytes of the largest model file, as a larger one is no model and would only fill the memory."""


def decode(raw: bytes, file: str) -> str:
    """Text of a model file from its bytes in UTF-8 code.

    Raises ModelError with the position of bytes that are not UTF-8.
    """
    if len(raw) > MOST_BYTES:
        raise _fault(f"the file is too large: more than {MOST_BYTES // 1_000_000} MB", file)
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) or b"\0" in raw[:4]:
        raise _fault("the file is saved as UTF-16 or UTF-32; save it as UTF-8", file)
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        good = raw[: error.start + (3 if raw.startswith(codecs.BOM_UTF8) else 0)]
        lines = good.decode("utf-8-sig", "replace").splitlines() or [""]
        if good.endswith((b"\n", b"\r")):
            lines.append("")
        text = f"the byte 0x{raw[len(good)]:02x} is no UTF-8 text; save the file as UTF-8"
        raise _fault(text, file, len(lines), len(lines[-1]) + 1) from None


def _fault(message: str, file: str, line: int = 1, column: int = 1) -> ModelError:
    return ModelError([Fault(message, position=Position(file, line, column, column + 1), kind="unreadable-file")])
