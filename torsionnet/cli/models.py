"""Models by file, by name in the library, or from standard input."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from torsionnet.core.errors import Fault
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.model.definition import Definition

STANDARD_INPUT = "-"
SHOWN = "<stdin>"


def load_model(model: str) -> Drivetrain:
    """The drivetrain of a model file, of a library model, or of what is piped in as ``-``."""
    from torsionnet.loading import load, loads

    return loads(piped(), SHOWN) if model == STANDARD_INPUT else load(model)


def read_model(model: str) -> tuple[Definition | None, list[Fault]]:
    """As :func:`torsionnet.model.files.read_file`, also for ``-``."""
    from torsionnet.model.files import read_file
    from torsionnet.model.files.reader import read_text

    return read_text(piped(), SHOWN) if model == STANDARD_INPUT else read_file(model)


def piped() -> str:
    """What is piped in."""
    from torsionnet.model.files.decoding import decode

    return decode(sys.stdin.buffer.read(), SHOWN)
