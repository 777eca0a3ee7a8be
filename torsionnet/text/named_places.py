"""Places in a model text where nodes, parameters, elements, parts and other things are named."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path as FolderPath

from torsionnet.core.errors import Path
from torsionnet.text.text_edits import TextSpan


@dataclass(frozen=True)
class NamedPlace:
    """Stretch of a model text that names something.

    Attributes
    ----------
    name, kind : str
        What is named: a node, parameter, element, part, use, axis, configuration, input, sensor, channel, excitation,
        limit or scenario.
    span : TextSpan
        Of the name alone, without quotes.
    is_definition : bool
        Whether the thing is defined here; a node is where an element first names it.
    path : path
        Keys that lead to the entry that holds the name.
    home : path
        Which thing of that name it is: a node of a part is another one than the node of that name in the model.
    """

    name: str
    kind: str
    span: TextSpan
    is_definition: bool = False
    path: Path = ()
    home: Path = ()


def named_places(text: str, file: str = "", folder: FolderPath | None = None) -> list[NamedPlace]:
    """Places where a model text names something, in the order of the text."""
    del text, file, folder
    return []
