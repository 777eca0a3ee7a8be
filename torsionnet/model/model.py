"""Immutable model of a drivetrain: elements between nodes, parameters, inputs, sensors, configurations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any, Self

from torsionnet.base.errors import Fault, ModelError, unknown_name
from torsionnet.base.packages import ArgumentHints, imported
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.configurations import (
    Overlay,
    combinations,
    known_elements,
    label,
    other_configurations,
    parse_choice,
    read_overrides,
)
from torsionnet.model.defining import (
    check_definition,
    check_variant,
    collect_elements,
    define,
    flatten_definition,
    has_errors,
)
from torsionnet.model.definition import Definition, all_nodes, with_operating_values, with_tangents
from torsionnet.model.elements import Element
from torsionnet.model.load.external_torques import ExternalTorques, mean_torques
from torsionnet.model.operating_point import OperatingPoint
from torsionnet.model.parameters import Parameter, resolve
from torsionnet.model.sections import EXCITATION_NUMBERS
from torsionnet.model.speeds import mean_speeds, total_ratio


class Shared:
    """Latest assembly of a model and its changed copies, which another one takes equal rows from."""

    assembly: Any = None


@dataclass(frozen=True)
class ModelState:
    """Definition of a model as it is used, and what it came from.

    Attributes
    ----------
    definition : Definition
        With the chosen alternatives and changes, at the operating point.
    base : Definition
        As the author wrote it.
    choice : mapping
        Alternative that was chosen, by axis.
    changes : Overlay
        Other changes of the base.
    findings : tuple of Fault
        Warnings and notes of the checks.
    shared : Shared
        What the model has in common with its changed copies.
    """

    definition: Definition
    base: Definition
    choice: Mapping[str, str] = field(default_factory=dict)
    changes: Overlay = field(default_factory=Overlay)
    findings: tuple[Fault, ...] = ()
    shared: Shared = field(default_factory=Shared, compare=False)


def _operated(definition: Definition) -> Definition:
    """Definition of a model with the parameter values, and tangents of laws of motion, at its own operating point."""
    if not definition.following:
        return with_tangents(definition)
    from torsionnet.model.operating_values import at_operating_point

    return at_operating_point(definition)


class Model(ArgumentHints):
    """Model of a drivetrain in one of its configurations; every method that changes something returns a copy."""

    def __init__(
        self,
        name: str,
        elements: Iterable[Element],
        parameters: Mapping[str, Any] | None = None,
        inputs: Mapping[str, Any] | None = None,
        sensors: Mapping[str, Any] | None = None,
        configurations: Mapping[str, Any] | None = None,
        operating_point: Mapping[str, Any] | OperatingPoint | None = None,
        speeds: Mapping[str, Any] | None = None,
        load: Mapping[str, Any] | None = None,
        excitations: Mapping[str, Any] | None = None,
        limits: Mapping[str, Any] | None = None,
        source: str = "",
        description: str = "",
        ports: Iterable[str] = (),
        parts: Mapping[str, Any] | None = None,
        use: Mapping[str, Any] | None = None,
        scenarios: Mapping[str, Any] | None = None,
    ) -> None:
        table, faults = collect_elements(elements) if elements or not use else ({}, [])
        definition, unfit = define(
            {
                "name": name,
                "elements": table,
                "parameters": parameters,
                "inputs": inputs,
                "sensors": sensors,
                "configurations": configurations,
                "operating_point": operating_point,
                "speeds": speeds,
                "load": load,
                "excitations": excitations,
                "limits": limits,
                "scenarios": scenarios,
                "source": source,
                "description": description,
                "ports": ports if isinstance(ports, str) else tuple(ports),
                "parts": {name: as_part(part) for name, part in (parts or {}).items()} or None,
                "use": use,
            }
        )
        if not table and not use:  # which has been said in the words of a call
            unfit = [fault for fault in unfit if fault.about != "elements"]
        faults += unfit + check_definition(definition)
        _refuse(faults, name)
        self._state = ModelState(_operated(definition), definition, findings=tuple(faults))

    @classmethod
    def from_definition(cls, definition: Definition, findings: Iterable[Fault] = ()) -> Self:
        """Model made of a checked definition."""
        return cls._of(ModelState(_operated(definition), definition, findings=tuple(findings)))

    @classmethod
    def _of(cls, state: ModelState) -> Self:
        """Model in a state whose definition has been checked, without the reading and checking of the constructor."""
        made = object.__new__(cls)
        made._state = state
        return made

    def with_definition(self, definition: Definition) -> Self:
        """Model made of another definition, in no configuration and with the parameter values as written."""
        return self._of(ModelState(definition, definition))

    def _changed(self, choice: Mapping[str, str], changes: Overlay) -> Self:
        """Model of the base with the chosen alternatives in the order of the axes, and then the other changes."""
        definition = self._state.base
        chosen = {axis: choice[axis] for axis in definition.configurations if axis in choice}
        for axis, alternative in chosen.items():
            definition = definition.with_overlay(self._state.base.configurations[axis][alternative])
        definition = definition.with_overlay(changes)
        faults = check_variant(definition)
        _refuse(faults, label(chosen, definition.configurations) or self.name)
        used = _operated(definition)
        return self._of(replace(self._state, definition=used, choice=chosen, changes=changes, findings=tuple(faults)))

    @property
    def definition(self) -> Definition:
        """Definition of the model, the typed content of its file."""
        return self._state.definition

    @property
    def name(self) -> str:
        return self.definition.name

    @property
    def source(self) -> str:
        """Text on the source of the model's numbers, as its file states it."""
        return self.definition.source

    @property
    def description(self) -> str:
        return self.definition.description

    @cached_property
    def elements(self) -> Mapping[str, Element]:
        """Elements of the model that are switched on, by name, in the order of declaration."""
        return MappingProxyType({element.name: element for element in self.definition.active})

    @cached_property
    def nodes(self) -> tuple[str, ...]:
        """Names of the model's nodes in the order of their first mention, without ground."""
        return all_nodes(self.definition.switched_on)

    @property
    def inputs(self) -> Mapping[str, Input]:
        """Inputs of the model, torques and imposed motions, by name."""
        return MappingProxyType(dict(self.definition.inputs))

    @property
    def sensors(self) -> Mapping[str, Sensor]:
        """Sensors of the model, each with the quantity it measures, by name."""
        return MappingProxyType(dict(self.definition.sensors))

    @cached_property
    def parameters(self) -> Mapping[str, float]:
        """Value in SI of every parameter, by name."""
        return MappingProxyType({name: float(value) for name, value in self.exact_values.items()})

    @property
    def parameter_definitions(self) -> Mapping[str, Parameter]:
        """Parameters of the model as written, by name: expression, unit, description, bounds."""
        return MappingProxyType(dict(self.definition.parameters))

    @cached_property
    def exact_values(self) -> Mapping[str, Any]:
        """Value in SI of every parameter, by name, exact where possible.

        A Fraction unless a root or pi was involved.
        """
        return MappingProxyType(resolve(self.definition.parameters)[0])

    @property
    def axes(self) -> Mapping[str, tuple[str, ...]]:
        """Names of the alternatives on each axis of configurations, by axis."""
        return MappingProxyType({axis: tuple(names) for axis, names in self.definition.configurations.items()})

    @property
    def configurations(self) -> tuple[str, ...]:
        """Names of the configurations that the model has.

        With several axes every combination, as ``gear=V,clutch=open``.
        """
        axes = self.definition.configurations
        return tuple(label(choice, axes) for choice in combinations(axes) if choice)

    @property
    def configuration(self) -> str:
        """Name of the configuration chosen with :meth:`configured`, or an empty string."""
        return label(self._state.choice, self.definition.configurations) if self._state.choice else ""

    @property
    def other_configurations(self) -> tuple[str, ...]:
        """Names of all configurations of the model but the present one.

        An alternative without changes is the model as written.

        Examples
        --------
        >>> import torsionnet as tn
        >>> rig = tn.load("amt_rig")
        >>> rig.configurations, rig.configured("V").other_configurations
        (('II', 'III', 'IV', 'V', 'V_c_O_360'), ('II', 'III', 'IV', 'V_c_O_360'))
        """
        return other_configurations(self._state.choice, self.definition.configurations)

    @property
    def title(self) -> str:
        """Title of the model with its name and configuration."""
        return f"{self.name} ({self.configuration})" if self._state.choice else self.name

    def configured(self, name: str = "", /, **overrides: Any) -> Self:
        """Copy of the model in a named configuration and with other parameter values.

        Parameters
        ----------
        name : str
            ``"V"``, or ``"gear=V,clutch=open"`` where there are several axes. Axes not named keep their state; on
            an axis named again the new alternative takes the place of the old one.
        **overrides
            Parameter values: SI numbers, quantities or expressions. A derived parameter given here loses its
            expression, and everything derived from it follows the new value. What is given here holds against every
            configuration, also one chosen later. Entries of the operating point and the size of the load are given
            like parameters, as ``**{"operating_point.torque.crank": "200 N*m"}`` or ``**{"load.power": "2 MW"}``.

        Raises
        ------
        UsageError
            No such configuration or parameter.
        ModelError
            A value that is impossible.

        Examples
        --------
        >>> import torsionnet as tn
        >>> tn.load("amt_rig").configured("V", c_O=360).parameters["c_O"]
        360.0
        """
        choice = dict(self._state.choice)
        if name:
            choice |= parse_choice(name, self._state.base.configurations)
        if not overrides:
            if name not in self._configured:
                self._configured[name] = self._changed(choice, self._state.changes)
            return self._configured[name]
        from torsionnet.model.changes import is_point_setting, with_point_settings

        settings = (key for key in overrides if key not in self._state.base.parameters and is_point_setting(key))
        own = {key: overrides.pop(key) for key in tuple(settings)}
        values = read_overrides(overrides, self._state.base.parameters, self._state.base.configurations)
        changes = replace(self._state.changes, parameters={**self._state.changes.parameters, **values})
        changes = with_point_settings(changes, own, self._state.base)
        if own:
            self._require_places(changes.at or changes.operating_point)
        return self._changed(choice, changes)

    @cached_property
    def _configured(self) -> dict[str, Self]:
        """Copies in configurations by the names asked for, checked once."""
        return {}

    def as_written(self) -> Self:
        """Copy of the model in no configuration, with the parameter values that were given beside it."""
        return self._changed({}, self._state.changes)

    def with_entries_named(self, names: Iterable[str]) -> Self:
        """Copy of the model in which values of elements are parameters, so that they can vary as these do.

        Parameters
        ----------
        names : iterable of str
            ``"dmf.stiffness"`` and so on; names that are no plain values of elements are left out.

        Examples
        --------
        >>> import torsionnet as tn
        >>> chain = tn.Drivetrain("chain", [tn.Inertia("disc", node="end", inertia=0.2),
        ...     tn.Spring("shaft", nodes=("end", "ground"), stiffness="1.2 kN*m/rad")])
        >>> chain.with_entries_named(["shaft.stiffness"]).configured(**{"shaft.stiffness": 900}).parameters
        mappingproxy({'shaft.stiffness': 900.0})
        """
        from torsionnet.model.changes import can_be_named, with_named_entries

        fitting = [name for name in names if can_be_named(self._state.base, name)]
        if not fitting:
            return self
        return self._as_chosen(self.with_definition(with_tangents(with_named_entries(self._state.base, fitting))))

    def with_excitation_numbers(self, values: Mapping[str, float]) -> Self:
        """Copy of the model with other numbers in its excitations, in SI units.

        Parameters
        ----------
        values : mapping
            Place of a number -> value in SI: ``"engine.misfire_share.4"``, ``"propeller.blade_orders.1.share"``.
            Configurations that change the same entries still do.

        Raises
        ------
        UsageError
            An excitation has no such number, or there is no such excitation.

        Examples
        --------
        >>> import torsionnet as tn
        >>> model = tn.load("engine_generator_set").with_excitation_numbers({"engine.misfire_share.4": 0.3})
        >>> model.definition.excitations["engine"].misfire_share
        {'4': 0.3}
        """
        changed = imported(EXCITATION_NUMBERS)(self._state.base.excitations, values)
        return self._as_chosen(self.with_definition(with_tangents(replace(self._state.base, excitations=changed))))

    def with_part(
        self,
        name: str,
        part: Model | str,
        *,
        at: Mapping[str, Any],
        parameters: Mapping[str, Any] | None = None,
        repeat: int | None = None,
        chain: tuple[str, str] | None = None,
    ) -> Self:
        """Copy of the model with a part put in; everything the part holds has ``name.`` before its own name.

        Parameters
        ----------
        name : str
            With ``repeat`` the copies are ``name1``, ``name2``, ...
        part : Drivetrain or str
            A model with ports, or the name of a part that this model has already.
        at : mapping
            Port -> node of this model; a list of nodes has one for each copy.
        parameters : mapping, optional
            Parameter of the part -> value, an expression of this model's parameters, or a list with one for each copy.
        repeat : int, optional
            How many copies.
        chain : (str, str), optional
            Ports (front, rear): the rear of each copy is the front of the next.

        Raises
        ------
        ModelError
            A port that is not joined, a parameter or a port that the part has not, a name that is taken, ...

        Examples
        --------
        >>> import torsionnet as tn
        >>> shaft = tn.Drivetrain("half shaft", [tn.Spring("shaft", nodes=("inner", "hub"), stiffness="k"),
        ...     tn.Inertia("wheel", node="hub", inertia=0.9)], parameters={"k": 9000}, ports=["inner"])
        >>> axle = tn.Drivetrain("axle", [tn.Inertia("cage", node="cage", inertia=0.03)])
        >>> axle = axle.with_part("left", shaft, at={"inner": "cage"})
        >>> axle = axle.with_part("right", shaft, at={"inner": "cage"}, parameters={"k": "6.1 kN*m/rad"})
        >>> list(axle.elements), axle.parameters["right.k"]
        (['cage', 'left.shaft', 'left.wheel', 'right.shaft', 'right.wheel'], 6100.0)
        """
        use: dict[str, Any] = {"at": at, "parameters": parameters, "repeat": repeat, "chain": chain}
        use = {key: value for key, value in use.items() if value is not None}
        use["part"] = part if isinstance(part, str) else ""
        given = None if isinstance(part, str) else part.definition
        from torsionnet.model.parts.authored_model import with_use

        authored, faults = with_use(self._state.base, name, use, given)
        # Names in the part get "name." before them.
        definition, unfit = flatten_definition(authored)
        _refuse(faults := [*faults, *unfit], self.name)
        _refuse(faults := [*faults, *check_definition(definition)], self.name)
        whole = self.from_definition(definition, faults)
        return self._as_chosen(whole)

    def _as_chosen(self, whole: Self) -> Self:
        """Model ``whole`` in the configuration of this model, with the changes that were made to this model."""
        if not self._state.choice and self._state.changes == Overlay():
            return whole
        from torsionnet.model.changes import point_settings_of

        choice = ",".join(f"{axis}={alternative}" for axis, alternative in self._state.choice.items())
        chosen = whole.configured(choice, **self._state.changes.parameters, **point_settings_of(self._state.changes))
        chosen = chosen.switched(on=self._state.changes.on, off=self._state.changes.off)
        at = self._state.changes.at
        return chosen if at is None else chosen.at_point(at)

    def switched(self, *, on: Iterable[str] = (), off: Iterable[str] = ()) -> Self:
        """Copy of the model with elements switched on or off by name, whatever its configuration says."""
        states = dict.fromkeys(self._state.changes.on, True) | dict.fromkeys(self._state.changes.off, False)
        states |= dict.fromkeys(known_elements(on, self._state.base.elements), True)
        states |= dict.fromkeys(known_elements(off, self._state.base.elements), False)
        lists = {word: tuple(name for name in states if states[name] is (word == "on")) for word in ("on", "off")}
        return self._changed(self._state.choice, replace(self._state.changes, on=lists["on"], off=lists["off"]))

    def at_point(self, point: OperatingPoint) -> Self:
        """Copy of the model at an operating point in place of its own and, if that has torques, of its load.

        It holds against every configuration, also one chosen later.

        Raises
        ------
        ModelError
            Nodes that do not exist, or a place of a torque that is none.
        """
        self._require_places(point)
        return self._changed(self._state.choice, replace(self._state.changes, at=point))

    def _require_places(self, point: OperatingPoint | None) -> None:
        """Refuse an operating point with nodes that the model does not have."""
        known = all_nodes(self._state.base.elements.values())
        faults = (
            [
                unknown_name("node", node, known, ("operating_point", entry, node), on_key=True)
                for entry, nodes in (("speed", point.speed), ("torque", point.loaded_nodes))
                for node in nodes
                if node not in known
            ]
            if point
            else []
        )
        _refuse(faults, self.name)

    def with_operating_values(self, values: Mapping[str, float], speed: float | None = None) -> Self:
        """Copy of the model at another operating point, with these values in SI of the parameters that follow it.

        ``speed`` in rad/s is that of the reference node of the load, at which laws of motion are linear.
        """
        definition = with_operating_values(self.definition, values)
        if speed is not None or (values and definition.tangents is not None):
            definition = with_tangents(definition, speed)
        return self._of(replace(self._state, definition=definition))

    def check(self) -> tuple[Fault, ...]:
        """Warnings and notes about the model (errors have already been refused)."""
        return self._state.findings

    def ratio_between(self, first: str, second: str) -> float:
        """Ratio of the mean speed of node ``first`` to the mean speed of node ``second``.

        Examples
        --------
        >>> import torsionnet as tn
        >>> tn.load("amt_rig").configured("V").ratio_between("motor", "hub")
        3.26
        """
        return float(total_ratio(self.definition, self.exact_values, first, second))

    @cached_property
    def external_torques(self) -> ExternalTorques:
        """Mean external torques over speed on the model, with the speed ratios that they need."""
        return ExternalTorques(self.definition, self.exact_values)

    @cached_property
    def mean_speeds(self) -> Mapping[str, float]:
        """Mean speed in rad/s of every node that the operating point determines, by node."""
        return MappingProxyType(mean_speeds(self.definition, self.exact_values))

    @cached_property
    def mean_torques(self) -> Mapping[str, float]:
        """Mean external torque in N m on the model, by node.

        Of the load at the speed of the operating point, else as given there.
        """
        return MappingProxyType(mean_torques(self.external_torques))

    _state: ModelState

    def __reduce__(self) -> tuple[Callable[[ModelState], Self], tuple[ModelState]]:
        """Constructor of a pickled or copied model, and its state: the definition and changes, without results."""
        return self._of, (self._state,)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Model):
            return NotImplemented
        return self.definition.flat_data() == other.definition.flat_data()

    def __hash__(self) -> int:
        return hash((self.name, tuple(self.definition.elements)))

    def __repr__(self) -> str:
        counts = f"{len(self.elements)} elements, {len(self.nodes)} nodes, {len(self.parameters)} parameters"
        return (
            f"<{type(self).__name__} {self.name!r}: {counts}{f', {self.configuration}' if self._state.choice else ''}>"
        )


def as_part(model: Any) -> Any:
    """Part made of a model with ports, to be put into another model; other objects are returned unchanged."""
    if not isinstance(model, Model):
        return model
    from torsionnet.model.parts.authored_model import part_of

    return part_of(model.definition)[0]


def _refuse(faults: Iterable[Fault], title: str) -> None:
    errors = [fault for fault in faults if fault.severity == "error"]
    if errors and has_errors(errors):
        raise ModelError(errors, title if isinstance(title, str) and title else "the model")
