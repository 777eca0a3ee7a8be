"""Methods of a drivetrain as running machinery: orders, critical speeds, mean torques, limits, dampers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.assembly.assembled import AssembledModel

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from typing import TypeAlias

    from numpy.typing import ArrayLike

    from torsionnet.model.channels import Sensor
    from torsionnet.response.critical_speeds import CriticalSpeeds
    from torsionnet.response.damper_optimum import DamperOptimum
    from torsionnet.response.dissipated_power import DissipatedPower
    from torsionnet.response.holzer_table import HolzerTable
    from torsionnet.response.limits.limit_check import LimitCheck
    from torsionnet.response.margin_rules import MarginRule
    from torsionnet.response.mass_elastic_table import MassElasticTable
    from torsionnet.response.mean_response import MeanResponse
    from torsionnet.response.order_response import OrderResponse
    from torsionnet.response.passage_response import PassageResponse
    from torsionnet.response.power_balance import PowerBalance
    from torsionnet.response.static_state import StaticState

    Channels: TypeAlias = str | Sensor | Sequence[str | Sensor]


class RunningMachinery(AssembledModel):
    """Base of a drivetrain with the methods that need its speeds and excitations."""

    def order_response(
        self,
        outputs: Channels,
        *,
        speeds: ArrayLike | None = None,
        speed_of: str | None = None,
        excitations: Iterable[str] | None = None,
        refine: bool = False,
    ) -> OrderResponse:
        """Response of running machinery as complex amplitudes of every order of the outputs at every speed.

        Parameters
        ----------
        outputs : str, Sensor or sequence of these
            As for :meth:`frequency_response`.
        speeds : (n_speeds,) array, optional
            rad/s, above 0; default: those of the model.
        speed_of : str, optional
            The node they belong to; default: that of the model.
        excitations : iterable of str, optional
            Which of the model's excitations act; default: all.
        refine : bool
            Whether the result has more speeds between these, until the largest half range and the largest amplitudes
            are known to 0.1 %; between the speeds of a list is nothing.

        Raises
        ------
        UsageError
            Unknown names, no excitations or speeds, or a shaft without a fixed ratio to the reference.

        Examples
        --------
        >>> import torsionnet as tn
        >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
        ...     tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)]
        >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["600 rpm"]},
        ...     excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}})
        >>> run = fan.order_response("torque(shaft)")
        >>> w = 2 * run.speeds[0]
        >>> bool(abs(run.of_order(2)[0] - -10 * 2e4 / (3e4 - 2 * w**2)) < 1e-9)
        True
        """
        from torsionnet.solve.running.order_response import order_response
        from torsionnet.solve.running.refined_response import refined_response

        answer = refined_response if refine else order_response
        return answer(self, outputs, speeds=speeds, speed_of=speed_of, excitations=excitations)

    def mean_response(self, outputs: Channels, speeds: ArrayLike | None = None) -> MeanResponse:
        """Mean torques and twists of running machinery under its load, over speed.

        Springs hand mean torques on; dampers stand for vibration and take none. Drivers act in the direction of
        rotation, absorbers against it, and the reference node of the speeds turns in the positive sense.

        Parameters
        ----------
        outputs : str, Sensor or sequence of these
            As for :meth:`frequency_response`, but nothing that turns freely: a torque or a twist.
        speeds : (n_speeds,) array, optional
            rad/s, of the node of the model's ``speeds:``; default: those of the model.

        Returns
        -------
        MeanResponse
            ``values`` of shape (n_speeds, n_out).

        Raises
        ------
        UsageError
            Unknown names, no load and no torques at the operating point, torques that are not in balance, a speed
            outside a table, or an output that mean torques do not determine.

        Examples
        --------
        >>> import torsionnet as tn
        >>> elements = [tn.Inertia("engine", node="e", inertia=2), tn.Inertia("screw", node="p", inertia=1),
        ...     tn.Spring("shaft", nodes=("e", "p"), stiffness=1e6)]
        >>> boat = tn.Drivetrain("boat", elements, speeds={"of": "e", "list": [50, 100], "rated": 100},
        ...     load={"absorbed_at": "p", "power": "100 kW", "torque_exponent": 2, "driven_by": {"e": 1}})
        >>> boat.mean_response("torque(shaft)").values.round(6).tolist()
        [[250.0], [1000.0]]
        """
        from torsionnet.solve.running.mean_response import mean_response

        return mean_response(self, outputs, speeds)

    def passage_response(
        self,
        outputs: Channels,
        times: ArrayLike,
        speeds: ArrayLike,
        *,
        speed_of: str | None = None,
        excitations: Iterable[str] | None = None,
    ) -> PassageResponse:
        """Response to all orders along a speed given over time, such as a passage of a resonance or a run-up.

        It starts from steady vibration at the first speed. Amplitudes of orders and parameters have their values at the
        speed of the moment; mean torques are left out. Hysteretic and tabulated laws become springs and dampers equal
        to them at the resonance. Of several cases of excitation the one with the largest steady vibration of the first
        output acts.

        Parameters
        ----------
        outputs : str, Sensor or sequence of these
            As for :meth:`frequency_response`.
        times : (n,) array
            s, rising.
        speeds : (n,) array
            rad/s, above 0, at these times; straight between them.
        speed_of, excitations : optional
            As for :meth:`order_response`.

        Returns
        -------
        PassageResponse
            ``values`` of shape (n_t, n_out), with an estimate of their error.

        Raises
        ------
        UsageError
            Unknown names, no excitations, or what has no state space: imposed motions, delays, long continuous shafts.

        Examples
        --------
        Through a resonance at 955 rpm in 2 s, which steadily would give 25 N m:

        >>> import torsionnet as tn
        >>> elements = [tn.Inertia("rotor", node="a", inertia=1),
        ...     tn.Spring("shaft", nodes=("a", "ground"), stiffness=1e4, damping=2)]
        >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["955 rpm"]},
        ...     excitations={"blades": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": "0.5 N*m"}}}})
        >>> run = fan.passage_response("torque(shaft)", [0, 2], [80, 120])
        >>> print(f"{run.peak().half_range:.1f} N m at {run.peak().rpm:.0f} rpm")
        11.3 N m at 1032 rpm
        """
        from torsionnet.solve.running.passage_response import passage_response

        return passage_response(self, outputs, times, speeds, speed_of=speed_of, excitations=excitations)

    def damper_design(
        self,
        output: str | Sensor,
        parameters: str | Sequence[str] | Mapping[str, Sequence[float | str] | None],
        *,
        input: str | Sensor | None = None,
        band: tuple[float, float] | None = None,
        speeds: ArrayLike | None = None,
        speed_of: str | None = None,
        excitations: Iterable[str] | None = None,
    ) -> DamperOptimum:
        """Optimal damping and stiffness of dampers, with which the largest vibration is smallest.

        Parameters
        ----------
        output : str or Sensor
            What is to be small, as for :meth:`frequency_response`.
        parameters : str, sequence of str, or mapping
            Names of parameters or ``element.field``; in a mapping with (lower, upper) bounds in SI or with units. Those
            not given are the bounds in the model, else a tenth to ten times the value.
        input : str or Sensor, optional
            The largest magnitude of output over input within ``band`` is made small. Without it the largest half range
            of all orders over ``speeds``, under the model's excitations.
        band : (float, float), optional
            Hz; default: around all natural frequencies.
        speeds, speed_of, excitations
            As for :meth:`order_response`.

        Raises
        ------
        UsageError
            Unknown names, no bounds, or what goes only with the other question.

        Examples
        --------
        >>> import torsionnet as tn
        >>> crank = tn.Drivetrain("crank", [tn.Inertia("mass", node="a", inertia=2),
        ...     tn.Spring("shaft", nodes=("a", "ground"), stiffness=8e4),
        ...     tn.ViscousDamper("damper", node="a", ring_inertia=1, damping=100)])
        >>> found = crank.damper_design("a", {"damper.damping": (20, 2000)}, input="a")
        >>> round(float(found.values["damper.damping"]) / (2 * 1 * 200), 4)  # Den Hartog: sqrt(2/15)
        0.3651
        """
        from torsionnet.solve.design import damper_design

        return damper_design(
            self,
            output,
            parameters,
            input=input,
            band=band,
            speeds=speeds,
            speed_of=speed_of,
            excitations=excitations,
        )

    def critical_speeds(
        self,
        outputs: Channels = (),
        *,
        speeds: ArrayLike | None = None,
        speed_of: str | None = None,
        excitations: Iterable[str] | None = None,
        lines: Iterable[str] | None = None,
        margin: str | float | MarginRule | None = None,
        reach: float = 0.25,
        lowest: int | None = None,
        line_frequency: float | None = None,
        dampers: str = "as_modelled",
        damper_names: Iterable[str] | None = None,
    ) -> CriticalSpeeds:
        """Critical speeds at which orders meet natural frequencies, with and without damping, and their excitation.

        Parameters
        ----------
        outputs : str, Sensor or sequence of these, optional
            Also the speeds at which the orders of these are largest.
        speeds : array, optional
            rad/s; the lowest and the highest bound the operating range. Default: those of the model.
        speed_of : str, optional
            The node they belong to; default: that of the model.
        excitations : iterable of str, optional
            Which of the model's excitations count; default: all.
        lines : iterable of str, optional
            Names of the order lines that count, such as ``"engine 6"``; default: all.
        margin : str, float or MarginRule, optional
            A preset (``"api610"``, ``"api617"``, ``"api618"``, ``"api684"``, ``"line_frequency"``), or a share as 0.1.
        reach : float
            Critical speeds are listed up to this share outside the operating range.
        lowest : int, optional
            Only the lowest so many modes.
        line_frequency : float, optional
            Hz; once and twice of it are compared with the natural frequencies, too.
        dampers : str
            ``"as_modelled"``, or the rings of viscous dampers ``"free"``, ``"locked"``, or by ``"half"``.
        damper_names : iterable of str, optional
            Which dampers, or films between a hub and a ring; default: all elements of type viscous_damper.

        Raises
        ------
        UsageError
            Unknown names, no excitations or speeds, or a shaft without a fixed ratio to the reference.

        Examples
        --------
        >>> import torsionnet as tn
        >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
        ...     tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)]
        >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["500 rpm", "700 rpm"]},
        ...     excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}})
        >>> [(one.mode.number, one.order, one.generalised_force) for one in fan.critical_speeds().crossings]
        [(1, 2.0, 10.0)]
        """
        from torsionnet.solve.running.critical_speeds import critical_speeds

        return critical_speeds(
            self,
            outputs,
            speeds=speeds,
            speed_of=speed_of,
            excitations=excitations,
            lines=lines,
            margin=margin,
            reach=reach,
            lowest=lowest,
            line_frequency=line_frequency,
            dampers=dampers,
            damper_names=damper_names,
        )

    def holzer_table(
        self,
        mode: int | None = None,
        *,
        at: float | None = None,
        first: str | None = None,
        amplitude: float = 1.0,
        referred_to: str | None = None,
    ) -> HolzerTable:
        """Holzer table of a mode or trial frequency: amplitudes, torques and twists station by station, undamped.

        Parameters
        ----------
        mode : int, optional
            Number of the mode as in :meth:`modes`: 1 is the lowest vibration, rigid bodies and real poles have none.
        at : float, optional
            Instead, a trial frequency in Hz: a torque remains at the last station.
        first : str, optional
            The station to begin with; default: the first free end of the model.
        amplitude : float
            rad at the first station.
        referred_to : str, optional
            Node of the shaft that referred quantities belong to; default: the first station.

        Raises
        ------
        UsageError
            No such mode or node, or not one of mode and trial frequency.

        Examples
        --------
        >>> import torsionnet as tn
        >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
        ...     tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)]
        >>> fan = tn.Drivetrain("fan", elements)  # at 10 rad/s: 200 N m twist the shaft by 0.02 rad
        >>> round(fan.holzer_table(at=10 / 6.283185307179586).remainder, 9)
        298.0
        """
        from torsionnet.solve.modes.holzer import holzer_table

        return holzer_table(self, mode, at=at, first=first, amplitude=amplitude, referred_to=referred_to)

    def mass_elastic_table(self, referred_to: str | None = None) -> MassElasticTable:
        """Mass-elastic table of the drivetrain, inertias, shafts and damping, as they are and referred to one shaft.

        Parameters
        ----------
        referred_to : str, optional
            Node of the reference shaft; default: that of the model's ``speeds:``, else the first station.

        Raises
        ------
        UsageError
            No such node, or a controller acts on the drivetrain.

        Examples
        --------
        >>> import torsionnet as tn
        >>> found = tn.load("reciprocating_compressor_train").mass_elastic_table()  # flywheel: 140.45 / 2.96^2
        >>> round(found.rows[3].referred_inertia, 3), round(found.total_inertia, 2)
        (16.03, 43.1)
        """
        from torsionnet.solve.modes.mass_elastic_lines import mass_elastic_table

        return mass_elastic_table(self, referred_to)

    def static_state(self, speed: float | None = None) -> StaticState:
        """Mean torque, twist, nominal shear stress and power of every element at one speed.

        Parameters
        ----------
        speed : float, optional
            rad/s, of the node of the model's ``speeds:``; default: that of the operating point, else the rated one.

        Raises
        ------
        UsageError
            As for :meth:`mean_response`.

        Examples
        --------
        >>> import torsionnet as tn
        >>> elements = [tn.Inertia("engine", node="e", inertia=2), tn.Inertia("screw", node="p", inertia=1),
        ...     tn.Shaft("shaft", nodes=("e", "p"), outer_diameter="50 mm", length="2 m")]
        >>> boat = tn.Drivetrain("boat", elements, speeds={"of": "e", "list": [100], "rated": 100},
        ...     load={"absorbed_at": "p", "power": "100 kW", "torque_exponent": 2, "driven_by": {"e": 1}})
        >>> shaft = boat.static_state().of("shaft")
        >>> round(shaft.torque, 6), round(shaft.stress / 1e6, 3)
        (1000.0, 40.744)
        """
        from torsionnet.solve.running.static_state import static_state

        return static_state(self, speed)

    def power_balance(self, speed: float | None = None) -> PowerBalance:
        """Powers that drivers give and absorbers take at one speed, with the mean torques between them.

        Parameters
        ----------
        speed : float, optional
            rad/s, of the node of the model's ``speeds:``; default: as for :meth:`static_state`.

        Raises
        ------
        UsageError
            As for :meth:`mean_response`.

        Examples
        --------
        >>> import torsionnet as tn
        >>> found = tn.load("bulk_carrier").power_balance()
        >>> round(found.given / 1e3, 6), round(found.taken / 1e3, 6), round(found.torque / 1e3, 2)  # kW, kN*m
        (7000.0, 7000.0, 636.62)
        """
        from torsionnet.solve.running.power_balance import power_balance

        return power_balance(self, speed)

    def dissipated_power(
        self,
        elements: str | Iterable[str],
        *,
        speeds: ArrayLike | None = None,
        speed_of: str | None = None,
        excitations: Iterable[str] | None = None,
    ) -> DissipatedPower:
        """Mean power in W that vibration dissipates in elements, over speed.

        P = sum over frequencies of Re(T conj(dgamma/dt))/2: orders of one frequency are added as complex amplitudes
        first. T is the whole torque of the element, with its elastic and its damping part. Heat of a steady slip
        (a damper to ground in a turning machine) is not in it.

        Parameters
        ----------
        elements : str or iterable of str
            Springs, dampers, shafts, viscous dampers, compliant gears, ...
        speeds, speed_of, excitations
            As for :meth:`order_response`.

        Examples
        --------
        >>> import torsionnet as tn
        >>> elements = [tn.Inertia("rotor", node="a", inertia=2),
        ...     tn.HystereticSpring("rubber", nodes=("a", "ground"), stiffness=1e4, loss_factor=0.2)]
        >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["600 rpm"]},
        ...     excitations={"blades": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": "10 N*m"}}}})
        >>> twist = abs(fan.order_response("twist(rubber)").values[0, 0, 0])
        >>> w = 600 * 6.283185307179586 / 60
        >>> bool(abs(fan.dissipated_power("rubber").values[0, 0] - w * 0.2 * 1e4 * twist**2 / 2) < 1e-12)
        True
        """
        from torsionnet.solve.running.dissipation import dissipated_power

        return dissipated_power(self, elements, speeds=speeds, speed_of=speed_of, excitations=excitations)

    def check_limits(
        self,
        limits: str | Iterable[str] | None = None,
        *,
        speeds: ArrayLike | None = None,
        excitations: Iterable[str] | None = None,
        refine: bool | None = None,
    ) -> LimitCheck:
        """Verdicts on the model's limits over speed, and barred ranges.

        Parameters
        ----------
        limits : str or iterable of str, optional
            Names of limits of the model; default: all.
        speeds, excitations
            As for :meth:`order_response`.
        refine : bool, optional
            Whether speeds between these are examined as well, until the largest value over value allowed and the ends
            of ranges are known to 0.1 %; the result has them among its speeds. Default: yes, but for a model whose
            speeds are a list, which is all that is examined then.

        Raises
        ------
        UsageError
            The model has no limits, speeds or excitations, or unknown names.

        Examples
        --------
        >>> import torsionnet as tn
        >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
        ...     tn.Shaft("shaft", nodes=("a", "b"), outer_diameter="20 mm", length=1)]
        >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["600 rpm"]},
        ...     excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}},
        ...     limits={"shaft": {"rule": "curve", "output": "stress(shaft)", "value": "40 MPa", "source": "maker"}})
        >>> fan.check_limits().of("shaft").verdict
        'pass'
        """
        from torsionnet.solve.running.limit_check import check_limits

        return check_limits(self, limits, speeds=speeds, excitations=excitations, refine=refine)
