"""What the results rest on: only what applies to this model."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from torsionnet.document.subject import Subject
from torsionnet.document.tree import Listing, Math, Section, Text, inlines
from torsionnet.document.words import listed, named, pair_latex, plain
from torsionnet.elements import (
    Differential, Gear, HystereticSpring, Lock, Planetary, RigidCoupling, Shaft, TabulatedSpring,
)  # fmt: skip

if TYPE_CHECKING:
    from torsionnet.elements import Element

FEW = 6


def validity_section(subject: Subject) -> Section:
    return Section("validity", ("Validity",), (Listing(tuple(_notes(subject))),))


def _of(subject: Subject, *kinds: type[Element]) -> str:
    """Names of the elements of these types that take part in any case."""
    found = {
        name: None
        for case in subject.cases
        for name, element in case.drivetrain.elements.items()
        if isinstance(element, kinds)
    }
    return listed([plain(name) for name in found], FEW)


def _notes(subject: Subject) -> Iterator[Text]:
    yield from _always(subject)
    yield from _damping(subject)
    yield from _ideal_parts(subject)
    yield from _readings(subject)


def _always(subject: Subject) -> Iterator[Text]:
    model = subject.model
    loaded = any(model.mean_speeds.values()) or any(model.mean_torques.values())
    about = " about the operating point" if loaded else ""
    yield (
        f"Linear: small torsional vibrations{about}. Backlash, clearances, friction that sticks, slipping clutches and "
        "stops are not in the model; where a gear unloads or a spring reaches another stage it does not hold.",
    )
    yield (
        "Lumped: inertia is in discs, compliance in springs between them. It holds well below the first torsional "
        "resonance within any one part. Bending, lateral and axial motion are not considered.",
    )
    shafts = _of(subject, Shaft)
    if shafts:
        yield (f"Shafts from their dimensions ({shafts}) are uniform and of circular section.",)


def _damping(subject: Subject) -> Iterator[Text]:
    systems = [case.drivetrain.assembly.system for case in subject.cases]
    if any((system.damping > 0).any() for system in systems):
        yield (
            "Viscous damping: its torque is proportional to frequency and fades out towards 0 Hz. Parts whose losses do "
            "not depend on frequency lag more at low frequency than the model says, and less at high frequency.",
        )
    elif not any(system.dynamic for system in systems):
        yield ("Without damping: peaks are unbounded; their heights in a plot say nothing.",)
    hysteretic, tables = _of(subject, HystereticSpring), _of(subject, TabulatedSpring)
    if hysteretic:
        yield (f"Hysteretic damping ({hysteretic}) is meant for steady vibration; it cannot be simulated over time.",)
    if tables:
        yield (f"Stiffness from a table ({tables}) holds at the amplitude, preload and temperature it was measured at.",)


def _ideal_parts(subject: Subject) -> Iterator[Text]:
    gears = _of(subject, Gear, Planetary, Differential)
    if gears:
        yield (
            f"Gears ({gears}) transmit without play and without errors of the teeth, always in contact. What lies behind "
            "a stage counts with the square of its ratio: an error of 1 % in a ratio is one of 2 % there.",
        )
    clamps = _of(subject, Lock)
    if clamps:
        yield (f"Clamps ({clamps}) are rigid. A real support gives way, which lowers natural frequencies.",)
    couplings = _of(subject, RigidCoupling)
    if couplings:
        yield (
            f"Rigid couplings ({couplings}) neither twist nor damp; their own resonances are taken to lie above the band.",
        )
    if any("rigid body" in modes.kinds for modes in subject.modes):
        yield (
            "The drivetrain can turn freely: angles over torques grow without bound towards 0 Hz; only twists, torques "
            "and differences of angles have a static value.",
        )


def _readings(subject: Subject) -> Iterator[Text]:
    sensors = subject.cases[0].drivetrain.sensors
    for pair in subject.pairs:
        if pair.input in sensors:
            yield (
                "Poles of ", Math(pair_latex(pair)), " are those of the drivetrain cut at ", *inlines(named(pair.input)),
                ". What lies upstream of it has no influence on this transfer function, and a test of it says nothing "
                "about that part.",
            )  # fmt: skip
    imposed = [name for name, channel in subject.model.inputs.items() if channel.quantity == "angle"]
    if imposed:
        shown = ", ".join(imposed)
        yield (f"Imposed angles ({shown}): the drive follows its set-point whatever the torque; elsewhere that node rests.",)
