"""Hints how library parts, catalogues and studies are used, for those who load them as models."""

from __future__ import annotations

from pathlib import Path

from torsionnet.model.files.library import library_catalogues, library_entry, library_parts, library_studies
from torsionnet.model.files.located_yaml import compose


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
