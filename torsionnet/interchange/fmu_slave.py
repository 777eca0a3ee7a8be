"""What runs inside an FMU: copied into it as it is, with its numbers beside it. It needs numpy, not torsionnet.

The state is stepped by stored matrices, z+ = E z + G u with u held over a step, which is exact; a longer communication
step takes powers of them.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from pythonfmu import Fmi2Causality, Fmi2Slave, Real

NEAR = 1e-6
UNITS = {
    "N.m": {"kg": 1, "m": 2, "s": -2},
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "rad/s2": {"rad": 1, "s": -2},
}


class TorsionnetSlave(Fmi2Slave):  # type: ignore[misc]  # pythonfmu has no types
    """A drivetrain from rest under torques that are held between communication points."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        folder = Path(self.resources)
        about = json.loads((folder / "about.json").read_text(encoding="utf-8"))
        self.modelName = about["identifier"]
        self.description = about["title"]
        self.version = about["version"]
        self.guid = about["guid"]
        self.base = float(about["step"])
        with np.load(folder / "stepping.npz") as stored:
            self.step, self.gain, self.C, self.D = (stored[name] for name in ("step", "gain", "C", "D"))
        self.z = np.zeros(len(self.step), dtype=complex)
        self.u = np.zeros(self.gain.shape[1])
        self.powers: dict[int, tuple[Any, Any]] = {1: (self.step, self.gain)}
        self.units = [unit for _, unit in (*about["inputs"], *about["outputs"])]
        for index, (name, _) in enumerate(about["inputs"]):
            self._register(name, Fmi2Causality.input, self._input(index), self._driver(index))
        for index, (name, _) in enumerate(about["outputs"]):
            self._register(name, Fmi2Causality.output, self._output(index), None)

    def _register(self, name: str, causality: Any, getter: Any, setter: Any) -> None:
        self.register_variable(Real(name, causality=causality, getter=getter, setter=setter), nested=False)

    def to_xml(self, *arguments: Any, **options: Any) -> Element:
        """The model description with what pythonfmu leaves out: units, and the unknowns of the initialisation."""
        root: Element = super().to_xml(*arguments, **options)
        units = Element("UnitDefinitions")
        for name in dict.fromkeys(self.units):
            base = {key: str(power) for key, power in UNITS[name].items()}
            SubElement(SubElement(units, "Unit", {"name": name}), "BaseUnit", base)
        root.insert(1, units)
        for entry, unit in zip(root.iterfind("ModelVariables/ScalarVariable/Real"), self.units, strict=True):
            entry.set("unit", unit)
        structure = next(root.iter("ModelStructure"))
        initial = SubElement(structure, "InitialUnknowns")
        for output in structure.findall("Outputs/Unknown"):
            SubElement(initial, "Unknown", dict(output.attrib))
        return root

    def _input(self, index: int) -> Callable[[], float]:
        return lambda: float(self.u[index])

    def _driver(self, index: int) -> Callable[[float], None]:
        def drive(value: float) -> None:
            self.u[index] = value

        return drive

    def _output(self, index: int) -> Callable[[], float]:
        return lambda: float((self.C[index] @ self.z).real + self.D[index] @ self.u)

    def _times(self, count: int) -> tuple[Any, Any]:
        """Matrices of so many steps at once, the input held all the while."""
        if count not in self.powers:
            half = self._times(count // 2)
            step, gain = half[0] @ half[0], half[0] @ half[1] + half[1]
            if count % 2:
                step, gain = self.step @ step, self.step @ gain + self.gain
            self.powers[count] = (step, gain)
        return self.powers[count]

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Refuse a communication step that is no whole multiple of the step the matrices are for."""
        del current_time
        count = round(step_size / self.base)
        if count < 1 or abs(step_size / self.base - count) > NEAR * count:
            self.log(f"the communication step {step_size} s is no whole multiple of {self.base} s")
            return False
        step, gain = self._times(count)
        self.z = step @ self.z + gain @ self.u
        return True
