"""Lists of what a file for another program leaves out of a model, and of laws of motion that it holds as tangents."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from torsionnet.base.errors import comma_list
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.dynamic_stiffness.state_space import active_channels
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
