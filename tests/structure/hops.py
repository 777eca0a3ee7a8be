"""``python -m structure.hops``: functions that a stiffness and other marked values pass on their way; ``-v`` names
them.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any, NamedTuple

import numpy as np

import torsionnet as tn

PACKAGE = str(Path(tn.__file__).parent)
STIFFNESS, FREQUENCY, SENSOR = "7731.25", "3.140625", "theta_marked"
FIRING_ORDER = "1, 5, 4, 2, 3"
NATURAL_FREQUENCY = "9.8953"
"""Hz: sqrt(7731.25/2)/(2 pi), of the spring below with its disc."""
MODEL = f"""
torsionnet: 1
name: one spring
elements:
  J: {{type: inertia, node: rotor, inertia: 2}}
  k: {{type: spring, nodes: [rotor, ground], stiffness: {STIFFNESS} N*m/rad, damping: 3}}
inputs: {{T: {{torque: rotor}}}}
sensors: {{{SENSOR}: {{angle: rotor}}}}
"""
ENGINE = f"""
torsionnet: 1
name: five cylinders
elements:
  {"".join(f"J{i}: {{type: inertia, node: c{i}, inertia: 0.9}}{chr(10)}  " for i in range(1, 6))}
  {"".join(f"k{i}: {{type: spring, nodes: [c{i}, c{i + 1}], stiffness: 3e6, damping: 60}}{chr(10)}  " for i in range(1, 5))}
sensors: {{T: {{torque: k1}}}}
speeds: {{of: c5, range: 600..700 rpm, step: 50 rpm}}
excitations:
  engine:
    type: reciprocating_engine
    speed_of: c5
    cycle: 4
    cylinders: {{1: c1, 2: c2, 3: c3, 4: c4, 5: c5}}
    firing_order: [{FIRING_ORDER}]
    bore: 160 mm
    stroke: 190 mm
    rod_length: 340 mm
    reciprocating_mass: 9.5 kg
    gas:
      harmonics:
        20 bar: {{0.5: {{amplitude: 5.1 bar, phase: -77 deg}}, 2.5: {{amplitude: 2.6 bar, phase: -50 deg}}}}
      motored_harmonics: {{0.5: {{cosine: 0 bar, sine: 1.3 bar}}}}
    load: {{mean_indicated_pressure: 20 bar}}
"""
VARIED = MODEL.replace(f"{STIFFNESS} N*m/rad", "k").replace("elements:", "parameters: {k: 5 kN*m/rad}\nelements:")
STUDY = f"""
torsionnet: 1
name: two stiffnesses
model: model.yaml
vary: {{k: {{type: list, values: [{STIFFNESS}, 8000]}}}}
quantities: {{f: {{type: natural_frequency, mode: 1}}}}
"""


class Walk(NamedTuple):
    """Marked value to be traced: the code that sets it going, and the texts by which it is recognised."""

    of: str
    action: Callable[[], Any]
    marks: tuple[str, ...]


def way(action: Callable[[], Any], *marks: str) -> list[tuple[str, str]]:
    """File and name of every function of the package that receives a marked value, in the order of first calls."""
    met: dict[tuple[str, str], None] = {}

    def watch(frame: FrameType, event: str, _: Any) -> None:
        if event == "call" and frame.f_code.co_filename.startswith(PACKAGE):
            sys.setprofile(None)
            try:
                shown = [_shown(value) for value in frame.f_locals.values()]
                if any(mark in text for mark in marks for text in shown):
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


def walks() -> list[Walk]:
    """All traced values; everything before their first step has been done."""
    rig, again = tn.loads(MODEL), tn.loads(MODEL)
    return [
        Walk("a stiffness, from text to the assembled rows", lambda: tn.loads(MODEL).assembly, (STIFFNESS,)),
        Walk(
            "a firing order, from text to the torques of an order response",
            lambda: tn.loads(ENGINE).order_response("T"),
            (FIRING_ORDER,),
        ),
        Walk("a value of a study, from text to what came of it", _study, (STIFFNESS, NATURAL_FREQUENCY)),
        Walk(
            "a frequency, from the call to the solved points",
            lambda: rig.frequency_response(SENSOR, "T", [float(FREQUENCY)]),
            (FREQUENCY,),
        ),
        Walk(
            "the name of a sensor, from the call to its row",
            lambda: again.frequency_response(SENSOR, "T", [1.0]),
            (SENSOR,),
        ),
    ]


def _study() -> None:
    from torsionnet.study import load_study, run_study

    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "model.yaml").write_text(VARIED, encoding="utf-8")
        (Path(folder) / "study.yaml").write_text(STUDY, encoding="utf-8")
        run_study(load_study(Path(folder) / "study.yaml"))


def counted(met: list[tuple[str, str]]) -> str:
    return f"{len(met)} functions in {len({file for file, _ in met})} files"


def main() -> None:
    found = [(walk.of, way(walk.action, *walk.marks)) for walk in walks()]
    if "--json" in sys.argv:
        print(json.dumps(found))
        return
    for name, met in found:
        print(f"{name}: {counted(met)}")
        if "-v" in sys.argv:
            for file, function in met:
                print(f"    {file} {function}")


if __name__ == "__main__":
    main()
