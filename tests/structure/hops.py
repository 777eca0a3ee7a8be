"""``python -m structure.hops``: which functions a stiffness, a frequency and the name of a sensor pass on their way."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

import torsionnet as tn

PACKAGE = str(Path(tn.__file__).parent)
STIFFNESS, FREQUENCY, SENSOR = "7731.25", "3.140625", "theta_marked"
MODEL = f"""
torsionnet: 1
name: one spring
elements:
  J: {{type: inertia, node: rotor, inertia: 2}}
  k: {{type: spring, nodes: [rotor, ground], stiffness: {STIFFNESS} N*m/rad, damping: 3}}
inputs: {{T: {{torque: rotor}}}}
sensors: {{{SENSOR}: {{angle: rotor}}}}
"""


def way(action: Callable[[], Any], mark: str) -> list[tuple[str, str]]:
    """File and name of every function of the package that gets what is marked, in the order of their first calls."""
    met: dict[tuple[str, str], None] = {}

    def watch(frame: FrameType, event: str, _: Any) -> None:
        if event == "call" and frame.f_code.co_filename.startswith(PACKAGE):
            sys.setprofile(None)
            try:
                if any(mark in _shown(value) for value in frame.f_locals.values()):
                    met[frame.f_code.co_filename.removeprefix(PACKAGE), frame.f_code.co_qualname] = None
            finally:
                sys.setprofile(watch)

    sys.setprofile(watch)
    try:
        action()
    finally:
        sys.setprofile(None)
    return [place for place in met if "<" not in place[1].replace("<locals>", "")]


def _shown(value: Any) -> str:
    if isinstance(value, str | int | float | complex | dict | list | tuple | np.ndarray):
        return repr(value)
    if type(value).__name__ in {"Number", "Fraction"}:
        return f"{value!r} {float(getattr(value, 'value', value))!r}"
    return ""


def main() -> None:
    rig, again = tn.loads(MODEL), tn.loads(MODEL)
    ways = {
        "a stiffness, from text to the assembled rows": (lambda: tn.loads(MODEL).assembly, STIFFNESS),
        "a frequency, from the call to the solved points": (
            lambda: rig.frequency_response(SENSOR, "T", [float(FREQUENCY)]),
            FREQUENCY,
        ),
        "the name of a sensor, from the call to its row": (
            lambda: again.frequency_response(SENSOR, "T", [1.0]),
            SENSOR,
        ),
    }
    for name, (action, mark) in ways.items():
        met = way(action, mark)
        print(f"{name}: {len(met)} functions in {len({file for file, _ in met})} files")
        if "-v" in sys.argv:
            for file, function in met:
                print(f"    {file} {function}")


if __name__ == "__main__":
    main()
