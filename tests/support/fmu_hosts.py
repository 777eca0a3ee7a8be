"""Hosts for the functional mock-up units of the tests: step by step through FMPy's bindings, or with an ODE solver."""

import ctypes
import functools
import inspect
import tempfile
from pathlib import Path

import numpy as np
import pytest
import scipy

import torsionnet as tn
from support import campaigns
from support.collecting import OnDemand
from torsionnet.io import write_fmu
from torsionnet.io.fmu import c_source as compiling

fmpy, fmi2, fmi3 = OnDemand("fmpy"), OnDemand("fmpy.fmi2"), OnDemand("fmpy.fmi3")

VERSIONS = ("2.0", "3.0")
FOLDERS = []


@functools.cache
def library_model(name, configuration=""):
    rig = tn.load(name)
    return rig.configured(configuration) if configuration else rig


@functools.cache
def unpacked(rig, version="2.0"):
    """(Path of an FMU, folder it is unpacked in): compiled once for all tests of a process."""
    FOLDERS.append(tempfile.TemporaryDirectory(prefix="torsionnet_test_", ignore_cleanup_errors=True))
    path = Path(FOLDERS[-1].name, "rig.fmu")
    with pytest.MonkeyPatch.context() as patch:
        if not campaigns.many:  # making programs fast takes compilers two thirds of their time
            patch.setattr(compiling, "FLAGS", (*compiling.FLAGS, "-O0", "-fno-sanitize=undefined"))
        write_fmu(rig, path, version=version)
    return path, fmpy.extract(str(path), str(path.with_name("unpacked")))


class Host:
    """One instance of an FMU, addressed by names; ``messages`` are what it logged."""

    def __init__(self, rig, version="2.0", kind="CoSimulation", token=None, ask=None, events=False):
        self.path, folder = unpacked(rig, version)
        self.about = fmpy.read_model_description(str(self.path))
        self.version, self.messages = version, []
        self.references = {variable.name: variable.valueReference for variable in self.about.modelVariables}
        self.inputs, self.outputs = (
            [v.name for v in self.about.modelVariables if v.causality == side] for side in ("input", "output")
        )
        side = "Slave" if kind == "CoSimulation" else "Model"
        maker = getattr(*((fmi2, f"FMU2{side}") if version == "2.0" else (fmi3, f"FMU3{side}")))
        self.unit = maker(
            guid=token or self.about.guid, unzipDirectory=folder, instanceName="rig",
            modelIdentifier=self.about.coSimulation.modelIdentifier,
        )  # fmt: skip
        self._instantiate(ask, events)

    def _instantiate(self, ask, events):
        if self.version == "2.0":
            self.callbacks = fmi2.fmi2CallbackFunctions()
            self.callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(
                lambda *said: self.messages.append((said[2], said[4].decode()))
            )
            self.unit.instantiate(callbacks=self.callbacks)
            return
        more = {"eventModeUsed": True} if events else {}
        if ask is not None:
            if "requiredIntermediateVariables" not in inspect.signature(self.unit.instantiate).parameters:
                pytest.skip("this fmpy, the newest one for numpy 2.0, asks for no values between steps")
            names = [self.references[name] for name in self.inputs]
            more |= {"intermediateUpdate": lambda *said: ask(self, said[1]), "requiredIntermediateVariables": names}
        self.unit.instantiate(logMessage=lambda *said: self.messages.append((said[1], said[3].decode())), **more)

    def start(self, time=0.0, **values):
        """Set values, also parameters, and begin."""
        if self.version == "2.0":
            self.unit.setupExperiment(startTime=time)
            self.unit.enterInitializationMode()
        else:
            self.unit.enterInitializationMode(startTime=time)
        self.set(values)
        self.unit.exitInitializationMode()
        return self

    def set(self, values):
        flags = {name: value for name, value in values.items() if isinstance(value, bool)}
        numbers = {name: value for name, value in values.items() if name not in flags}
        references = [self.references[name] for name in numbers]
        setter = self.unit.setReal if self.version == "2.0" else self.unit.setFloat64
        setter(references, [float(value) for value in numbers.values()])
        for name, value in flags.items():
            self.unit.setBoolean([self.references[name]], [value])

    def get(self, names=None):
        references = [self.references[name] for name in names or self.outputs]
        return np.array((self.unit.getReal if self.version == "2.0" else self.unit.getFloat64)(references))

    def slopes(self, values):
        """How fast inputs change in the next step, FMI 2.0."""
        self.unit.setRealInputDerivatives(
            [self.references[name] for name in values], [1] * len(values), list(values.values())
        )

    def step(self, time, size):
        self.unit.doStep(currentCommunicationPoint=time, communicationStepSize=size)

    def run(self, times, inputs, told=False):
        """Outputs (n, n_out) at ``times`` under inputs (n, n_in) there; ``told`` gives the host's slopes as well."""
        outputs = []
        for number, time in enumerate(times):
            outputs.append(self.get())
            if number + 1 == len(times):
                break
            self.set(dict(zip(self.inputs, inputs[number], strict=True)))
            size = times[number + 1] - time
            if told:
                rise = (inputs[number + 1] - inputs[number]) / size
                self.slopes(dict(zip(self.inputs, map(float, rise), strict=True)))
            if not number:
                outputs[0] = self.get()
            self.step(time, size)
        return np.array(outputs)

    def integrate(self, times, torque, tolerance=1e-10):
        """Outputs (n, n_out) of model exchange under ``torque(time)``, a function to an array (n_in,)."""
        n = sum(variable.derivative is not None for variable in self.about.modelVariables)
        if self.version == "2.0":
            self.unit.enterContinuousTimeMode()
        else:
            self.unit.updateDiscreteStates()
            self.unit.enterContinuousTimeMode()

        def at(time, x):
            self.unit.setTime(time)
            self.unit.setContinuousStates((ctypes.c_double * n)(*x), n)
            self.set(dict(zip(self.inputs, torque(time), strict=True)))

        def rates(time, x):
            at(time, x)
            dx = (ctypes.c_double * n)()
            (self.unit.getDerivatives if self.version == "2.0" else self.unit.getContinuousStateDerivatives)(dx, n)
            return np.array(dx)

        solution = scipy.integrate.solve_ivp(
            rates, (times[0], times[-1]), np.zeros(n), "DOP853", times, rtol=tolerance, atol=1e-16
        )
        outputs = []
        for time, x in zip(times, solution.y.T, strict=True):
            at(time, x)
            outputs.append(self.get())
        return np.array(outputs)
