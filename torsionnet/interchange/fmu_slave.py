"""What runs inside an FMU: copied into it as it is, with its numbers beside it. It needs numpy, not torsionnet.

The state is stepped by stored matrices, z+ = E z + G u with u held over a step, which is exact; a longer communication
step takes powers of them.
"""

import json
from pathlib import Path
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


class TorsionnetSlave(Fmi2Slave):
    """A drivetrain from rest under torques that are held between communication points."""

    def __init__(self, **kwargs) -> None:
        super().__init__(**kwargs)
        folder = Path(self.resources)
        about = json.loads((folder / "about.json").read_text(encoding="utf-8"))
        self.modelName = about["identifier"]
        self.description = about["title"]
        self.version = about["version"]
        self.guid = about["guid"]
        self.base = about["step"]
        with np.load(folder / "stepping.npz") as stored:
            self.step, self.gain, self.C, self.D = (stored[name] for name in ("step", "gain", "C", "D"))
        self.z = np.zeros(len(self.step), dtype=complex)
        self.u = np.zeros(self.gain.shape[1])
        self.powers = {1: (self.step, self.gain)}
        self.units = [unit for _, unit in (*about["inputs"], *about["outputs"])]
        for index, (name, _) in enumerate(about["inputs"]):
            self._register(name, Fmi2Causality.input, self._input(index), self._driver(index))
        for index, (name, _) in enumerate(about["outputs"]):
            self._register(name, Fmi2Causality.output, self._output(index), None)

    def _register(self, name, causality, getter, setter) -> None:
        self.register_variable(Real(name, causality=causality, getter=getter, setter=setter), nested=False)

    def to_xml(self, *arguments, **options) -> Element:
        """The model description with what pythonfmu leaves out: units, and the unknowns of the initialisation."""
        root = super().to_xml(*arguments, **options)
        units = Element("UnitDefinitions")
        for name in dict.fromkeys(self.units):
            base = {key: str(power) for key, power in UNITS[name].items()}
            SubElement(SubElement(units, "Unit", {"name": name}), "BaseUnit", base)
        root.insert(1, units)
        for variable, unit in zip(root.find("ModelVariables"), self.units, strict=True):
            variable.find("Real").set("unit", unit)
        structure = root.find("ModelStructure")
        initial = SubElement(structure, "InitialUnknowns")
        for output in structure.find("Outputs"):
            SubElement(initial, "Unknown", {"index": output.get("index")})
        return root

    def _input(self, index):
        return lambda: self.u[index]

    def _driver(self, index):
        def drive(value) -> None:
            self.u[index] = value

        return drive

    def _output(self, index):
        return lambda: float((self.C[index] @ self.z).real + self.D[index] @ self.u)

    def _times(self, count):
        """Matrices of so many steps at once, the input held all the while."""
        if count not in self.powers:
            half = self._times(count // 2)
            step, gain = half[0] @ half[0], half[0] @ half[1] + half[1]
            if count % 2:
                step, gain = self.step @ step, self.step @ gain + self.gain
            self.powers[count] = (step, gain)
        return self.powers[count]

    def do_step(self, current_time, step_size) -> bool:
        """Refuse a communication step that is no whole multiple of the step the matrices are for."""
        count = round(step_size / self.base)
        if count < 1 or abs(step_size / self.base - count) > NEAR * count:
            self.log(f"the communication step {step_size} s is no whole multiple of {self.base} s")
            return False
        step, gain = self._times(count)
        self.z = step @ self.z + gain @ self.u
        return True
