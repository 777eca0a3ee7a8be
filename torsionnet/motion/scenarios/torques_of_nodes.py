"""Scenario of torques over time on nodes, and of what scales the torques of elements."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import Named
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Json, Schema, Spec, entry, name_fault
from torsionnet.base.errors import EntryPath, Fault, TorsionnetError, unfit_word, unknown_name
from torsionnet.base.expressions import Expression
from torsionnet.base.phrases import extended, joined, phrase
from torsionnet.model.element_base.element_entries import ElementName
from torsionnet.model.elements import GROUND, Element, MotionLaw, Values
from torsionnet.model.operating_point import TorqueInput, place_fault, torque_place
from torsionnet.motion.scenarios.scenario import DrivingCourse, Scenario, ScenarioSubject, register_scenario
from torsionnet.motion.scenarios.time_history import Course, HistoryEntry, TimeHistory

_TORQUE = HistoryEntry("torque over time", "torque")
_TORQUES = Named(
    "torque over time by node",
    _TORQUE,
    refused=place_fault,
    form="{node: {0 s: 20 N*m, 50 ms: 250 N*m}}",
    keys=TorqueInput("a node, two nodes, or an input"),
)
_SCALE = HistoryEntry("what scales the torque of the element, over time")
_SCALES = Named(
    "what scales the torques of elements, over time, by element",
    Named("over time, by name", _SCALE, form="{clamp: {0 s: 0 N*m, 0.5 s: 300 N*m}}", fewest=1),
    refused=name_fault,
    form="{clutch: {clamp: {0 s: 0 N*m, 0.5 s: 300 N*m}}}",
    keys=ElementName("an element"),
)

NOTHING_SCALES = "nothing scales its torque; a clutch with state: slipping, friction and clamp_torque follows its clamp"


@register_scenario
@dataclass(frozen=True, kw_only=True)
class TorqueScenario(Scenario):
    """Torques over time on nodes, in place of the mean torques that act there, and what scales torques of elements.

    A torque is a constant, runs straight between rows ``{0 s: 20 N*m, 50 ms: 250 N*m}``, or is
    mean + amplitude cos(2 pi frequency t + phase). Mean torques of the operating point on other nodes go on acting
    where the scenario starts there; from rest only its own torques act. ``clutch: {clamp: {0 s: 0 N*m,
    0.5 s: 300 N*m}}`` gives what scales the torque of an element over time, as the clamp torque of a clutch.

    Examples
    --------
    >>> import torsionnet as tn
    >>> car = tn.Drivetrain("car", [tn.Inertia("engine", node="crank", inertia=0.25)])
    >>> tip_in = tn.TorqueScenario(duration="2 s", torque={"crank": {"0 s": "20 N*m", "50 ms": "250 N*m"}})
    >>> record = car.simulate("crank", scenario=tip_in, sampling_rate=40)
    >>> record["torque on crank"].values[:3].round(6).tolist()
    [20.0, 135.0, 250.0]
    """

    kind: ClassVar[str] = "torques"
    form: ClassVar[str] = "{type: torques, duration: 2 s, torque: {crank: {0 s: 20 N*m, 50 ms: 250 N*m}}}"

    duration: float = entry(Value("time that is simulated", "time", exclusive=True))
    torque: Mapping[str, Course] = entry(_TORQUES, None)
    elements: Mapping[str, Mapping[str, Course]] = entry(_SCALES, None)

    @classmethod
    def _own_keys(cls, raw: Mapping[Any, Any]) -> dict[Any, Any]:
        known = dict(cls.specs())
        return {key: given for key, given in raw.items() if key in known or not isinstance(given, Mapping)}

    @classmethod
    def read_entries(cls, raw: Mapping[Any, Any]) -> tuple[dict[str, Any], list[Fault]]:
        """Values of the entries that could be read, by name, and every fault; other tables are those of elements."""
        own = cls._own_keys(raw)
        values, faults = super().read_entries(own)
        scaled, scale_faults = _SCALES.read({key: given for key, given in raw.items() if key not in own})
        if scaled or values.get("elements"):
            values["elements"] = {**(values.get("elements") or {}), **scaled}
        return values, [*faults, *scale_faults]

    @classmethod
    def entry_specs(cls, raw: Mapping[Any, Any]) -> Mapping[Any, Spec[Any]]:
        scaled = {key: _SCALES.of for key in raw if key not in cls._own_keys(raw)}
        return {**super().entry_specs(raw), **scaled}

    @classmethod
    def key_names(cls, raw: Mapping[Any, Any]) -> Mapping[Any, Spec[Any]]:
        own = cls._own_keys(raw)
        return _SCALES.key_names({key: given for key, given in raw.items() if key not in own})

    def contradictions(self) -> list[Fault]:
        if self.torque or self.elements:
            return []
        return [
            Fault(
                "a scenario of torques needs torque: {crank: {0 s: 20 N*m, 50 ms: 250 N*m}}",
                on_key=True,
                kind="missing-entry",
            )
        ]

    @property
    def length(self) -> float:
        return self.duration

    @property
    def words(self) -> str:
        clamp = "clamp of {element}"
        scales = [
            phrase(clamp if what == "clamp" else f"{what} of {{element}}", element=element)
            for element, scaled in self.elements.items()
            for what in scaled
        ]
        places, length = ", ".join(self.torque), f"{self.duration:g}"
        if not places:
            return extended(joined(" and ", scales) if scales[1:] else scales[0], f" over {length} s")
        template = "torque on {places} and {scales} over {length} s" if scales else "torque on {places} over {length} s"
        return phrase(template, places=places, scales=joined(" and ", scales), length=length)

    @property
    def places(self) -> tuple[str, ...]:
        return tuple(node for place in self.torque for node in torque_place(place).nodes)

    @property
    def needed(self) -> tuple[str, ...]:
        return tuple(self.elements)

    def expressions(self) -> Iterator[tuple[EntryPath, Spec[object], Expression, str]]:
        for place, course in self.torque.items():
            for path, expression, dimension in _TORQUE.expressions(course):
                yield ("torque", place, *path), _TORQUE.of, expression, dimension
        for element, table in self.elements.items():
            for what, course in table.items():
                for path, expression, dimension in _SCALE.expressions(course):
                    yield (element, what, *path), _SCALE.of, expression, dimension

    def name_faults(self, model: ScenarioSubject) -> list[Fault]:
        faults = []
        for place in self.torque:
            if place in model.inputs:
                if model.inputs[place].quantity != "torque":
                    text = f"{place} imposes an {model.inputs[place].quantity}; a scenario gives torques"
                    faults.append(Fault(text, ("torque", place), on_key=True, kind="unfit-channel"))
                continue
            named = torque_place(place).nodes
            for node in named:
                if node == GROUND and len(named) == 1:
                    faults.append(
                        Fault("ground does not move; name a node", ("torque", place), on_key=True, kind="grounded-node")
                    )
                elif node not in model.nodes and node != GROUND:
                    known = [*model.nodes, *model.inputs]
                    faults.append(unknown_name("node", node, known, ("torque", place), on_key=True))
        for name, table in self.elements.items():
            element = model.elements.get(name)
            if element is None:
                known = [*model.elements, *(key for key, _ in self.specs())]
                faults.append(unknown_name("element", name, known, (name,), on_key=True))
                continue
            scales = scaled_names(element, model.value)
            for what in table:
                if what not in scales:
                    rest = f"{name} is scaled by {', '.join(scales)}" if scales else NOTHING_SCALES
                    text = f'the torque of {name} does not follow "{what}"'
                    faults.append(unfit_word(text, what, scales, (name, what), rest, on_key=True))
        return faults

    def histories(self, value: Values) -> dict[str, TimeHistory]:
        """Torques over time by node, with values of the parameters."""
        return {place: history.history(value) for place, history in self.torque.items()}

    def course(self, model: ScenarioSubject) -> DrivingCourse:
        scales = {
            (element, what): history.history(model.value)
            for element, table in self.elements.items()
            for what, history in table.items()
        }
        return DrivingCourse(torques=self.histories(model.value), scales=scales)

    def to_data(self) -> Json:
        """Plain data that describe the scenario in a file, with tables of elements under their names."""
        data = dict(self.written_entries())
        scaled = data.pop("elements", None) or {}
        keys = dict(self.specs())
        if isinstance(scaled, Mapping) and any(name in keys for name in scaled):
            return {**data, "elements": scaled}
        return {**data, **scaled} if isinstance(scaled, Mapping) else data

    @classmethod
    def schema(cls, *, type_key: str = "") -> Schema:
        """JSON Schema of the scenario, in which any other key is an element with what scales its torque."""
        schema = super().schema(type_key=type_key)
        return {**schema, "additionalProperties": _SCALES.of.schema()}


def scaled_names(element: Element, value: Values) -> tuple[str, ...]:
    """Names of what scales the torques of an element's laws of motion, as ``clamp``."""
    try:
        parts = element.whole_parts(value)
    except (ArithmeticError, KeyError, TorsionnetError):  # other checks say what its values lack
        return ()
    return tuple(dict.fromkeys(law.scaled_by for law in parts if isinstance(law, MotionLaw) and law.scaled_by))
