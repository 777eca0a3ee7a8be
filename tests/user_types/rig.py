"""A program of a user who lets a type checker look at it: every way to call that the documentation has."""

from fractions import Fraction
from pathlib import Path

import numpy as np

import torsionnet as tn
from torsionnet import Drivetrain, Gear, Inertia, Spring, load
from torsionnet.io import read_recording
from torsionnet.model.element_base.laws import Values
from torsionnet.plot import bode, save
from torsionnet.signals import Recording, Welch


def driveline(stiffness: float | str, inertias: list[float]) -> Drivetrain:
    elements: list[tn.Element] = [
        Inertia("motor", "a", 0.078),
        Spring("shaft", ("a", "b"), stiffness, damping={"zeta": 0.02, "at": "12 Hz"}),
        Gear("stage", nodes=["b", "c"], ratio=Fraction(207, 50)),
        *(Inertia(f"disc_{place}", "c", value) for place, value in enumerate(inertias)),
    ]
    return Drivetrain(
        "driveline",
        elements,
        parameters={"k": "3 kN*m/rad"},
        inputs={"T": {"torque": "a"}},
        sensors={"twist": {"twist": "shaft"}, "out": {"velocity": "c"}},
    )


def first_frequency(rig: Drivetrain) -> float:
    return float(rig.modes().natural_frequencies[0])


def others(catalogue: Path) -> dict[str, tn.Element]:
    found = [
        tn.Belt("belt", pulleys={"crank": "70 mm", "pump": "35 mm"}, stiffness=["300 kN/m", "200 kN/m"]),
        tn.Clutch("clutch", ("a", "b"), "open"),
        tn.Controller("speed", sense={"velocity": "a"}, act="a", law={"p": 3, "i": "2"}),
        tn.FlexibleCoupling(
            "rubber", ("a", "b"), stiffness_over_torque={"0.2": "4 kN*m/rad", "1": "9 kN*m/rad"}, T_KN=5e3, torque=2e3
        ),
        tn.Gearbox("box", "a", "b", ratios={"I": 3.77, "II": 1.96}, engaged="I"),
        tn.HystereticSpring("maker", ("a", "b"), None, None, catalogue=catalogue, size="A350"),
        tn.Planetary("set", sun="sun", ring="ground", carrier="out", teeth=(28, 62)),
        tn.Shaft("long", ("a", "b"), "80 mm", 2, segments=4, inertia="lumped"),
        tn.TabulatedSpring("measured", ("a", "b"), table=np.array([[1.0, 4e3, 2.0], [9.0, 5e3, 1.0]])),
    ]
    return {one.name: one for one in found}


class Ring(tn.Element):
    """An element of one's own."""

    def own_parts(self, value: Values) -> tuple[()]:
        return ()


def main() -> None:
    rig = driveline("k", [0.2, 0.3])
    response = rig.frequency_response("twist", "T", np.linspace(1, 40, 200))
    save(bode(response), "bode.svg")
    record: Recording = read_recording("test.csv")
    estimated = tn.signals.estimate(record, "twist", "T", settings=Welch(seconds=4))
    figure = tn.plot.bode([response, estimated])
    print(first_frequency(load("dmf_rig")), len(others(Path("couplings.csv"))), Ring("ring").name, figure.axes)
    print(tn.units.convert(3, "kN*m", "N*m"), tn.__version__)
