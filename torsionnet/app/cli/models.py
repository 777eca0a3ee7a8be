"""Models loaded by file, by name in the library, or from standard input."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from torsionnet.base.errors import Fault
    from torsionnet.drivetrain import Drivetrain

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
    from torsionnet.app.text.unstable_configurations import unstable_configurations
    from torsionnet.model.files import read_file
    from torsionnet.model.files.reader import read_text

    if model == STANDARD_INPUT:
        return read_text(standard_input_text(), STANDARD_INPUT_NAME, further=unstable_configurations)[1]
    return read_file(model, unstable_configurations)[1]


def standard_input_text() -> str:
    """Text of a model read from standard input."""
    from torsionnet.model.files.library import decode

    return decode(sys.stdin.buffer.read(), STANDARD_INPUT_NAME)
