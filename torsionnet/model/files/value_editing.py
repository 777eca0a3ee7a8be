"""Changes of parameter values in the text of a model file, whose comments, order and spacing stay."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from torsionnet.base.entries.scalars import plain_scalar
from torsionnet.base.errors import EntryPath, ModelError
from torsionnet.base.expressions import Expression
from torsionnet.model.changes import LOAD_SIZES, is_point_setting, with_point_settings
from torsionnet.model.configurations import DEFAULT_AXIS, Overlay
from torsionnet.model.definition import Definition
from torsionnet.model.files.located_yaml import LocatedDocument, LocatedNode, Span, compose
from torsionnet.model.files.reader import read_text
from torsionnet.model.files.writer import dump, scalar_text

_NOTHING = Overlay()


@dataclass(frozen=True)
class ValuePlace:
    """Place of a parameter's value in a model, the table of parameters or an alternative.

    Of a setting, as ``operating_point.torque.crank`` or ``load.power``, the place in its section or an alternative.
    """

    parameter: str
    axis: str = ""
    alternative: str = ""
    is_setting: bool = False

    def paths(self) -> tuple[EntryPath, ...]:
        """Paths at which the value of the parameter may be written in a file; a single axis needs no name."""
        if not self.axis:
            return (
                (self.entry,)
                if self.is_setting
                else (("parameters", *self.entry, "value"), ("parameters", *self.entry))
            )
        inner = (self.alternative, *self.entry)
        named: EntryPath = ("configurations", self.axis, *inner)
        return (named, ("configurations", *inner)) if self.axis == DEFAULT_AXIS else (named,)

    @property
    def entry(self) -> tuple[str, ...]:
        """Path of the value in its section, or in an alternative."""
        if not self.is_setting or (self.axis and self.parameter in LOAD_SIZES):
            return (self.parameter,)
        return tuple(self.parameter.split(".", 2))


def place_of(definition: Definition, choice: Mapping[str, str], parameter: str) -> ValuePlace:
    """Place of a parameter's value in a model under a choice of alternatives: the axis that sets it, or the base.

    Examples
    --------
    >>> import torsionnet as tn
    >>> place_of(tn.load("amt_rig").definition, {"gear": "V"}, "tau").alternative
    'V'
    """
    setting = parameter not in definition.parameters and is_point_setting(parameter)
    for axis, alternatives in definition.configurations.items():  # no two of which set the same parameter
        overlay = alternatives.get(choice.get(axis, ""), _NOTHING)
        if _sets(overlay, parameter) if setting else parameter in overlay.parameters:
            return ValuePlace(parameter, axis, choice[axis], setting)
    return ValuePlace(parameter, is_setting=setting)


def _sets(overlay: Overlay, name: str) -> bool:
    """Whether an alternative gives an entry of the operating point or the load."""
    if name in LOAD_SIZES:
        return name in overlay.entries
    _, entry, place = name.split(".", 2)
    return overlay.operating_point is not None and place in getattr(overlay.operating_point, entry)


def changed_definition(definition: Definition, changes: Mapping[ValuePlace, Expression]) -> Definition:
    """Definition of a model with other values of the parameters at some places."""
    parameters = dict(definition.parameters)
    axes = {axis: dict(alternatives) for axis, alternatives in definition.configurations.items()}
    settings = Overlay()
    for place, value in changes.items():
        if place.is_setting:
            own = {place.parameter: plain_scalar(value)}
            if place.axis:
                alternatives = axes[place.axis]
                alternatives[place.alternative] = with_point_settings(alternatives[place.alternative], own, definition)
            else:
                settings = with_point_settings(settings, own, definition)
        elif not place.axis:
            parameters[place.parameter] = replace(parameters[place.parameter], value=value)
        else:
            overlay = axes[place.axis][place.alternative]
            values = {**overlay.parameters, place.parameter: value}
            axes[place.axis][place.alternative] = replace(overlay, parameters=values)
    return replace(definition, parameters=parameters, configurations=axes).with_overlay(settings)


def changed_text(
    text: str,
    definition: Definition,
    changes: Mapping[ValuePlace, Expression],
    file: str = "",
    folder: Path | None = None,
) -> str:
    """Text of a model file in which only the changed parameter values differ.

    Where that cannot be (a value that is an alias of another one), the model is written anew, without comments.

    Parameters
    ----------
    text : str
        What ``definition`` was read from.
    definition : Definition
    changes : mapping
        Place -> new value.
    file : str, optional
        Its name; of a ``.json`` file the new values are JSON.
    folder : path, optional
        Where files that the text names lie.

    Examples
    --------
    >>> from torsionnet.base.expression_reading import scalar
    >>> text = "{torsionnet: 1, name: x, parameters: {J: 2}, elements: {disc: {type: inertia, node: a, inertia: J}}}"
    >>> changed_text(text, read_text(text, "")[0], {ValuePlace("J"): scalar("3 kg*m^2")})
    '{torsionnet: 1, name: x, parameters: {J: 3 kg*m^2}, elements: {disc: {type: inertia, node: a, inertia: J}}}'
    """
    wanted = changed_definition(definition, changes)
    edited = _edited(text, definition, changes, file)
    reread = None if edited is None else read_text(edited, file, folder)[0]
    if edited is None or reread is None or reread.to_data() != wanted.to_data():
        return dump(wanted)
    return edited


def _edited(text: str, definition: Definition, changes: Mapping[ValuePlace, Expression], file: str) -> str | None:
    try:
        document = compose(text, file)
    except ModelError:
        return None
    starts = [0, *itertools.accumulate(map(len, text.splitlines(keepends=True)))]
    spans: list[tuple[int, int, str]] = []
    is_json = file.lower().endswith(".json")
    for place, value in changes.items():
        plain = plain_scalar(value)
        new = json.dumps(plain) if is_json else scalar_text(plain)
        span = _span(document, place, definition)
        if span is None:
            span, new = _inserted(document, place, definition, new, is_json)
        if span is None or span.end_line >= len(starts):
            return None
        spans.append((starts[span.line] + span.column, starts[span.end_line] + span.end_column, new))
    for start, end, new in sorted(spans, reverse=True):
        text = text[:start] + new + text[end:]
    return text


def _span(document: LocatedDocument, place: ValuePlace, definition: Definition) -> Span | None:
    for path in (*place.paths(), *_in_use(place, definition)):
        node = node_at(document, path)
        if node is not None and not isinstance(node.value, (dict, list)):
            return node.span
    return None


def node_at(document: LocatedDocument, path: EntryPath) -> LocatedNode | None:
    """Value at a path of a document with its place, None if there is none."""
    node = document.root
    for key in path:
        node = None if node is None else node.entries.get(key)
    return node


def _in_use(place: ValuePlace, definition: Definition) -> Iterator[EntryPath]:
    """Path of a part's parameter where a use of the part gives its value, for one copy and not for all."""
    if definition.authored is None or place.axis or place.is_setting:
        return
    from torsionnet.model.parts.authored_model import owner

    if owned := owner(definition.authored.authored.use, place.parameter):
        name, index, own = owned
        use = definition.authored.authored.use[name]
        if isinstance(use.parameters.get(own), tuple):
            yield ("use", name, "parameters", own, index)
        elif use.repeat is None:
            yield ("use", name, "parameters", own)


def _inserted(
    document: LocatedDocument, place: ValuePlace, definition: Definition, value: str, is_json: bool
) -> tuple[Span | None, str]:
    """Span at which a value is inserted that the author left to the part, and its text with its name."""
    for path in _in_use(place, definition):
        own = str(path[3]) if not is_json else json.dumps(path[3])
        table, use = node_at(document, path[:3]), node_at(document, path[:2])
        given = f"{own}: {value}"
        node = use if table is None else table
        if node is None or len(path) > 4 or not isinstance(node.value, dict) or not node.entries:
            continue
        key = '"parameters"' if is_json else "parameters"
        text = given if table is not None else f"{key}: {{{given}}}"
        line, column, *_ = node.place
        if document.lines[line][column : column + 1] == "{":
            return Span(line, column + 1, line, column + 1), f"{text}, "
        return Span(line, column, line, column), f"{text}\n{' ' * column}"
    return None, value
