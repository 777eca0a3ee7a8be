"""Models by file, by name in the library, or from standard input."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from torsionnet.files import read_file
from torsionnet.files.decoding import decode
from torsionnet.files.reader import read_text
from torsionnet.loading import load, loads

if TYPE_CHECKING:
    from torsionnet.definition import Definition
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.errors import Fault

STANDARD_INPUT = "-"
SHOWN = "<stdin>"


def load_model(model: str) -> Drivetrain:
    """The drivetrain of a model file, of a library model, or of what is piped in as ``-``."""
    return loads(piped(), SHOWN) if model == STANDARD_INPUT else load(model)


def read_model(model: str) -> tuple[Definition | None, list[Fault]]:
    """As :func:`torsionnet.files.read_file`, also for ``-``."""
    return read_text(piped(), SHOWN) if model == STANDARD_INPUT else read_file(model)


def piped() -> str:
    """What is piped in."""
    return decode(sys.stdin.buffer.read(), SHOWN)
