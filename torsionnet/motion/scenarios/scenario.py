"""Base class and register of scenarios, and what a scenario does to a model over time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import cos, pi, sin
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import OneOf, Spec, entry
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.expressions import Expression
from torsionnet.base.registers import TypeRegister
from torsionnet.model.element_base.laws import MotionState, TorqueCurve
from torsionnet.model.elements import Values
from torsionnet.motion.scenarios.time_history import HistoryPiece, TimeHistory, Wave, first_sample

if TYPE_CHECKING:
    from torsionnet.base.entries.declared import Declared as Excitation
    from torsionnet.model.channels import Input
    from torsionnet.model.elements import Element
    from torsionnet.signals.recording import MotionEvent


S = TypeVar("S", bound="type[Scenario]")
REST, OPERATING_POINT = "rest", "operating_point"
RATE = Value("samples a second; default: 100 in the shortest period of vibration", "frequency", exclusive=True)
STARTS = (REST, OPERATING_POINT)
"""States in which a scenario may begin."""


@dataclass(frozen=True)
class ScenarioSubject:
    """Nodes, elements, inputs and excitations that a scenario may name, with the values of the parameters.

    Attributes
    ----------
    nodes : tuple of str
    elements, inputs, excitations : mapping
        By name.
    value : Values
        Values of the parameters.
    speeds : mapping
        Node -> mean speed in rad/s, of the nodes whose speed is known.
    """

    nodes: tuple[str, ...]
    elements: Mapping[str, Element]
    inputs: Mapping[str, Input]
    excitations: Mapping[str, Excitation]
    value: Values
    speeds: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class DrivingCourse:
    """Course of what a scenario does to a model over time.

    Attributes
    ----------
    torques : mapping
        Node, two nodes as ``pulley-block``, or input -> torque in N m, in place of the mean torque there.
    added : mapping
        Such a place -> torque in N m on top of what acts there.
    scales : mapping
        Element and name of what scales its torque, as ``("clutch", "clamp")`` -> its value in SI.
    tie : GridTie or None
        Torque of a grid, which follows a motion.
    events : tuple of MotionEvent
        Beginnings of what the scenario does, as a short circuit.
    """

    torques: Mapping[str, TimeHistory] = field(default_factory=dict)
    added: Mapping[str, TimeHistory] = field(default_factory=dict)
    scales: Mapping[tuple[str, str], TimeHistory] = field(default_factory=dict)
    tie: GridTie | None = None
    events: tuple[MotionEvent, ...] = ()

    @property
    def in_full(self) -> bool:
        """Whether the course asks for laws of motion in full: it scales some, or adds that of a grid."""
        return bool(self.scales) or self.tie is not None


@dataclass(frozen=True, kw_only=True)
class Scenario(Declared):
    """Base class of scenarios; each ``type:`` is a subclass registered by :func:`register_scenario`."""

    article: ClassVar[str] = "a scenario"

    duration: float | None = entry(Value("time that is simulated", "time", exclusive=True), None)
    rate: float | None = entry(RATE, None)
    start: str | None = entry(OneOf("state in which it begins", STARTS), None)

    common: ClassVar[tuple[str, ...]] = ("duration", "rate", "start")

    @property
    def begins(self) -> str:
        """State in which the scenario begins, ``rest`` or ``operating_point``."""
        return self.start or REST

    @property
    def length(self) -> float:
        """Time in s that is simulated."""
        raise NotImplementedError

    @property
    def words(self) -> str:
        """Scenario in words, with names of the model in them."""
        raise NotImplementedError

    def expressions(self) -> Iterator[tuple[EntryPath, Spec[object], Expression, str]]:
        """Yield path, specification, expression and dimension name of every expression in the scenario's entries."""
        for name, spec in self.specs():
            value = getattr(self, name)
            if value is not None:
                for path, expression, dimension in spec.expressions(value):
                    yield (name, *path), spec, expression, dimension

    @property
    def places(self) -> tuple[str, ...]:
        """Names of the nodes that the scenario names."""
        return ()

    @property
    def needed(self) -> tuple[str, ...]:
        """Names of the elements or excitations without which the scenario makes no sense."""
        return ()

    def name_faults(self, model: ScenarioSubject) -> list[Fault]:
        """Faults of entries that name what the model does not have, or that lack data of it."""
        raise NotImplementedError

    def course(self, model: ScenarioSubject) -> DrivingCourse:
        """Course over time of what the scenario does to a model."""
        raise NotImplementedError


SCENARIOS: TypeRegister[type[Scenario]] = TypeRegister(
    "torsionnet.motion.scenarios", {"torques_of_nodes": ("torques",)}
)
"""Classes of scenarios by the word that a model file writes as their ``type``."""


def register_scenario(cls: S) -> S:
    """Class decorator that registers a scenario type under its ``kind``."""
    SCENARIOS[cls.kind] = cls
    return cls


def scenario_kinds() -> Mapping[str, type[Scenario]]:
    """Class of every registered kind of scenario, by the word in ``type:``."""
    return SCENARIOS


# Change of the synchronising torque with the angle of the rotor, of a machine that a scenario connects to the grid.

if TYPE_CHECKING:
    import numpy as np  # reading and checking a model file does without
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

STANDING = 1e-9
"""Share of the speed of the grid below which a speed is rounding."""


@dataclass(frozen=True)
class GridTie:
    """Torque T_s (sin(delta + p (theta - Omega t)) - sin(delta)) against the rotation of a rotor on the grid.

    It acts on top of T_s sin(delta), and begins at zero: theta - Omega t counts from the connection. Where the machine
    turns backwards, ``torque`` and ``pole_pairs`` are negative.

    Attributes
    ----------
    machine, place : str
        Name of the machine, and rotor, or rotor and stator, between which the torque acts.
    at : float
        Time of the connection in s.
    angle : float
        delta, electrical angle in rad of the rotor ahead of the grid at that time.
    torque : float
        T_s in N m.
    pole_pairs : int
    frequency : float
        Line frequency in Hz.
    speed : float or None
        Mean speed of the rotor in rad/s, from which a motion counts that begins without speed; None: that of the grid.
    """

    machine: str
    place: str
    at: float
    angle: float
    torque: float
    pole_pairs: int
    frequency: float
    speed: float | None = None

    def slip(self, first: float) -> float:
        """Electrical speed in rad/s against the grid of what the rotor's angle counts from, by its speed at the start.

        A speed at the start counts from zero, and a rotor without one from its mean speed, or from that of the grid.
        """
        counted = self.speed if abs(self.pole_pairs * first) < STANDING * 2 * pi * self.frequency else 0.0
        return 0.0 if counted is None else self.pole_pairs * counted - 2 * pi * self.frequency

    def words(self, first: float) -> str:
        """Note on how the rotor turns against the grid at the start, by its speed there in rad/s."""
        ahead = (self.slip(first) + self.pole_pairs * first) / (2 * pi * self.frequency)
        if abs(ahead) < STANDING:
            return f"{self.machine} begins at the speed of the grid"
        return f"{self.machine} begins {abs(100 * ahead):.3g} % {'faster' if ahead > 0 else 'slower'} than the grid"

    def laws(self, twist: float, slip: float) -> tuple[tuple[TorqueCurve, TimeHistory], ...]:
        """Curves over the mechanical angle with what scales them over time, from the angle in rad at the connection.

        sin(a + slip t) = sin(a) cos(slip t) + cos(a) sin(slip t), with a = delta + p (theta - twist); then -sin(delta).
        """
        phase = self.angle - self.pole_pairs * twist
        cosine = (TurningField(self.torque, self.pole_pairs, phase), self._from_then_on(1, slip))
        sine = (TurningField(self.torque, self.pole_pairs, phase + pi / 2), self._from_then_on(-1j, slip))
        constant = (TurningField(self.torque, 0, -self.angle), self._from_then_on(1, 0.0))
        return (cosine, sine, constant) if slip else (cosine, constant)

    def _from_then_on(self, amplitude: complex, slip: float) -> TimeHistory:
        before = (HistoryPiece(0.0),) if self.at > 0 else ()
        return TimeHistory((*before, HistoryPiece(self.at, waves=(Wave(amplitude, complex(0, slip)),))))

    def samples(self, twists: FloatArray, twist: float, slip: float, rate: float) -> FloatArray:
        """Torque (n,) in N m on the rotor at samples at ``rate`` Hz, from the mechanical angles (n,) there."""
        import numpy as np

        times = np.arange(len(twists)) / rate - self.at
        angles = self.angle + self.pole_pairs * (twists - twist) + slip * times
        torque = -self.torque * (np.sin(angles) - sin(self.angle))
        torque[: first_sample(self.at, rate)] = 0.0
        return np.asarray(torque)


@dataclass(frozen=True)
class TurningField(TorqueCurve):
    """Torque T_s sin(p gamma + phase) over the mechanical angle gamma, of a grid that is no part of the drivetrain.

    It has no energy of its own: what it gives is supplied from outside.
    """

    over = "twist"

    field_torque: float
    pole_pairs: int
    phase: float

    def torque(self, twist: Any, rate: Any, *sensed: Any) -> Any:
        del rate, sensed
        return self.field_torque * sin(self.pole_pairs * twist + self.phase)

    def energy(self, twist: Any) -> Any:
        del twist
        return 0.0

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        return self.pole_pairs * self.field_torque * cos(self.pole_pairs * state.twist + self.phase), 0.0
