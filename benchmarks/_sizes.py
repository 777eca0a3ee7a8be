"""The switch ``--short`` of every script here: the same code with small sizes and few runs, to see that it runs."""

import sys
from typing import TypeVar

T = TypeVar("T")

SHORT = "--short" in sys.argv
ARGUMENTS = [argument for argument in sys.argv[1:] if argument != "--short"]


def sized(full: T, short: T) -> T:
    """The size to measure with."""
    return short if SHORT else full
