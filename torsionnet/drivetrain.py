"""Drivetrain model with methods for its responses, modes, simulation and equations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from torsionnet.core.packages import AttributeHints
from torsionnet.running_machinery import RunningMachinery

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import TypeAlias

    import control
    import networkx as nx
    from numpy.typing import ArrayLike

    from torsionnet.core.errors import Fault
    from torsionnet.model.channels import Sensor
    from torsionnet.model.motion_balance.balanced_state import BalancedState
    from torsionnet.model.scenarios.scenario import Scenario
    from torsionnet.response import FrequencyResponse, FrequencyResponses, Modes
    from torsionnet.response.critical_speeds import CriticalSpeeds
    from torsionnet.response.loop_margins import LoopMargins
    from torsionnet.response.margin_rules import MarginRule
    from torsionnet.response.motion.motion_start import MotionStart
    from torsionnet.response.recording import Recording, Signal
    from torsionnet.solve.responses.grid import Adaptive
    from torsionnet.symbolic.symbolic_system import SymbolicSystem

    Channels: TypeAlias = str | Sensor | Sequence[str | Sensor]


class Drivetrain(RunningMachinery, AttributeHints):
    """Torsional model of a drivetrain; every method that changes something returns a changed copy.

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
    speeds, load, excitations : mapping, optional
        At which speeds running machinery is examined, who absorbs its power and who drives, and what excites it.
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

    def check(self) -> tuple[Fault, ...]:
        """Warnings and notes about the model, unstable modes included (errors have already been refused)."""
        return (*super().check(), *(self._operating_faults or self._unstable_modes))

    @cached_property
    def _operating_faults(self) -> tuple[Fault, ...]:
        """Faults of an operating point at which laws of motion are not in balance, as a torque beyond a last stage."""
        from torsionnet.core.errors import Fault, ModelError, TorsionnetError

        tangents = self.definition.tangents
        try:
            _ = None if tangents is None else tangents.state
        except ModelError as error:
            return error.faults
        except TorsionnetError as error:
            return (Fault(str(error), ("operating_point",)),)
        return ()

    @cached_property
    def _unstable_modes(self) -> tuple[Fault, ...]:
        if not any(element.may_feed for element in self.elements.values()):
            return ()
        from torsionnet.solve.modes.stability import unstable_modes

        return unstable_modes(self)

    def graph(self) -> nx.MultiGraph[str]:
        """Graph of the drivetrain (networkx): its nodes, and an edge for each pair of ports that an element connects.

        Node ``ground`` is there if an element is attached to it. Elements with one port are in the node attribute
        ``elements``; edges carry ``element`` and ``kind``.
        """
        from torsionnet.model.graph import build_graph

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
        from torsionnet.solve.responses.transfer import frequency_response

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
        from torsionnet.solve.batch.variants import frequency_responses

        return frequency_responses(self, output, input, frequencies, variants, excitation=excitation, method=method)

    def simulate(
        self,
        outputs: Channels | None = None,
        inputs: Mapping[str, ArrayLike | Signal] | None = None,
        sampling_rate: float | None = None,
        *,
        between: str | Mapping[str, str] | None = None,
        start: str | MotionStart | None = None,
        scenario: str | Scenario | Mapping[str, Any] | None = None,
        duration: float | None = None,
        check: bool = False,
    ) -> Recording:
        """Motion and torques over time, exact for torques that are straight, held or band-limited between samples.

        Laws of motion, as of clearances and friction, act in full: the result has their events and an energy balance.

        Parameters
        ----------
        outputs : str, Sensor or sequence of these
            As for :meth:`frequency_response`; in a scenario the model's sensors unless others are named.
        inputs : mapping
            Name of an input or node -> (n,) torques in N m, or a :class:`~torsionnet.signals.Signal`. That on a node is
            called ``torque on NODE`` in the result.
        sampling_rate : float
            Hz; in a scenario instead of what that says.
        between : {"straight", "held", "band_limited"}, or mapping of these by input, optional
            Course of the torques between samples; by default that of a signal, and straight lines between numbers.
        start : str or MotionStart, optional
            ``"rest"``, ``"operating_point"``, in balance with the torques at the first sample and mean torques on other
            nodes, or angles and speeds of nodes at the first sample. Default: rest, or what the scenario says.
        scenario : str, Scenario or mapping, optional
            Instead of inputs: a scenario of the model, or another one, ``{"type": "torques", "duration": ...}``, whose
            torques act.
        duration : float, optional
            Time in s that is simulated in a scenario, instead of what that says; inputs have its length.
        check : bool
            Repeat the motion in steps half as long, and note until when both agree: contacts make motions chaotic.

        Returns
        -------
        Recording
            The inputs and the outputs, SI units.

        Raises
        ------
        UsageError
            Unknown names, unlike lengths, frequency-dependent laws, or a reading with the rate of an input in it.
        SolveError
            Contacts that close and open without an end, or a twist beyond the rows of its law.

        Examples
        --------
        >>> import torsionnet as tn
        >>> record = tn.load("dmf_rig").simulate(["theta_1", "T_T"], {"T_M": [0.0] + 4000 * [10.0]}, 1e3)
        >>> record.names, round(float(record["T_T"].values[-1]), 6)
        (('T_M', 'theta_1', 'T_T'), 10.0)
        >>> fault = tn.load("turbine_generator_ssr").simulate("T_LPB_G", scenario="three_phases", sampling_rate=2e4)
        >>> fault.events[0].what, round(float(abs(fault["T_LPB_G"].values).max()) / 1e6, 2)
        ('short circuit of 3 phases', 7.95)
        """
        from torsionnet.core.errors import UsageError

        if scenario is not None:
            from torsionnet.solve.motion.scenario_run import run_scenario

            if inputs is not None or between is not None:
                raise UsageError("a scenario brings its own torques; leave out inputs and between, or the scenario")
            return run_scenario(
                self, scenario, outputs, start=start, sampling_rate=sampling_rate, duration=duration, check=check
            )
        from torsionnet.solve.motion.simulation import simulate

        if outputs is None or inputs is None or sampling_rate is None:
            raise UsageError("a simulation needs outputs, inputs and a sampling rate, or a scenario")
        begin = start or "rest"
        return simulate(self, outputs, inputs, sampling_rate, begin, duration=duration, check=check, between=between)

    def modes(
        self,
        *,
        measured_input: Channels | None = None,
        excitation: str | Sequence[str] | None = None,
        lowest: int | None = None,
        up_to: float | None = None,
    ) -> Modes:
        """Complex modes with natural frequencies, damping ratios, shapes at all nodes and energy shares.

        Parameters that follow the operating point have their values at its speed, else at the rated one; a note says
        which that is.

        Parameters
        ----------
        measured_input : str, Sensor or sequence of these, optional
            The poles of transfer functions against this measured input instead: for an output at the torque meter or
            downstream of it, those of the drivetrain cut there.
        excitation : str or sequence of str, optional
            Which input drives the drivetrain then; default: the model's only input.
        lowest : int, optional
            Only so many modes, those of the smallest ``|lambda|``, rigid bodies included; likewise the undamped
            natural frequencies. Much quicker for large models. Default: all; with continuous shafts, which have
            infinitely many, the lowest 20.
        up_to : float, optional
            Only modes of natural frequencies up to this one in Hz; with continuous shafts all of these.

        Examples
        --------
        >>> import torsionnet as tn
        >>> tn.load("dmf_rig").modes().natural_frequencies.round(5).tolist()
        [7.10526, 80.98336]
        """
        from torsionnet.model.operating_values import operating_speed_notes
        from torsionnet.solve.modes.modes import modes

        found = modes(self, measured_input=measured_input, excitation=excitation, lowest=lowest, up_to=up_to)
        return replace(found, notes=(*found.notes, *operating_speed_notes(self.external_torques)))

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
        from torsionnet.model.motion_balance.asked_point import asked_point

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

    def loop_margins(self, controller: str | None = None) -> LoopMargins:
        """Stability margins of the loop opened at a controller, and its frequency response for Nyquist's plot.

        Gain, phase, delay and modulus margins, each with its frequency, all other loops being closed; delays are exact.
        :func:`torsionnet.plot.nyquist` draws it.

        Parameters
        ----------
        controller : str, optional
            Name of the element; default: the only one.

        Examples
        --------
        >>> import torsionnet as tn
        >>> rig = tn.Drivetrain("governed", [tn.Inertia("rotor", node="a", inertia=2),
        ...     tn.Controller("governor", sense={"velocity": "a"}, act="a", law=-30, delay="50 ms")])
        >>> margins = rig.loop_margins()
        >>> round(margins.gain_increase.value, 4), round(margins.phase.value, 3), round(margins.delay.value, 6)
        (2.0944, 47.028, 0.05472)
        """
        from torsionnet.solve.responses.loop_margin_search import loop_margins

        return loop_margins(self, controller)

    def shaft_margins(self, margin: str | float | MarginRule, *, lowest: int | None = None) -> CriticalSpeeds:
        """Separation margins of every mode from 1 and 2 times each shaft's speed and each electrical frequency.

        Shafts are those whose mean speeds differ, named by their first node; an electric machine counts with its line
        frequency, or with that of its inverter, pole pairs times the speed (slip neglected).

        Parameters
        ----------
        margin : str, float or MarginRule
            As for :meth:`critical_speeds`.
        lowest : int, optional
            Only the lowest so many modes.

        Returns
        -------
        CriticalSpeeds
            Margins as shares of the excitation frequency, with what the rule requires; without torques.

        Raises
        ------
        UsageError
            The model has no range of speeds.

        Examples
        --------
        >>> import torsionnet as tn
        >>> found = tn.load("reciprocating_compressor_train").shaft_margins("api684", lowest=1)
        >>> sorted({one.mode.number for one in found.crossings})
        [1]
        """
        from torsionnet.solve.running.shaft_margins import shaft_margins

        return shaft_margins(self, margin, lowest)

    def symbolic(self, *, referred_to: Sequence[str] = ()) -> SymbolicSystem:
        """Symbolic model, which has M, C, K and transfer functions in the model's own symbols.

        ``referred_to`` chooses the nodes kept as coordinates; they stand in the order given.

        Examples
        --------
        >>> import torsionnet as tn
        >>> tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T").mechanical
        1/(I_2*s**2 + k_2 + s*(c_2 + c_B)) + 1/(c_1*s + k_1)
        """
        from torsionnet.symbolic.symbolic_system import symbolic_system

        return symbolic_system(self, referred_to)

    def to_control(self) -> control.StateSpace:
        """State space with the model's inputs and sensors as named signals, for python-control."""
        from torsionnet.solve.dynamic_stiffness.state_space import to_control

        return to_control(self)

    def to_yaml(self, path: str | Path | None = None) -> str:
        """Text of the model as a model file, also written to ``path`` if given."""
        from torsionnet.model.files import dump

        return dump(self.definition, path)

    def _repr_html_(self) -> str:
        from torsionnet.model.overview import page

        return page(self)
