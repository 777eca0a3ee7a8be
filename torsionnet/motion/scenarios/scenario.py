"""Base class and register of scenarios, and what a scenario does to a model over time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, TypeVar

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import OneOf, Spec, entry
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.expressions import Expression
from torsionnet.base.registers import TypeRegister
from torsionnet.model.elements import Values
from torsionnet.signals.motion_event import MotionEvent

if TYPE_CHECKING:
    from torsionnet.base.entries.declared import Declared as Excitation
    from torsionnet.model.channels import Input
    from torsionnet.model.elements import Element
    from torsionnet.motion.scenarios.grid_tie import GridTie
    from torsionnet.motion.scenarios.time_history import TimeHistory

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
