"""Scenario of a short circuit or of faulty synchronisation at a synchronous machine."""

from __future__ import annotations

from cmath import rect
from dataclasses import dataclass
from math import cos, pi, sin
from typing import Any, ClassVar

from torsionnet.base.entries.composite import superfluous
from torsionnet.base.entries.scalars import PhysicalQuantity, Value
from torsionnet.base.entries.spec import Count, entry
from torsionnet.base.errors import Fault, unknown_name
from torsionnet.base.expressions import Expression, Number
from torsionnet.base.phrases import phrase
from torsionnet.model.operating_point import MachineName
from torsionnet.motion.scenarios.scenario import (
    OPERATING_POINT,
    DrivingCourse,
    GridTie,
    Scenario,
    ScenarioSubject,
    register_scenario,
)
from torsionnet.motion.scenarios.time_history import HistoryPiece, TimeHistory, Wave

AFTERWARDS = 0.5
"""Time in s after the fault that is simulated unless another is asked for: thirty periods of a 60 Hz line, in which the
slowest torsional vibrations of turbine sets, about 10 Hz, swing five times."""
ROTORS = ("inertia", "grid_generator", "synchronous_machine", "induction_machine", "electric_machine")
"""Kinds of elements, and of an excitation, at which an electric fault may come: machines, or the inertia of a rotor."""
TIED = ("grid_generator", "synchronous_machine")
"""Kinds of elements that hold the synchronising torque of a machine on the grid."""
NEAR = 0.1
"""Distance from a whole number of the pole pairs that speed and frequency give, which a slip makes."""
ROUNDING = 1 + 1e-12
"""Factor of 180 degrees up to which an angle counts as 180 degrees, as units are converted."""
_TIME_CONSTANT = "time constant in which the torque at the line frequency dies away; none: it stays"


@register_scenario
@dataclass(frozen=True, kw_only=True)
class ShortCircuitScenario(Scenario):
    """A short circuit at the terminals of a synchronous machine, or its connection to the grid at a wrong angle.

    With constant flux, without resistance, at rated voltage and without load before, the torque in the air gap per
    unit of the rated torque is, from the instant of the fault on, t counted from there, omega = 2 pi f:

        three phases:   T = e^(-t/decay) sin(omega t)/x
        two phases:     T = (e^(-t/decay) sin(omega t) - e^(-t/decay_double) sin(2 omega t)/2)/x
        synchronising:  T = (sin(delta + p (theta - Omega t)) - e^(-t/decay) (sin(omega t + delta) - sin(omega t)))/x

    with x = x'' + x_external, p pole pairs, Omega = omega/p, and theta the angle of the rotor since the connection,
    against a stator that gives way. The synchronising torque follows the rotor, so that the set swings onto the grid;
    what the dampers of the model take lets the swing die away. A rotor that begins without speed counts its motion from
    its mean speed, or else from that of the grid.

    Without decay the crests are 1/x, 3 sqrt(3)/4/x, and for a heavy rotor 3 sqrt(3)/2/x at the worst angle, delta = 120
    degrees: its torque is 2 sin(delta/2) (cos(delta/2) - cos(omega t + delta/2))/x. T acts on the rotor against its
    rotation, on top of the torque before, and the other way on a stator that gives way; delta is positive where the
    rotor is ahead of the grid. (J. S. Joyce, T. Kulig, D. Lambrecht, Torsional fatigue of turbine-generator shafts
    caused by different electrical system faults and switching operations, IEEE Trans. PAS-97, 1978, on such torques and
    what they do; P. Kundur, Power System Stability and Control, 1994, on the torque over the angle of the rotor.)

    Examples
    --------
    >>> import torsionnet as tn
    >>> rotor = tn.Drivetrain("rotor", [tn.Inertia("G", node="rotor", inertia=1)])
    >>> fault = tn.ShortCircuitScenario(machine="G", phases=3, x=0.2, rated_torque="100 N*m", frequency="50 Hz")
    >>> record = rotor.simulate("rotor", scenario=fault, sampling_rate=200)
    >>> round(float(record["torque on rotor"].values[1]), 6)
    -500.0
    """

    kind: ClassVar[str] = "short_circuit"
    form: ClassVar[str] = "{type: short_circuit, machine: G, phases: 2, at: 0.1 s, x: 0.135}"

    machine: str = entry(MachineName("the element of the machine, or its excitation electric_machine"))
    phases: int | None = entry(Count("how many phases are short, 2 or 3", 2, 3), None)
    angle: Expression | None = entry(
        PhysicalQuantity(
            "instead, faulty synchronisation: electrical angle of the rotor ahead of the grid", "angle", "delta", None
        ),
        None,
    )
    at: float = entry(Value("time of the fault", "time"), 0)
    x: Expression = entry(PhysicalQuantity("subtransient reactance, per unit", "1", "x''", exclusive=True))
    x_external: Expression = entry(
        PhysicalQuantity("reactance from the machine to the fault or the grid, per unit", "1", "x_e"), 0
    )
    decay: Expression | None = entry(PhysicalQuantity(_TIME_CONSTANT, "time", "T_1", exclusive=True), None)
    decay_double: Expression | None = entry(
        PhysicalQuantity("the same of the torque at twice the line frequency", "time", "T_2", exclusive=True), None
    )
    rated_torque: Expression | None = entry(
        PhysicalQuantity("torque of 1 per unit; default: that of the machine", "torque", "T_r", exclusive=True), None
    )
    frequency: Expression | None = entry(
        PhysicalQuantity("line frequency; default: that of the machine", "frequency", "f", exclusive=True), None
    )
    pole_pairs: int | None = entry(
        Count("pole pairs of a machine that is synchronised; default: from machine, or its speed", 1, 10_000), None
    )

    def contradictions(self) -> list[Fault]:
        faults = []
        if (self.phases is None) == (self.angle is None):
            text = "give the phases that are short, as phases: 2, or the angle of a faulty synchronisation"
            faults.append(Fault(text, on_key=True, kind="missing-entry"))
        if self.decay_double is not None and self.phases != 2:
            text = "only a short circuit of two phases has a torque at twice the line frequency"
            faults.append(superfluous(text, "decay_double"))
        if self.pole_pairs is not None and self.angle is None:
            text = "only the torque of a faulty synchronisation follows the pole pairs"
            faults.append(superfluous(text, "pole_pairs"))
        if isinstance(self.angle, Number) and not 0 < abs(float(self.angle.value)) <= pi * ROUNDING:
            faults.append(Fault("the angle is from -180 deg to 180 deg, and not 0", ("angle",), kind="out-of-range"))
        if self.duration is not None and self.duration <= self.at:
            text = f"the scenario ends after {self.duration:g} s, and the fault comes at {self.at:g} s; simulate longer"
            faults.append(Fault(text, ("duration",), kind="needless-entry"))
        return faults

    @property
    def begins(self) -> str:
        return self.start or OPERATING_POINT

    @property
    def length(self) -> float:
        return self.duration or self.at + AFTERWARDS

    @property
    def what(self) -> str:
        """Fault of the scenario in words."""
        return (
            "faulty synchronisation"
            if self.phases is None
            else phrase("short circuit of {phases} phases", phases=self.phases)
        )

    @property
    def words(self) -> str:
        template = "short circuit of {phases} phases of {machine} at {time:g} s, simulated over {length:g} s"
        if self.phases is None:
            template = "faulty synchronisation of {machine} at {time:g} s, simulated over {length:g} s"
        return phrase(template, phases=self.phases, machine=self.machine, time=self.at, length=self.length)

    @property
    def needed(self) -> tuple[str, ...]:
        return (self.machine,)

    def name_faults(self, model: ScenarioSubject) -> list[Fault]:
        machine = machine_of(model, self.machine)
        if isinstance(machine, Fault):
            return [machine.under("machine")]
        faults = []
        if self.rated_torque is None and machine.torque is None:
            text = f"{self.machine} does not say which torque is 1 per unit; give rated_torque: 2.4 MN*m"
            faults.append(Fault(text, on_key=True, kind="missing-entry"))
        if self.frequency is None and machine.frequency is None:
            text = f"{self.machine} does not say the frequency of its line; give frequency: 50 Hz"
            faults.append(Fault(text, on_key=True, kind="missing-entry"))
        return faults if self.angle is None else [*faults, *self._grid_faults(model, machine)]

    def _grid_faults(self, model: ScenarioSubject, machine: FaultedMachine) -> list[Fault]:
        """Faults of a machine that cannot be synchronised."""
        for name, element in model.elements.items():
            if element.kind in TIED and getattr(element, "node", None) == machine.node and element.enabled:
                text = f"{name} is on the grid already, with its synchronising torque; put an inertia in its place"
                return [Fault(f"{text}, and give rated_torque and frequency", ("machine",), kind="missing-entry")]
        if self._frequency(model, machine) is not None and self._pairs(model, machine) is None:
            text = f"{self.machine} does not say its pole pairs, nor a speed that fits the line; give pole_pairs: 1"
            return [Fault(text, on_key=True, kind="missing-entry")]
        return []

    def _frequency(self, model: ScenarioSubject, machine: FaultedMachine) -> float | None:
        return machine.frequency if self.frequency is None else float(model.value(self.frequency))

    def _pairs(self, model: ScenarioSubject, machine: FaultedMachine) -> int | None:
        """Number of pole pairs, given, of the machine, or from its mean speed and the line frequency; else None."""
        if self.pole_pairs or machine.pole_pairs:
            return self.pole_pairs or machine.pole_pairs
        frequency, speed = self._frequency(model, machine), abs(machine.speed or 0.0)
        if not (frequency and speed):
            return None
        # p = omega / Omega, whole but for a slip.
        pairs = 2 * pi * frequency / speed
        return round(pairs) if abs(pairs - round(pairs)) < NEAR and round(pairs) else None

    def course(self, model: ScenarioSubject) -> DrivingCourse:
        from torsionnet.signals.recording import MotionEvent

        machine = machine_of(model, self.machine)
        if isinstance(machine, Fault):
            raise KeyError(self.machine)  # the checks have refused it
        rated = machine.torque if self.rated_torque is None else float(model.value(self.rated_torque))
        frequency = self._frequency(model, machine)
        if rated is None or frequency is None:
            raise KeyError(self.machine)
        sense = -1 if (machine.speed or 0.0) < 0 else 1
        history = self.torque(model.value, sense * rated, frequency)
        events, tie = (MotionEvent(self.at, self.machine, self.what),), None
        pairs = self._pairs(model, machine)
        if self.angle is not None and pairs is not None:
            # The largest synchronising torque is that of 1 per unit over x.
            most = rated / float(model.value(self.x) + model.value(self.x_external))
            tie = GridTie(
                self.machine, machine.place, self.at, float(model.value(self.angle)), sense * most, sense * pairs,
                frequency, machine.speed,
            )  # fmt: skip
        return DrivingCourse(added={machine.place: history}, tie=tie, events=events)

    def torque(self, value: Any, rated: float, frequency: float) -> TimeHistory:
        """Torque on the rotor over time in N m, from the rated torque in N m and the line frequency in Hz.

        That of a faulty synchronisation is the torque on a rotor that keeps its angle ahead of the grid.
        """
        omega, per_reactance = 2 * pi * frequency, 1.0 / float(value(self.x) + value(self.x_external))
        slow = 0.0 if self.decay is None else 1 / float(value(self.decay))
        quick = 0.0 if self.decay_double is None else 1 / float(value(self.decay_double))
        before = (HistoryPiece(0.0),) if self.at > 0 else ()
        if self.phases is None:
            half = float(value(self.angle)) / 2
            # sin(w t + delta) - sin(w t) = 2 sin(delta/2) cos(w t + delta/2)
            size = -rated * per_reactance * 2 * sin(half)
            waves: tuple[Wave, ...] = (
                Wave(complex(size * cos(half)), 0j),
                Wave(rect(-size, half), complex(-slow, omega)),
            )
        else:  # Re(-j e^(j omega t)) = sin(omega t)
            waves = (Wave(complex(0.0, rated * per_reactance), complex(-slow, omega)),)
            if self.phases == 2:
                waves += (Wave(complex(0.0, -rated * per_reactance / 2), complex(-quick, 2 * omega)),)
        return TimeHistory((*before, HistoryPiece(self.at, waves=waves)))


@dataclass(frozen=True)
class FaultedMachine:
    """Rotor and stator of a machine, and what it says of its rated torque in N m and its line frequency in Hz.

    ``speed`` is the mean speed of the rotor in rad/s.
    """

    node: str
    stator: str | None
    torque: float | None
    frequency: float | None
    pole_pairs: int | None = None
    speed: float | None = None

    @property
    def place(self) -> str:
        """Place of its torque, the node of the rotor, or rotor and stator as ``rotor-stator``."""
        return self.node if self.stator is None else f"{self.node}-{self.stator}"


def machine_of(model: ScenarioSubject, name: str) -> FaultedMachine | Fault:
    """Machine that a scenario names, an element on one rotor or an excitation of type electric_machine."""
    machine: Any = model.elements.get(name)
    if machine is None:
        machine = model.excitations.get(name)
        if machine is None or machine.kind != "electric_machine":
            if name in model.nodes:
                return Fault(f'"{name}" is a node; name the element on it that is the machine', kind="unknown-element")
            machines = [key for key, source in model.excitations.items() if source.kind == "electric_machine"]
            return unknown_name("machine", name, [*model.elements, *machines], ())
    node = getattr(machine, "node", None)
    if not isinstance(node, str):
        return Fault(
            f"{name} has no rotor on one node; name the element that is the rotor or the machine", kind="not-applicable"
        )
    if machine.kind not in ROTORS:
        kind = machine.kind.replace("_", " ")
        text = f"{name} is a {kind}, no electric machine; name one, or the inertia of its rotor"
        return Fault(text, kind="not-applicable")
    stator = next((part for key in ("stator", "housing") if (part := getattr(machine, key, None))), None)
    torque, frequency = _rating(machine, node, model)
    pairs, speed = getattr(machine, "pole_pairs", None), model.speeds.get(node)
    return FaultedMachine(node, None if stator == "ground" else stator, torque, frequency, pairs, speed)


def _rating(machine: Any, node: str, model: ScenarioSubject) -> tuple[float | None, float | None]:
    """Rated torque in N m and line frequency in Hz of a machine, each None where it does not say it."""

    def given(name: str) -> float | None:
        rating = getattr(machine, name, None)
        return float(model.value(rating)) if isinstance(rating, Expression) else rating

    if machine.kind == "grid_generator":
        power, speed = given("rated_power"), given("speed")
        return (power / speed if power and speed else None), given("grid_frequency")
    pairs, speed = getattr(machine, "pole_pairs", None), abs(model.speeds.get(node, 0.0))
    frequency = pairs * speed / (2 * pi) if pairs and speed else None
    return given("rated_torque"), frequency
