"""Models loaded by file, by name in the library, or from standard input."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from torsionnet.core.errors import Fault
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.model.definition import Definition

STANDARD_INPUT = "-"
STANDARD_INPUT_NAME = "<stdin>"


def load_model(model: str) -> Drivetrain:
    """Drivetrain of a model file, or of a library model called by its name.

    ``-`` reads the model from standard input.
    """
    from torsionnet.loading import load, loads

    return loads(standard_input_text(), STANDARD_INPUT_NAME) if model == STANDARD_INPUT else load(model)


def checked_model(model: str) -> list[Fault]:
    """Errors, warnings and notes on a model, also on unstable modes in any of its configurations."""
    from torsionnet.model.files import read_file
    from torsionnet.model.files.reader import read_text

    if model == STANDARD_INPUT:
        return read_text(standard_input_text(), STANDARD_INPUT_NAME, further=_growing)[1]
    return read_file(model, _growing)[1]


def _growing(definition: Definition) -> list[Fault]:
    """Warnings about modes of a model that grow, in all its configurations.

    None if no element can feed energy into a vibration.
    """
    from torsionnet.model.checks import variants

    found: list[Fault] = []
    for name, variant in (("", definition), *variants(definition)):
        if not any(element.may_feed for element in variant.active):
            continue
        from torsionnet.drivetrain import Drivetrain
        from torsionnet.solve.modes.stability import unstable_modes

        known = {(fault.message, fault.path) for fault in found}
        faults = unstable_modes(Drivetrain.from_definition(variant))
        found += [replace(one, configuration=name) for one in faults if (one.message, one.path) not in known]
    return found


def standard_input_text() -> str:
    """Text of a model read from standard input."""
    from torsionnet.model.files.decoding import decode

    return decode(sys.stdin.buffer.read(), STANDARD_INPUT_NAME)
