"""Drivetrain model with methods for its responses, modes, simulation and equations; its loading from model files."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from torsionnet.base.errors import Fault, ModelError
from torsionnet.base.packages import AttributeHints, LazyMethod
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.model.definition import Definition
from torsionnet.model.files.reader import find_model, read_file, read_text

if TYPE_CHECKING:
    import torsionnet.linear.assembly.matrices
    import torsionnet.linear.batch.batched_responses
    import torsionnet.linear.dynamic_stiffness.state_space
    import torsionnet.linear.modes.natural_modes
    import torsionnet.linear.responses.loop_margins
    import torsionnet.linear.responses.transfer
    import torsionnet.machinery.criticals.critical_speed_search
    import torsionnet.machinery.design.damper_design
    import torsionnet.machinery.holzer.holzer
    import torsionnet.machinery.holzer.mass_elastic_lines
    import torsionnet.machinery.mean.mean_solution
    import torsionnet.machinery.mean.static_state
    import torsionnet.machinery.orders.refined_response
    import torsionnet.machinery.passage.passage_solution
    import torsionnet.machinery.verdicts.limit_checking
    import torsionnet.machinery.verdicts.shaft_margins
    import torsionnet.model.graph
    import torsionnet.model.overview
    import torsionnet.motion.periodic.periodic_response
    import torsionnet.motion.scenario_run
    import torsionnet.symbolic.symbolic_system
    from torsionnet.base.entries.accepted_types import NumberRows
    from torsionnet.model.balanced_state import BalancedState
else:
    torsionnet = LazyMethod("torsionnet")


class Drivetrain(AssembledModel, AttributeHints):
    """Torsional model of a drivetrain; every method that changes something returns a changed copy.

    Parameters
    ----------
    name : str
        Title of the model.
    elements : iterable of Element
        In the order of declaration, which fixes the order of nodes and, where nothing else is said, of coordinates.
    parameters : mapping, optional
        Name -> number in SI, text with unit, or expression of other parameters.
    inputs : mapping, optional
        What drives it: name -> ``{"torque": node}`` or an imposed motion, ``{"angle": node}``, whose node stands still
        wherever that input is not the excitation.
    sensors : mapping, optional
        What is read: name -> ``{"angle": node}``, ``{"velocity": node}``, ``{"torque": element, "at": node}``, ...
    configurations : mapping, optional
        Axis -> alternative -> ``{parameter: value, "on": [...], "off": [...]}``; one axis needs no name.
    operating_point : mapping, optional
        ``{"speed": {node: value}, "torque": {node: value}}``.
    speeds : mapping, optional
        At which speeds running machinery is examined: ``{"of": node, "range": "300..900 rpm"}``.
    load : mapping, optional
        Who absorbs its power and who drives it, on average.
    excitations : mapping, optional
        What excites it by order: name -> an engine, a propeller, ``{"type": "harmonic", ...}``, ...
    limits : mapping, optional
        Name -> what a torque, stress, angle or heat must keep to, ``{"rule": ..., ...}`` (:meth:`check_limits`).
    scenarios : mapping, optional
        Name -> what happens over time: torques on nodes, a short circuit (:meth:`simulate`).
    source, description : str, optional
        Where the numbers come from, and what the model is.
    ports : iterable of str, optional
        Nodes at which it is joined to others that use it as a part (:meth:`with_part`).
    parts : mapping, optional
        Name -> model with ports, to be put in by ``use``.
    use : mapping, optional
        Name -> ``{"part": name, "at": {port: node}, "parameters": {...}, "repeat": n, "chain": [front, rear]}``.

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

    # A method is the function that solves it, with its docstring; the module is imported at the first call.
    graph = torsionnet.model.graph.graph
    matrices = torsionnet.linear.assembly.matrices.matrices
    frequency_response = torsionnet.linear.responses.transfer.frequency_response
    frequency_responses = torsionnet.linear.batch.batched_responses.frequency_responses
    modes = torsionnet.linear.modes.natural_modes.modes
    simulate = torsionnet.motion.scenario_run.simulate
    periodic_response = torsionnet.motion.periodic.periodic_response.periodic_response
    loop_margins = torsionnet.linear.responses.loop_margins.loop_margins
    symbolic = torsionnet.symbolic.symbolic_system.symbolic
    to_control = torsionnet.linear.dynamic_stiffness.state_space.to_control
    _repr_html_ = torsionnet.model.overview.page

    # What is asked of running machinery, with its speeds, load, excitations and limits.
    order_response = torsionnet.machinery.orders.refined_response.order_response
    passage_response = torsionnet.machinery.passage.passage_solution.passage_response
    critical_speeds = torsionnet.machinery.criticals.critical_speed_search.critical_speeds
    shaft_margins = torsionnet.machinery.verdicts.shaft_margins.shaft_margins
    holzer_table = torsionnet.machinery.holzer.holzer.holzer_table
    mass_elastic_table = torsionnet.machinery.holzer.mass_elastic_lines.mass_elastic_table
    mean_response = torsionnet.machinery.mean.mean_solution.mean_response
    static_state = torsionnet.machinery.mean.static_state.static_state
    power_balance = torsionnet.machinery.mean.static_state.power_balance
    dissipated_power = torsionnet.machinery.mean.static_state.dissipated_power
    check_limits = torsionnet.machinery.verdicts.limit_checking.check_limits
    damper_design = torsionnet.machinery.design.damper_design.damper_design

    @classmethod
    def from_matrices(
        cls,
        M: NumberRows,
        C: NumberRows | None = None,
        K: NumberRows | None = None,
        *,
        names: Sequence[str] | None = None,
        name: str = "matrices",
        inputs: Mapping[str, Any] | None = None,
        sensors: Mapping[str, Any] | None = None,
    ) -> Self:
        """Drivetrain of matrices M, C and K that were calculated elsewhere, with a node for each coordinate.

        Parameters
        ----------
        M, C, K : (n, n) arrays
            Inertia in kg m^2, damping in N m s/rad and stiffness in N m/rad; symmetric, without negative parts, also
            sparse.
        names : sequence of str, optional
            Nodes in the order of the rows, those of :meth:`matrices` included, with "_" for a dot; default: the labels
            of data frames, else ``q1``, ``q2``, ...
        name : str
            Title of the model.
        inputs, sensors : mapping, optional
            As those of the class.

        Raises
        ------
        ModelError
            A matrix is not symmetric, a motion has negative inertia, damping or stiffness, or labels of data frames
            contradict the names or each other; nodes are named.

        Notes
        -----
        The matrices become one element, :class:`LumpedMatrices`. Calculations that need shafts or machines, as
        Holzer tables, have none there.

        Examples
        --------
        >>> import torsionnet as tn
        >>> rig = tn.Drivetrain.from_matrices([[0.5, 0], [0, 2]], None, [[900, -900], [-900, 900]], names=["a", "b"])
        >>> [round(float(one), 3) for one in rig.modes().natural_frequencies]  # sqrt(900 (1/0.5 + 1/2))/(2 pi)
        [0.0, 7.549]
        """
        from torsionnet.model.elements.lumped_matrices import LumpedMatrices, node_names

        nodes = node_names(names, {"inertia": M, "damping": C, "stiffness": K})
        element = LumpedMatrices.from_entries("matrices", nodes=nodes, inertia=M, damping=C, stiffness=K)
        return cls(name, [element], inputs=inputs, sensors=sensors)

    def check(self) -> tuple[Fault, ...]:
        """Warnings and notes about the model, unstable modes included (errors have already been refused)."""
        return (*super().check(), *(self._operating_faults or self._unstable_modes))

    @cached_property
    def _operating_faults(self) -> tuple[Fault, ...]:
        """Faults of an operating point at which laws of motion are not in balance, as a torque beyond a last stage."""
        from torsionnet.base.errors import Fault, ModelError, TorsionnetError

        tangents = self.definition.tangents
        try:
            _ = None if tangents is None else tangents.state
        except ModelError as error:
            return error.faults
        except TorsionnetError as error:
            return (Fault(str(error), ("operating_point",), kind=error.kind),)
        return ()

    @cached_property
    def _unstable_modes(self) -> tuple[Fault, ...]:
        if not any(element.may_feed for element in self.elements.values()):
            return ()
        from torsionnet.linear.modes.unstable_modes import unstable_modes

        return unstable_modes(self)

    def at(
        self,
        *,
        torque: Mapping[str, float | str] | None = None,
        speed: Mapping[str, float | str] | float | str | None = None,
    ) -> Self:
        """Copy of the drivetrain at an operating point, about which its laws of motion are linear.

        Each law has its slope at the mean twist or slip under these torques and speeds: springs in stages that of the
        stage reached, a clearance its stiffness in contact and nothing in the gap, friction that sticks is rigid. All
        results of the copy are linear about this point, and their notes say so.

        Where laws over the speed have several balances with the torques, the copy is at the stable one nearest to the
        speeds given; :meth:`operating_points` lists them.

        Parameters
        ----------
        torque : mapping, optional
            Node, or two nodes as ``"pulley-block"`` -> mean external torque in N m or with its unit. They replace the
            load and the torques of the model; on a drivetrain that turns freely they are in balance, or a load with a
            law over speed takes what is left.
        speed : mapping, float or str, optional
            Node -> mean speed in rad/s or with its unit; one speed alone is that of the node of ``speeds:``.

        Raises
        ------
        UsageError
            Neither torques nor speeds.
        ModelError
            Unknown nodes, torques that are not in balance, a torque beyond the last stage or the breakdown torque,
            several stable points and no speed to choose by. Balances are sought when a result needs them.

        Examples
        --------
        >>> import torsionnet as tn
        >>> rig = tn.Drivetrain("rig", [tn.Inertia("rotor", node="a", inertia=0.5),
        ...     tn.Spring("disc", nodes=("a", "ground"), stages=[
        ...         {"stiffness": "450 N*m/rad", "to": "0.1 rad"}, {"stiffness": "1800 N*m/rad"}])])
        >>> frequencies = [one.modes().undamped_natural_frequencies[0] for one in (rig, rig.at(torque={"a": "90 N*m"}))]
        >>> [round(2 * 3.141592653589793 * float(one), 6) for one in frequencies]
        [30.0, 60.0]
        """
        from torsionnet.motion.balance.operating_balance import asked_point

        return self.at_point(asked_point(self.definition, torque, speed))

    def operating_points(
        self,
        *,
        torque: Mapping[str, float | str] | None = None,
        speed: Mapping[str, float | str] | float | str | None = None,
    ) -> tuple[BalancedState, ...]:
        """States of all laws of motion that are in balance at an operating point, each with its stability.

        The order is that of rising slip; where speeds are given, that of the distance from these. Without laws of
        motion there are none. The arguments are those of :meth:`at`; without any the operating point is the model's.

        Examples
        --------
        >>> import torsionnet as tn
        >>> rig = tn.Drivetrain("rig", [tn.Inertia("rotor", node="a", inertia=0.5),
        ...     tn.Clearance("claw", nodes=("a", "ground"), gap="0.2 rad", stiffness="100 N*m/rad")])
        >>> (point,) = rig.operating_points(torque={"a": "20 N*m"})
        >>> round(point.states["claw"][0].twist, 9), point.torques["claw"]
        (0.3, (20.0,))
        """
        asked = self
        if torque is not None or speed is not None:
            asked = self.at(torque=torque, speed=speed)
        elif self.definition.load is None:  # all laws act, also those that keep a working point in linear results
            asked = self.at_point(self.definition.operating_point)
        tangents = asked.definition.tangents
        return () if tangents is None else tangents.states

    def to_yaml(self, path: str | Path | None = None) -> str:
        """Text of the model as a model file, also written to ``path`` if given."""
        from torsionnet.model.files.writer import dump

        return dump(self.definition, path)


def load(model: str | os.PathLike[str]) -> Drivetrain:
    """Load the drivetrain of a model file, or a library model by name.

    Parameters
    ----------
    model : str or path
        A ``.yaml``, ``.yml`` or ``.json`` file, or a name out of :func:`library_models`.

    Raises
    ------
    ModelError
        With every fault of the file and its place.
    UsageError
        There is no such file or library model.

    Examples
    --------
    >>> load("dmf_rig").nodes
    ('motor', 'primary', 'secondary')
    """
    path = find_model(model)
    return _drivetrain(*read_file(path), path.name)


def loads(text: str, file: str = "<text>", folder: str | os.PathLike[str] | None = None) -> Drivetrain:
    """Load the drivetrain described by the text of a model file; files that it names lie in ``folder``.

    Examples
    --------
    >>> text = "{torsionnet: 1, name: wheel, elements: {disc: {type: inertia, node: a, inertia: 2}}}"
    >>> loads(text).name
    'wheel'
    """
    return _drivetrain(*read_text(text, file, None if folder is None else Path(folder)), file)


def _drivetrain(definition: Definition | None, faults: list[Fault], title: str) -> Drivetrain:
    if definition is None:
        raise ModelError([fault for fault in faults if fault.severity == "error"], title)
    return Drivetrain.from_definition(definition, faults)
