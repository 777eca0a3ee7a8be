"""Lists of what a file for another program leaves out of a model, and of laws of motion that it holds as tangents."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from torsionnet.base.errors import UsageError, comma_list
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.dynamic_stiffness.state_space import active_channels
from torsionnet.model.elements import Action, Element, Law, MotionLaw, Part, Values
from torsionnet.model.law_network import following_elements
from torsionnet.model.operating_values import law_notes

CHANNELS = ("inputs", "sensors")
HELD: dict[str, tuple[str, ...]] = {
    "tors": (), "sheet": (), "matlab": CHANNELS, "mat": CHANNELS, "modelica": (*CHANNELS, "parameters"),
    "fmu": (*CHANNELS, "parameters"),
}  # fmt: skip
"""Sections of a model that a file of each format holds beside the elements."""
SECTIONS = ("parameters", *CHANNELS, "configurations", "operating_point", "speeds", "load", "excitations", "limits",
            "scenarios", "bench", "report")  # fmt: skip
"""Sections of a model of which no format holds all."""
MOST_NAMED = 20
"""Most names of a section that are listed; the rest are counted."""


@dataclass(frozen=True)
class ExportLosses:
    """Parts of a model that a file for another program leaves out or holds as straight lines.

    Attributes
    ----------
    left_out : tuple of (str, tuple of str)
        Section of the model, and the names in it that the file does not hold; none for a section without names.
    as_numbers : tuple of str
        Parameters whose values are in the file, but not their names.
    tangents : tuple of str
        Elements whose laws of motion are tangents at the operating point.
    point : tuple of str
        Sentences on that point.
    """

    left_out: tuple[tuple[str, tuple[str, ...]], ...] = ()
    as_numbers: tuple[str, ...] = ()
    tangents: tuple[str, ...] = ()
    point: tuple[str, ...] = ()

    def sentences(self) -> tuple[str, ...]:
        """Sentences for the file and the console; none for a model that the file holds in full."""
        return tuple(self._sentences())

    def _sentences(self) -> Iterator[str]:
        if self.left_out:
            parts = (f"{section.replace('_', ' ')}{f' {comma_list(names, MOST_NAMED)}' if names else ''}"
                     for section, names in self.left_out)  # fmt: skip
            yield f"not in this file: {'; '.join(parts)}"
        if self.as_numbers:
            yield f"parameters are numbers here: {comma_list(self.as_numbers, MOST_NAMED)}"
        if self.tangents:
            yield f"linear about the operating point, by tangents: {comma_list(self.tangents, MOST_NAMED)}"
            yield from self.point


def export_losses(drivetrain: Drivetrain, form: str) -> ExportLosses:
    """Parts of a drivetrain that a file of a format lacks, as ``tors``, ``sheet``, ``matlab``, ``modelica``, ``fmu``.

    >>> import torsionnet as tn
    >>> export_losses(tn.load("oil_engine"), "tors").left_out
    (('inputs', ('T_E',)), ('sensors', ('theta_E', 'T_ES', 'T_PS')))
    """
    definition, held, left_out = drivetrain.definition, HELD[form], []
    present = active_channels(drivetrain)
    acting: dict[str, Mapping[str, object]] = {"inputs": present.inputs, "sensors": present.sensors}
    for section in SECTIONS:
        content = getattr(definition, section)
        if section == "parameters" or not content:
            continue
        if section in acting:
            names = tuple(name for name in content if section not in held or name not in acting[section])
            left_out += [(section, names)] if names else []
        elif section != "operating_point" or content.to_data():
            left_out.append((section, tuple(content) if isinstance(content, Mapping) else ()))
    off = tuple(name for name, element in definition.elements.items() if not element.enabled)
    left_out += [("elements switched off", off)] if off else []
    tangents = tuple(element.name for element in following_elements(definition))
    numbers = () if "parameters" in held else tuple(definition.parameters)
    return ExportLosses(tuple(left_out), numbers, tangents, law_notes(definition) if tangents else ())


# Refusal of laws of motion by formats that hold linear elements only.

MOST_NAMES = 5
"""Most elements that the message names; the rest are counted."""


def refuse_laws_of_motion(drivetrain: Drivetrain, target: str) -> None:
    """Refuse a drivetrain whose laws of motion have no operating point, for a format that holds their tangents.

    Raises
    ------
    UsageError
        Naming the elements, and what gives them an operating point.
    """
    definition = drivetrain.definition
    if definition.tangents is not None and definition.tangents.is_loaded:
        return
    value = Values(drivetrain.exact_values)
    nonlinear = [
        f"{element.name} ({element.kind})"
        for element in following_elements(definition)
        if any(isinstance(part, MotionLaw) for part in element.whole_parts(value))
    ]
    if not nonlinear:
        return
    rest = f" and {len(nonlinear) - MOST_NAMES} more" if len(nonlinear) > MOST_NAMES else ""
    raise UsageError(
        f"{target} holds linear elements, and {', '.join(nonlinear[:MOST_NAMES])}{rest} follow laws of motion that "
        "are not linear; write the model at an operating point, which has their tangents: model.at(torque={...}), or "
        "load: or operating_point: in its file",
        kind="no-counterpart",
    )


# Descriptions of laws and constraints in words, for messages about what an export format cannot hold.


def describe_element_part(element: Element, part: Part) -> str:
    """Name and type of an element with the law or constraint of it that cannot be written.

    >>> import torsionnet as tn
    >>> from torsionnet.model.elements import Values
    >>> stage = tn.Gear("stage", nodes=("a", "b"), ratio=3, stiffness=100)
    >>> describe_element_part(stage, stage.parts(Values({}))[0])
    'stage (gear), stiffness on a - 3*b'
    """
    return f"{element.name} ({element.kind}), {describe_part(part)}"


def describe_part(part: Part) -> str:
    """Description of a law, constraint or action in words, what acts, and on which weighted sum of angles."""
    if isinstance(part, Action):
        return f"torque on {row_text(part.row)} that follows {row_text(part.sensed)}"
    if not isinstance(part, Law):
        return f"constraint {row_text(part.row)} = 0"
    acts = {
        "inertia": part.inertia != 0,
        "damping": part.damping != 0,
        "stiffness": part.stiffness != 0,
        "loss factor": part.loss_factor != 0,
        "table over frequency": part.table is not None,
    }
    names = [name for name, is_there in acts.items() if is_there]
    return f"{' and '.join(names)} on {row_text(part.row)}"


def row_text(row: dict[str, Any]) -> str:
    """Text of a weighted sum of angles by the names of the nodes; ``0`` for an empty one.

    >>> row_text({"a": 1, "b": -2.5})
    'a - 2.5*b'
    """
    text = ""
    for node, share in row.items():
        size = abs(float(share))
        sign = "-" if float(share) < 0 else "+"
        text += f" {sign} " if text else sign.replace("+", "")
        text += node if size == 1 else f"{size:g}*{node}"
    return text or "0"
