"""Switch ``--short`` of every benchmark: the same code with small sizes and few runs, to check that it runs."""

import sys
from typing import TypeVar

T = TypeVar("T")

SHORT = "--short" in sys.argv
ARGUMENTS = [argument for argument in sys.argv[1:] if argument != "--short"]


def sized(full: T, short: T) -> T:
    """Size to measure with: ``full``, or the small one with ``--short``."""
    return short if SHORT else full
