"""The drivetrain: elements between nodes, with parameters, inputs, sensors and configurations. It never changes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from torsionnet.channels import Input, Sensor
from torsionnet.checks import check_definition, check_variant, has_errors
from torsionnet.configurations import Overlay, combinations, known_elements, label, parse_choice, read_overrides
from torsionnet.definition import Definition, all_nodes, collect_elements, define
from torsionnet.elements import Element
from torsionnet.errors import Fault, ModelError
from torsionnet.operating_point import OperatingPoint
from torsionnet.parameters import Parameter, resolve
from torsionnet.speeds import mean_speeds, mean_torques, total_ratio

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import TypeAlias

    import control
    import networkx as nx
    from numpy.typing import ArrayLike

    from torsionnet.assembly.system import Assembly
    from torsionnet.response import FrequencyResponse, FrequencyResponses, Modes
    from torsionnet.signals.recording import Recording
    from torsionnet.solve.grid import Adaptive
    from torsionnet.symbolics.system import SymbolicSystem

    Channels: TypeAlias = str | Sensor | Sequence[str | Sensor]


class Drivetrain:
    """A torsional model; every method that changes something returns a changed copy.

    Parameters
    ----------
    name : str
        Title of the model.
    elements : iterable of Element
        In the order of declaration, which fixes the order of nodes and, where nothing else is said, of coordinates.
    parameters : mapping, optional
        Name -> number in SI, text with unit, or expression of other parameters.
    inputs, sensors : mapping, optional
        Name -> ``{"torque": node}``, ``{"angle": node}``; ``{"angle": node}``, ``{"torque": element, "at": node}``, ...
        A node whose angle is imposed by an input stands still wherever that input is not the excitation.
    configurations : mapping, optional
        Axis -> alternative -> ``{parameter: value, "on": [...], "off": [...]}``; one axis needs no name.
    operating_point : mapping, optional
        ``{"speed": {node: value}, "torque": {node: value}}``.
    source, description : str, optional
        Where the numbers come from, and what the model is.

    Raises
    ------
    ModelError
        With every fault of the model.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.Drivetrain("one mass", [tn.Inertia("rotor", node="a", inertia=0.152),
    ...     tn.Spring("dmf", nodes=("a", "ground"), stiffness="k", damping=4)], parameters={"k": "0.46 kN*m/rad"})
    >>> round(float(rig.modes().natural_frequencies[0]), 3)
    8.755
    """

    def __init__(
        self,
        name: str,
        elements: Iterable[Element],
        parameters: Mapping[str, Any] | None = None,
        inputs: Mapping[str, Any] | None = None,
        sensors: Mapping[str, Any] | None = None,
        configurations: Mapping[str, Any] | None = None,
        operating_point: Mapping[str, Any] | OperatingPoint | None = None,
        source: str = "",
        description: str = "",
    ) -> None:
        table, faults = collect_elements(elements)
        definition, found = define(
            name,
            table,
            parameters=parameters,
            inputs=inputs,
            sensors=sensors,
            configurations=configurations,
            operating_point=operating_point,
            source=source,
            description=description,
        )
        faults += found + check_definition(definition)
        _refuse(faults, name)
        self.__setstate__(_state(definition, definition, {}, Overlay(), faults))

    @classmethod
    def from_definition(cls, definition: Definition, findings: Iterable[Fault] = ()) -> Drivetrain:
        """Drivetrain of a definition that has been checked."""
        return cls._variant(definition, definition, {}, Overlay(), findings)

    @classmethod
    def _variant(
        cls,
        definition: Definition,
        base: Definition,
        choice: Mapping[str, str],
        changes: Overlay,
        findings: Iterable[Fault],
        like: Assembly | None = None,
    ) -> Drivetrain:
        """A drivetrain whose assembly may share what it has in common with ``like``."""
        new = cls.__new__(cls)
        new._like = like  # noqa: SLF001
        new.__setstate__(_state(definition, base, choice, changes, findings))
        return new

    def _changed(self, choice: Mapping[str, str], changes: Overlay) -> Drivetrain:
        """The base with the chosen alternatives in the order of the axes, and the changes made by hand last."""
        definition = self._base
        chosen = {axis: choice[axis] for axis in definition.axes if axis in choice}
        for axis, alternative in chosen.items():
            definition = definition.overlaid(self._base.axes[axis][alternative])
        definition = definition.overlaid(changes)
        faults = check_variant(definition)
        _refuse(faults, label(chosen, definition.axes) or self.name)
        like = self.__dict__.get("assembly", self._like)
        return self._variant(definition, self._base, chosen, changes, faults, like)

    @property
    def definition(self) -> Definition:
        """The typed content of the model."""
        return self._definition

    @property
    def name(self) -> str:
        return self._definition.name

    @property
    def source(self) -> str:
        """Where the numbers come from."""
        return self._definition.source

    @property
    def description(self) -> str:
        return self._definition.description

    @cached_property
    def elements(self) -> Mapping[str, Element]:
        """Elements that are switched on, by name, in the order of declaration."""
        return MappingProxyType({element.name: element for element in self._definition.active})

    @cached_property
    def nodes(self) -> tuple[str, ...]:
        """Nodes in the order of their first mention, without ground."""
        return all_nodes(self._definition.active)

    @property
    def inputs(self) -> Mapping[str, Input]:
        """Excitations by name."""
        return MappingProxyType(dict(self._definition.inputs))

    @property
    def sensors(self) -> Mapping[str, Sensor]:
        """Measured quantities by name."""
        return MappingProxyType(dict(self._definition.sensors))

    @cached_property
    def parameters(self) -> Mapping[str, float]:
        """Value in SI of every parameter, by name."""
        return MappingProxyType({name: float(value) for name, value in self.exact_values.items()})

    @property
    def parameter_definitions(self) -> Mapping[str, Parameter]:
        """Parameters as written: expression, unit, description, bounds."""
        return MappingProxyType(dict(self._definition.parameters))

    @cached_property
    def exact_values(self) -> Mapping[str, Any]:
        """Value in SI of every parameter; a Fraction unless a root or pi was involved."""
        return MappingProxyType(resolve(self._definition.parameters)[0])

    @cached_property
    def assembly(self) -> Assembly:
        """The drivetrain in numbers: coordinates, rows and coefficients."""
        from torsionnet.assembly.system import assemble

        return assemble(self._definition, self.exact_values, like=self._like)

    @property
    def axes(self) -> Mapping[str, tuple[str, ...]]:
        """Axes of configurations and the alternatives on each."""
        return MappingProxyType({axis: tuple(names) for axis, names in self._definition.axes.items()})

    @property
    def configurations(self) -> tuple[str, ...]:
        """Names of the configurations; with several axes every combination, as ``gear=V,clutch=open``."""
        axes = self._definition.axes
        return tuple(label(choice, axes) for choice in combinations(axes) if choice)

    @property
    def configuration(self) -> str:
        """The configuration chosen with :meth:`configured`, or an empty string."""
        return label(self._choice, self._definition.axes) if self._choice else ""

    @property
    def title(self) -> str:
        """Name and configuration."""
        return f"{self.name} ({self.configuration})" if self._choice else self.name

    def configured(self, name: str = "", /, **overrides: Any) -> Drivetrain:
        """A copy in a named configuration and with other parameter values.

        Parameters
        ----------
        name : str
            ``"V"``, or ``"gear=V,clutch=open"`` where there are several axes. Axes not named keep their state; on
            an axis named again the new alternative takes the place of the old one.
        **overrides
            Parameter values: SI numbers, quantities or expressions. A derived parameter given here loses its
            expression, and everything derived from it follows the new value. What is given here holds against every
            configuration, also one chosen later.

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
        choice = dict(self._choice)
        if name:
            choice |= parse_choice(name, self._base.axes)
        values = read_overrides(overrides, self._base.parameters, self._base.axes)
        return self._changed(choice, replace(self._changes, parameters={**self._changes.parameters, **values}))

    def switched(self, *, on: Iterable[str] = (), off: Iterable[str] = ()) -> Drivetrain:
        """A copy with elements switched on or off by name, whatever its configuration says."""
        states = dict.fromkeys(self._changes.on, True) | dict.fromkeys(self._changes.off, False)
        states |= dict.fromkeys(known_elements(on, self._base.elements), True)
        states |= dict.fromkeys(known_elements(off, self._base.elements), False)
        lists = {word: tuple(name for name in states if states[name] is (word == "on")) for word in ("on", "off")}
        return self._changed(self._choice, replace(self._changes, on=lists["on"], off=lists["off"]))

    def check(self) -> tuple[Fault, ...]:
        """Warnings and notes about the model (errors have already been refused)."""
        return self._findings

    def ratio_between(self, first: str, second: str) -> float:
        """Total ratio: mean speed of node ``first`` over that of node ``second``.

        Examples
        --------
        >>> import torsionnet as tn
        >>> tn.load("amt_rig").configured("V").ratio_between("motor", "hub")
        3.26
        """
        return total_ratio(self._definition, self.exact_values, first, second)

    @cached_property
    def mean_speeds(self) -> Mapping[str, float]:
        """Mean speed in rad/s of every node the operating point determines."""
        return MappingProxyType(mean_speeds(self._definition, self.exact_values))

    @cached_property
    def mean_torques(self) -> Mapping[str, float]:
        """Mean external torque in N m by node, as given in the operating point."""
        return MappingProxyType(mean_torques(self._definition, self.exact_values))

    def graph(self) -> nx.MultiGraph[str]:
        """The drivetrain as a networkx graph: nodes, and an edge for each pair of ports an element connects.

        Node ``ground`` is there if an element is attached to it. Elements with one port are in the node attribute
        ``elements``; edges carry ``element`` and ``kind``.
        """
        from torsionnet.graph import build_graph

        return build_graph(self)

    def frequency_response(
        self,
        output: Channels,
        input: Channels,
        frequencies: ArrayLike | Adaptive,
        *,
        excitation: str | Sequence[str] | None = None,
        method: str = "auto",
    ) -> FrequencyResponse:
        """Transfer functions between sensors, inputs and nodes at the given frequencies.

        Parameters
        ----------
        output : str, Sensor or sequence of these
            Names of sensors or nodes (the angle there), or ``torque(element, port)``, ``twist(element)``,
            ``velocity(node)``, ``acceleration(node)``, ``angle(node)``.
        input : str, Sensor or sequence of these
            Names of inputs or nodes (a torque there): response to an excitation. Names of sensors: a *measured*
            input, Y_out Y_in^-1 under the excitation, equations (8)-(13) and (20) of Galvagno et al. (2015).
        frequencies : (n_f,) array or Adaptive
            Hz, >= 0; or ``tn.Adaptive(start, stop)``, which resolves every peak in that range. At 0 the finite limit,
            or inf with a warning.
        excitation : str or sequence of str, optional
            What drives the drivetrain when the input is measured; default: the model's only input.
        method : str
            ``"auto"``: elimination along the drivetrain, fast and exact; where numba is installed and the work is large
            (1000 nodes at 100 000 frequencies), in a compiled loop. ``"graph"``: always in numpy. ``"compiled"``:
            always in the compiled loop (``pip install "torsionnet[fast]"``; its start takes a second or two).
            ``"dense"``: LAPACK on the assembled matrices, as a cross-check: one value in twenty is off by more than
            1e-9 of itself, most of them far below the first natural frequency or where values span many decades.

        Returns
        -------
        FrequencyResponse
            ``values`` of shape (n_f, n_out, n_in).

        Examples
        --------
        >>> import torsionnet as tn
        >>> H = tn.load("dmf_rig").frequency_response("theta_1", "T_T", [8.116])
        >>> round(float(abs(H.values[0, 0, 0])) * 57.29578, 4)
        0.2519
        """
        from torsionnet.solve.transfer import frequency_response

        return frequency_response(self, output, input, frequencies, excitation=excitation, method=method)

    def frequency_responses(
        self,
        output: Channels,
        input: Channels,
        frequencies: ArrayLike | Adaptive,
        variants: Mapping[str, ArrayLike],
        *,
        excitation: str | Sequence[str] | None = None,
        method: str = "auto",
    ) -> FrequencyResponses:
        """Transfer functions of many variants of the drivetrain, solved together.

        Parameters
        ----------
        output, input, frequencies, excitation, method
            As for :meth:`frequency_response`.
        variants : mapping
            Parameter -> (n_variants,) values in SI; one value alone holds for all of them.

        Examples
        --------
        >>> import torsionnet as tn
        >>> family = tn.load("dmf_rig").frequency_responses("theta_1", "T_T", [0.0, 8.0], {"k_2": [400, 460, 500]})
        >>> family.magnitude[:, 0, 0, 0].round(6).tolist()
        [0.002575, 0.002249, 0.002075]
        """
        from torsionnet.solve.variants import frequency_responses

        return frequency_responses(self, output, input, frequencies, variants, excitation=excitation, method=method)

    def simulate(self, outputs: Channels, inputs: Mapping[str, ArrayLike], sampling_rate: float) -> Recording:
        """Motion over time from rest, exact for torques that run straight from sample to sample.

        Parameters
        ----------
        outputs : str, Sensor or sequence of these
            As for :meth:`frequency_response`.
        inputs : mapping
            Name of an input or node -> (n,) torques in N m. That on a node is called ``torque on NODE`` in the result.
        sampling_rate : float
            Hz.

        Returns
        -------
        Recording
            The inputs and the outputs, SI units.

        Raises
        ------
        UsageError
            Unknown names, unlike lengths, frequency-dependent laws, or a reading with the rate of an input in it.

        Examples
        --------
        >>> import torsionnet as tn
        >>> record = tn.load("dmf_rig").simulate(["theta_1", "T_T"], {"T_M": [0.0] + 4000 * [10.0]}, 1e3)
        >>> record.names, round(float(record["T_T"].values[-1]), 6)
        (('T_M', 'theta_1', 'T_T'), 10.0)
        """
        from torsionnet.solve.simulate import simulate

        return simulate(self, outputs, inputs, sampling_rate)

    def modes(
        self,
        *,
        measured_input: Channels | None = None,
        excitation: str | Sequence[str] | None = None,
        lowest: int | None = None,
    ) -> Modes:
        """Complex modes: natural frequencies, damping ratios, shapes at all nodes and energy shares.

        Parameters
        ----------
        measured_input : str, Sensor or sequence of these, optional
            The poles of transfer functions against this measured input instead: for an output at the torque meter or
            downstream of it, those of the drivetrain cut there.
        excitation : str or sequence of str, optional
            Which input drives the drivetrain then; default: the model's only input.
        lowest : int, optional
            Only so many modes, those of the smallest ``|lambda|``, rigid bodies included; likewise the undamped
            natural frequencies. Much quicker for large models. Default: all.

        Examples
        --------
        >>> import torsionnet as tn
        >>> tn.load("dmf_rig").modes().natural_frequencies.round(5).tolist()
        [7.10526, 80.98336]
        """
        from torsionnet.solve.modes import modes

        return modes(self, measured_input=measured_input, excitation=excitation, lowest=lowest)

    def symbolic(self, *, referred_to: Sequence[str] = ()) -> SymbolicSystem:
        """M, C, K and transfer functions in the model's own symbols.

        ``referred_to`` chooses the nodes kept as coordinates; they stand in the order given.

        Examples
        --------
        >>> import torsionnet as tn
        >>> tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T").mechanical
        1/(I_2*s**2 + k_2 + s*(c_2 + c_B)) + 1/(c_1*s + k_1)
        """
        from torsionnet.symbolics.system import symbolic_system

        return symbolic_system(self, referred_to)

    def to_control(self) -> control.StateSpace:
        """State space with the model's inputs and sensors as named signals, for python-control."""
        from torsionnet.solve.state_space import to_control

        return to_control(self)

    def to_yaml(self, path: str | Path | None = None) -> str:
        """The model as text of a model file, also written to ``path`` if given."""
        from torsionnet.files import dump

        return dump(self._definition, path)

    _definition: Definition
    _base: Definition
    _choice: dict[str, str]
    _changes: Overlay
    _findings: tuple[Fault, ...]
    _like: Assembly | None = None

    def __getstate__(self) -> dict[str, Any]:
        """What makes the drivetrain, without what was calculated from it."""
        return _state(self._definition, self._base, self._choice, self._changes, self._findings)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Drivetrain):
            return NotImplemented
        return self._definition.to_data() == other._definition.to_data()

    def __hash__(self) -> int:
        return hash((self.name, tuple(self._definition.elements)))

    def __repr__(self) -> str:
        counts = f"{len(self.elements)} elements, {len(self.nodes)} nodes, {len(self.parameters)} parameters"
        return f"<Drivetrain {self.name!r}: {counts}{f', {self.configuration}' if self._choice else ''}>"

    def _repr_html_(self) -> str:
        from torsionnet.overview import page

        return page(self)


def _state(
    definition: Definition, base: Definition, choice: Mapping[str, str], changes: Overlay, findings: Iterable[Fault]
) -> dict[str, Any]:
    parts = {"_definition": definition, "_base": base, "_choice": dict(choice), "_changes": changes}
    return parts | {"_findings": tuple(findings)}


def _refuse(faults: Iterable[Fault], title: str) -> None:
    errors = [fault for fault in faults if fault.severity == "error"]
    if errors and has_errors(errors):
        raise ModelError(errors, title if isinstance(title, str) and title else "the model")
