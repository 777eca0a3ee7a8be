"""Faults that change no result, each with its reason: drawn once, looked at, and set aside by name from then on."""

from __future__ import annotations

from pathlib import Path

from mutation.mutants import Mutant

NAMES = Path(__file__).with_name("equivalent.txt")
"""Lines ``module:function: old -> new | reason``; empty lines and those behind # do not count."""


def reason_of(mutant: Mutant) -> str | None:
    """Why a fault changes no result; None where it may."""
    for line in NAMES.read_text(encoding="utf-8").splitlines():
        name, separator, reason = line.rpartition(" | ")
        if separator and not line.startswith("#") and name == name_of(mutant):
            return reason
    return None


def name_of(mutant: Mutant) -> str:
    """The fault, wherever its line stands."""
    return f"{mutant.module}:{mutant.function}: {' '.join(mutant.old.split())} -> {mutant.new}"
