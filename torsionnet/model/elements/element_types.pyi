# Written by `make generate`.
from collections.abc import Mapping
from pathlib import Path, PurePath
from torsionnet.base.entries.accepted_types import Entries, GivenStateSpace, GivenTransferFunction, NumberByNumber, NumberRows, Scalar, Scalars, TwoNames, WholeNumber
from torsionnet.model.catalogues.catalogue import Catalogue, CatalogueRow
from torsionnet.model.damping import DampingMeasure
from torsionnet.model.element_base.control_entries import ControlLaw, SensedMotion
from torsionnet.model.element_base.spring_stage import SpringStage
from torsionnet.model.element_base.stiffness_table import StiffnessTable
from torsionnet.model.element_base.viscoelastic import FilmGap, ShearedBush, ShearedDisc, Viscoelastic
from torsionnet.model.sheets.mass_elastic_sheet import MassElasticSheet
from typing import Literal, overload
from torsionnet.model.elements.arc_spring import ArcSpring as _ArcSpring
from torsionnet.model.elements.loop_drives import Belt as _Belt
from torsionnet.model.elements.loop_drives import ChainDrive as _ChainDrive
from torsionnet.model.elements.contacts import Clearance as _Clearance
from torsionnet.model.elements.clutch import Clutch as _Clutch
from torsionnet.model.elements.loads import ConstantPowerLoad as _ConstantPowerLoad
from torsionnet.model.elements.continuous_shaft import ContinuousShaft as _ContinuousShaft
from torsionnet.model.elements.controller import Controller as _Controller
from torsionnet.model.elements.crank_throw import CrankThrow as _CrankThrow
from torsionnet.model.elements.masses_and_springs import Damper as _Damper
from torsionnet.model.elements.gears import Differential as _Differential
from torsionnet.model.elements.dual_mass_flywheel import DualMassFlywheel as _DualMassFlywheel
from torsionnet.model.elements.gearboxes import FinalDrive as _FinalDrive
from torsionnet.model.elements.flexible_couplings import FlexibleCoupling as _FlexibleCoupling
from torsionnet.model.elements.fluid_couplings import FluidCoupling as _FluidCoupling
from torsionnet.model.elements.contacts import Friction as _Friction
from torsionnet.model.elements.gears import Gear as _Gear
from torsionnet.model.elements.gearboxes import Gearbox as _Gearbox
from torsionnet.model.elements.electric_machines import GridGenerator as _GridGenerator
from torsionnet.model.elements.flexible_couplings import HystereticSpring as _HystereticSpring
from torsionnet.model.elements.electric_machines import InductionMachine as _InductionMachine
from torsionnet.model.elements.masses_and_springs import Inertia as _Inertia
from torsionnet.model.elements.masses_and_springs import Lock as _Lock
from torsionnet.model.elements.lumped_matrices import LumpedMatrices as _LumpedMatrices
from torsionnet.model.elements.mass_elastic import MassElastic as _MassElastic
from torsionnet.model.elements.dampers import PendulumAbsorber as _PendulumAbsorber
from torsionnet.model.elements.gears import Planetary as _Planetary
from torsionnet.model.elements.loads import Propeller as _Propeller
from torsionnet.model.elements.gears import RigidCoupling as _RigidCoupling
from torsionnet.model.elements.shaft import Shaft as _Shaft
from torsionnet.model.elements.masses_and_springs import Spring as _Spring
from torsionnet.model.elements.dampers import SpringDamper as _SpringDamper
from torsionnet.model.elements.electric_machines import SynchronousMachine as _SynchronousMachine
from torsionnet.model.elements.flexible_couplings import TabulatedSpring as _TabulatedSpring
from torsionnet.model.elements.fluid_couplings import TorqueConverter as _TorqueConverter
from torsionnet.model.elements.dampers import TunedDamper as _TunedDamper
from torsionnet.model.elements.vehicles import Tyre as _Tyre
from torsionnet.model.elements.vehicles import Vehicle as _Vehicle
from torsionnet.model.elements.dampers import ViscousDamper as _ViscousDamper

class ArcSpring(_ArcSpring):
    r"""Arc springs in a curved channel, which rub under their centrifugal force and the spring force turned with them.

    With C = m r^2 Omega^2, u = T + C/psi and e = mu psi the torque falls along sliding coils as du/ds = -e u over the
    share s of the arc. A swing of amplitude a about a mean torque moves the coils to a depth z and locks those beyond.
    Linear results take the first harmonic of the slow loop at the amplitude ``swing``, k' + j k'': while coils are
    locked k''/k' = 1/2, and the secant stiffness is k_s = 3 pi/8 k', its loss factor 4/(3 pi). Both fall with the
    root of the swing and rise with mean torque and speed. Where the flange leaves the springs in a cycle, a chain of
    segments with Coulomb's friction is marched instead.

    ``torque`` and ``speed`` follow the operating point as parameters ``by: mean_torque`` and ``by: speed``; ``swing``
    follows the vibration as one ``by: vibratory_torque`` with a table. Loops are slow, far below sqrt(k/J)/2 in Hz with
    J = m r^2, the first frequency of coils without friction: at a third of it k' is some 6 % below. Over time, beside
    other laws of motion or from a given start, a chain of segments without mass has this friction, as many as give the
    loss of a cycle of ``swing`` about ``torque`` to 1 %.

    Parameters
    ----------
    nodes: the two nodes it connects, one may be ground; twist is the angle of the first minus the second
    stiffness: stiffness of all arc springs without friction [N*m/rad]
    arc_angle: angle on which a spring lies [rad]
    friction_coefficient: between springs and channel
    spring_mass: mass of all arc springs [kg]
    spring_radius: radius on which they lie [m]
    speed: speed that presses them outward [rad/s]
    torque: mean torque about which they swing [N*m]
    swing: amplitude of the twist [rad]
    damping: viscous damping in parallel [N*m*s/rad]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        stiffness: Scalar,
        arc_angle: Scalar,
        friction_coefficient: Scalar,
        spring_mass: Scalar,
        spring_radius: Scalar,
        speed: Scalar,
        torque: Scalar,
        swing: Scalar,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        stiffness: Scalar | None,
        arc_angle: Scalar | None,
        friction_coefficient: Scalar | None,
        spring_mass: Scalar | None,
        spring_radius: Scalar | None,
        speed: Scalar | None,
        torque: Scalar | None,
        swing: Scalar | None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Belt(_Belt):
    r"""A belt over two pulleys or more, rigid or with elastic spans, and with a tensioner arm if wanted.

    The belt runs over the pulleys in the order given and back to the first. A span from pulley i to j of stiffness
    k = E A / L, in N/m, gets shorter by r_i theta_i - r_j theta_j: row (r_i theta_i - r_j theta_j) / r_1 with the
    stiffness k r_1^2, so that its torque is that on the first pulley. Two pulleys have two spans in parallel, as a gear
    of ratio r_2 / r_1 whose teeth have (k_1 + k_2) r_1^2. A rigid belt is a rigid gear. A radius is negative where the
    back of the belt runs over the pulley, which then turns in the other sense. An arm that turns by phi makes the spans
    before and after its pulley longer by a phi, each with its own lever a = l cos(beta): l is the length of the arm,
    beta the angle between span and way of the pulley's centre. Inertia and spring of the arm are elements of their own
    on its node. Slip and creep are left out (R. S. Beikmann, N. C. Perkins, A. G. Ulsoy, Free vibration of serpentine
    belt drive systems, J. Vib. Acoust. 118, 1996, with the rotations of the pulleys alone).

    Parameters
    ----------
    pulleys: radius by node in the order of the run, negative where the back of the belt drives
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    stiffness: stiffness of each span, from each wheel to the next and from the last to the first
    axial_stiffness: instead: force per strain E A, with the lengths [N]
    lengths: free lengths of the spans in the same order, for axial_stiffness
    damping: damping of each span, referred to the first wheel, or a measure [N*m*s/rad]
    pretension: force in the spans at rest; the model holds while none gets slack [N]
    tensioner: the node of the wheel on a tensioner arm
    arm: the node of that arm, which turns about its pivot
    levers: by how much the spans before and after the tensioner's wheel get longer per radian of the arm
    housing: the node that carries the bearings, if it moves
    """
    @overload
    def __init__(
        self,
        name: str,
        pulleys: Mapping[str, Scalar] | tuple[tuple[str, Scalar], ...],
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
        stiffness: Scalars | None = None,
        axial_stiffness: Scalar | None = None,
        lengths: Scalars | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        pretension: Scalar | None = None,
        tensioner: str | None = None,
        arm: str | None = None,
        levers: Scalars | None = None,
        housing: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        pulleys: Mapping[str, Scalar] | tuple[tuple[str, Scalar], ...] | None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
        stiffness: Scalars | None = None,
        axial_stiffness: Scalar | None = None,
        lengths: Scalars | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        pretension: Scalar | None = None,
        tensioner: str | None = None,
        arm: str | None = None,
        levers: Scalars | None = None,
        housing: str | None = None,
    ) -> None: ...

class ChainDrive(_ChainDrive):
    r"""A chain, or a toothed belt, over two sprockets or more: ratios by counts of teeth, spans rigid or elastic.

    As for ``belt``, with radii r_i = z_i p / (2 pi) from the counts of teeth z_i and the pitch p; the ratios z_i / z_1
    are exact. The count is negative where the outside of the chain drives the sprocket. The polygon effect is left out.
    A chain has a tight span and one that sags: give the slack span its own, small stiffness.

    Parameters
    ----------
    sprockets: teeth by node in the order of the run, negative where the outside of the chain drives
    pitch: pitch of the chain, for elastic spans [m]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    stiffness: stiffness of each span, from each wheel to the next and from the last to the first
    axial_stiffness: instead: force per strain E A, with the lengths [N]
    lengths: free lengths of the spans in the same order, for axial_stiffness
    damping: damping of each span, referred to the first wheel, or a measure [N*m*s/rad]
    pretension: force in the spans at rest; the model holds while none gets slack [N]
    tensioner: the node of the wheel on a tensioner arm
    arm: the node of that arm, which turns about its pivot
    levers: by how much the spans before and after the tensioner's wheel get longer per radian of the arm
    housing: the node that carries the bearings, if it moves
    """
    @overload
    def __init__(
        self,
        name: str,
        sprockets: Mapping[str, Scalar] | tuple[tuple[str, Scalar], ...],
        pitch: Scalar | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
        stiffness: Scalars | None = None,
        axial_stiffness: Scalar | None = None,
        lengths: Scalars | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        pretension: Scalar | None = None,
        tensioner: str | None = None,
        arm: str | None = None,
        levers: Scalars | None = None,
        housing: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        sprockets: Mapping[str, Scalar] | tuple[tuple[str, Scalar], ...] | None,
        pitch: Scalar | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
        stiffness: Scalars | None = None,
        axial_stiffness: Scalar | None = None,
        lengths: Scalars | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        pretension: Scalar | None = None,
        tensioner: str | None = None,
        arm: str | None = None,
        levers: Scalars | None = None,
        housing: str | None = None,
    ) -> None: ...

class Clearance(_Clearance):
    r"""A clearance, as of splines, claws or teeth: no torque while -gap/2 < gamma < gap/2, contact beyond.

    The law of motion at a penetration d > 0 is T = max(0, k d + c d'), with d = gamma - gap/2 and d' = gamma' on the
    positive side; the negative side is its mirror image. Contact pushes and never pulls: where k d + c d' is below
    zero the bodies part though d > 0.

    Linear results take the slope at the operating point: k and c in contact, nothing in the gap, where the two sides
    move freely against each other. Without an operating point gamma is 0.

    Parameters
    ----------
    nodes: the two nodes it connects, one may be ground; twist is the angle of the first minus the second
    gap: whole free angle, from one contact to the other [rad]
    stiffness: stiffness in contact [N*m/rad]
    damping: viscous damping in contact, or a damping measure at a frequency [N*m*s/rad]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        gap: Scalar,
        stiffness: Scalar,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        gap: Scalar | None,
        stiffness: Scalar | None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Clutch(_Clutch):
    r"""A friction clutch between two shafts, with the torsion springs of its disc if they are given.

    Closed, its friction faces turn as one; open, they pass on drag alone. Slipping, they pass on a torque T(n) of the
    slip n = omega_first - omega_disc, and small vibrations feel its slope c = dT/dn at ``slip_speed``: T is a table, or
    the friction coefficient mu(n) times the torque T_1 at a coefficient of one (clamp force times mean radius times
    number of faces). Straight lines join the rows; at a row the piece above it counts; rows from slip 0 on hold both
    ways, T(-n) = -T(n). Where friction falls with slip, c is negative: the clutch feeds vibrations (judder), and a mode
    is unstable that has less damping otherwise (A. Crowther, N. Zhang, D. K. Liu, J. K. Jeyakumaran, Analysis and
    simulation of clutch engagement judder and stick-slip in automotive powertrain systems, Proc. IMechE D 218, 2004).
    With a stiffness, the springs stand between the faces and the second node; ``NAME.disc`` is the node of the disc.

    T(n) is its law of motion in time: where the slip comes to an end the faces stick, while the torque that equilibrium
    asks for is at most T(0), or ``stick``, the torque at which they break away; with ``friction`` that is at T_1 of the
    file, and follows the clamp force. A scenario may give T_1 over time, as ``clamp``. Without ``slip_speed`` linear
    results take the slip at the operating point; the clutch sticks, as a closed one, unless that lets it slip.

    Parameters
    ----------
    nodes: the two nodes it connects, the driving one first; twist is first minus second
    state: what its friction faces do
    slip_speed: slipping: speed of the first node minus that of the disc; default: that of the operating point
        [rad/s]
    torque: slipping: rows [slip speed, torque]
    friction: slipping, instead: rows [slip speed, friction coefficient]
    clamp_torque: torque at a friction coefficient of one [N*m]
    stick: greatest torque while it sticks; default: that at slip zero [N*m]
    drag: viscous drag when open [N*m*s/rad]
    stiffness: stiffness of the springs of the disc; none: rigid [N*m/rad]
    damping: viscous damping in parallel to the springs [N*m*s/rad]
    first_inertia: inertia on the first node, as a cover [kg*m^2]
    disc_inertia: inertia of the disc with its facings [kg*m^2]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        state: Literal['closed', 'open', 'slipping'] = 'closed',
        slip_speed: Scalar | None = None,
        torque: NumberRows | None = None,
        friction: NumberRows | None = None,
        clamp_torque: Scalar | None = None,
        stick: Scalar | None = None,
        drag: Scalar = 0,
        stiffness: Scalar | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        first_inertia: Scalar = 0,
        disc_inertia: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class ConstantPowerLoad(_ConstantPowerLoad):
    r"""A load that takes the power P at any speed, as a generator behind a fast converter: negative damping.

    Its torque P/omega falls with the speed, so that small changes of speed are driven: dT/domega = -P/omega^2. A
    machine of negative power feeds a constant one in; that damps. The speed is that of the node against its housing,
    at which P is taken; it may be a parameter that follows the operating point.

    P/omega is its law of motion in time, over the absolute speed. Without ``speed`` linear results take the slope at
    the operating point; without one the load does nothing.

    Parameters
    ----------
    node: the node it turns with
    power: power that it takes; negative: that it gives [W]
    speed: speed at which it takes it; default: that of the operating point [rad/s]
    housing: the node that takes its torque
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        power: Scalar,
        speed: Scalar | None = None,
        housing: str = 'ground',
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        power: Scalar | None,
        speed: Scalar | None = None,
        housing: str = 'ground',
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class ContinuousShaft(_ContinuousShaft):
    r"""A uniform round shaft, solid or hollow, by the exact solution of the wave equation: no segments.

    With k = G I_p / L, J = rho I_p L, I_p = pi (D^4 - d^4) / 32 and x = omega sqrt(J/k) = omega L sqrt(rho/G), the
    torques into its ends are k x cot x on the own angle and -k x / sin x on the other one. It has infinitely many
    modes; those of a drivetrain are counted by the algorithm of Wittrick and Williams (1971), so that none is missed.
    A loss factor makes the shear modulus G (1 + j eta). Shafts with steps or a taper are several in series.

    An inner node ``NAME.inside`` at 0.382 L shows how it moves between its ends, also where these stand still. Each of
    the two pieces, with its own length in K = k (1 + j eta) and in x, is a spring K x / sin x between its ends, and
    -K x tan(x/2) on each of them.

    Parameters
    ----------
    nodes: its two ends; twist is the angle of the first minus the second
    outer_diameter: outer diameter [m]
    length: length [m]
    shear_modulus: shear modulus [Pa]
    density: density [kg/m^3]
    inner_diameter: inner diameter, 0 for a solid shaft [m]
    loss_factor: loss factor of the material, or another frequency-free damping measure
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        outer_diameter: Scalar,
        length: Scalar,
        shear_modulus: Scalar = '79.3 GPa',
        density: Scalar = '7850 kg/m^3',
        inner_diameter: Scalar = 0,
        loss_factor: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        outer_diameter: Scalar | None,
        length: Scalar | None,
        shear_modulus: Scalar = '79.3 GPa',
        density: Scalar = '7850 kg/m^3',
        inner_diameter: Scalar = 0,
        loss_factor: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Controller(_Controller):
    r"""A controlled torque: governor, active damper, anti-jerk control, load of a test rig.

    The torque T(s) = H(s) e^(-s tau) y(s) drives the first node of ``act`` and reacts on the second, or on ground; y is
    the angle, velocity or acceleration of a node, or of one node against another. It is positive where it drives, so a
    controller that opposes what it senses has a negative law: ``-300 N*m*s/rad`` on a velocity damps like a damper of
    300 N m s/rad. y is the deviation from the set point, which itself is constant.

    The law H is a gain; ``{p, i, d, filter}``, p + i/s + d s/(1 + filter s); ``{numerator, denominator}``,
    coefficients with the highest power of s first; ``{zeros, poles, gain}`` in rad/s, a complex pair as [re, im]; or
    ``{A, B, C, D}``. Coefficients of the last three are in SI units, numbers or expressions of parameters. In Python it
    may be a ``TransferFunction`` or ``StateSpace`` of python-control. Such an element takes or gives energy at will: a
    drivetrain with one need not be stable (K. J. Astrom and R. M. Murray, Feedback Systems, 2nd ed., chapter 10).

    Parameters
    ----------
    sense: what it senses: {velocity: node}, or {velocity: [node, node]}; angle, acceleration
    act: the node it drives, or [node, housing] with the one on which the torque reacts
    law: torque per sensed motion H(s): a gain, PID, polynomials, roots or matrices
    delay: delay of the torque [s]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        sense: SensedMotion | Mapping[str, str | TwoNames],
        act: str | TwoNames,
        law: Scalar | ControlLaw | GivenTransferFunction | GivenStateSpace | Entries,
        delay: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        sense: SensedMotion | Mapping[str, str | TwoNames] | None,
        act: str | TwoNames | None,
        law: Scalar | ControlLaw | GivenTransferFunction | GivenStateSpace | Entries | None,
        delay: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class CrankThrow(_CrankThrow):
    r"""Throw of a crankshaft, from the middle of it to the middle of the next one.

    The inertia is at the first node: that of the throw itself, of a mass m_r that turns with the pin (the big end) and
    of the masses m_o that move with the piston, averaged over a revolution:

        J + r^2 (m_r + m_o (1/2 + lambda^2/8)),    lambda = r/l,

    r the radius of the crank and l the length of the connecting rod; terms of lambda^4 are left out. The stiffness to
    the next throw is given, or is that of one journal, one pin and two webs, each as a beam that its bearings leave
    free: the torque twists journal and pin and bends the webs in their plane,

        1/k = L_j/(G I_j) + L_p/(G I_p) + 2 r/(E I_w),
        I = pi (D^4 - d^4)/32,    I_w = h b^3/12,

    with the width b and the thickness h of the web. Journal and pin twist some way into the webs: add that to their
    lengths. Bearings without play make a real crankshaft stiffer, so that measured values come first.

    Parameters
    ----------
    nodes: the throw, where its inertia is, and the next station; twist is first minus second
    inertia: inertia of journal, webs, pin and counterweights [kg*m^2]
    stiffness: stiffness to the next station [N*m/rad]
    crank_radius: radius of the crank, half the stroke [m]
    rotating_mass: mass that turns with the pin [kg]
    reciprocating_mass: mass that moves with the piston [kg]
    rod_length: length of the connecting rod; none: very long [m]
    journal_diameter: for the stiffness instead: diameter of the journal [m]
    journal_length: length of the journal that twists [m]
    pin_diameter: diameter of the pin [m]
    pin_length: length of the pin that twists [m]
    web_width: width of the web, across the crank [m]
    web_thickness: thickness of the web, along the shaft [m]
    journal_bore: bore of the journal [m]
    pin_bore: bore of the pin [m]
    shear_modulus: shear modulus [Pa]
    elastic_modulus: modulus of elasticity [Pa]
    damping: viscous damping in its twist [N*m*s/rad]
    cylinder_damping: damping of the cylinder, against the engine block as ground [N*m*s/rad]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        inertia: Scalar,
        stiffness: Scalar | None = None,
        crank_radius: Scalar | None = None,
        rotating_mass: Scalar = 0,
        reciprocating_mass: Scalar = 0,
        rod_length: Scalar | None = None,
        journal_diameter: Scalar | None = None,
        journal_length: Scalar | None = None,
        pin_diameter: Scalar | None = None,
        pin_length: Scalar | None = None,
        web_width: Scalar | None = None,
        web_thickness: Scalar | None = None,
        journal_bore: Scalar = 0,
        pin_bore: Scalar = 0,
        shear_modulus: Scalar = '79.3 GPa',
        elastic_modulus: Scalar = '206 GPa',
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        cylinder_damping: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        inertia: Scalar | None,
        stiffness: Scalar | None = None,
        crank_radius: Scalar | None = None,
        rotating_mass: Scalar = 0,
        reciprocating_mass: Scalar = 0,
        rod_length: Scalar | None = None,
        journal_diameter: Scalar | None = None,
        journal_length: Scalar | None = None,
        pin_diameter: Scalar | None = None,
        pin_length: Scalar | None = None,
        web_width: Scalar | None = None,
        web_thickness: Scalar | None = None,
        journal_bore: Scalar = 0,
        pin_bore: Scalar = 0,
        shear_modulus: Scalar = '79.3 GPa',
        elastic_modulus: Scalar = '206 GPa',
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        cylinder_damping: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Damper(_Damper):
    r"""A viscous damper: torque c dgamma/dt.

    Parameters
    ----------
    nodes: the two nodes it connects, one may be ground; twist is the angle of the first minus the second
    damping: viscous damping [N*m*s/rad]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        damping: Scalar,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        damping: Scalar | None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Differential(_Differential):
    r"""A differential: 2 theta_cage = theta_left + theta_right when open; locked, all three turn as one.

    Parameters
    ----------
    cage: the node of the cage
    left: the node of the left output
    right: the node of the right output
    locked: whether both outputs are locked to the cage
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    def __init__(
        self,
        name: str,
        cage: str,
        left: str,
        right: str,
        locked: bool = False,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class DualMassFlywheel(_DualMassFlywheel):
    r"""A dual mass flywheel: J_1 and J_2 with arc springs and friction between them.

    The springs have a stiffness k, or stages T(gamma) as those of ``spring``; linear results take the stage which the
    mean ``torque`` has brought into force, without it the torque of the operating point. A share b of the coils that
    friction holds fast at the swing in question leaves k/(1 - b).
    Friction M loses 4 M alpha in a cycle of swing alpha, which a loss factor 4 M/(pi k alpha) loses too (harmonic
    balance; J. P. Den Hartog, Mechanical Vibrations, 4th ed., chapter 8), so that the law is
    k (1 + j (eta + 4 M/(pi k alpha))) + c s. M is the basic friction and that of springs pressed outward against
    their channel, M = M_0 + mu m r^2 Omega^2, m and r the mass and radius of all of them.

    With an ``arc_angle`` psi the springs are those of ``arc_spring``: friction grows with the spring force as well,
    ``blocked`` follows from the swing, and ``torque``, ``swing`` and the entries of pressed springs give k' and k''/k'
    in place of k and M. A lumped friction M cannot do this: its loss 4 M alpha is in proportion to the swing, and
    nothing at standstill; that of arc springs grows with alpha^1.5 and with the torque, and their stiffness falls.

    Its law of motion in time is T(gamma/(1 - b)) + M sgn(gamma') + c gamma'; at rest the friction takes any torque from
    -M to M beside the springs. A loss factor has no motion in time: give the losses as friction and damping. Small
    vibrations that friction holds do not move the springs at all, so that without ``swing`` linear results take a
    flywheel with friction as rigid.

    Parameters
    ----------
    nodes: primary and secondary side; twist is the angle of the first minus the second
    primary_inertia: inertia of the primary side [kg*m^2]
    secondary_inertia: inertia of the secondary side [kg*m^2]
    stiffness: stiffness of the arc springs at the working point [N*m/rad]
    stages: instead: stages of the springs, each up to a torque or an angle
    torque: mean torque, which tells the stage; default: by the operating point [N*m]
    blocked: share of the coils that friction holds fast
    loss_factor: loss factor of the springs, or another measure of it
    damping: viscous damping in parallel [N*m*s/rad]
    friction: basic friction [N*m]
    swing: amplitude of the twist, for friction; none: friction holds the springs [rad]
    friction_coefficient: between springs and channel
    spring_mass: mass of all arc springs [kg]
    spring_radius: radius on which they lie [m]
    speed: speed that presses them outward [rad/s]
    arc_angle: angle on which a spring lies, for friction that grows with its force [rad]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        primary_inertia: Scalar,
        secondary_inertia: Scalar,
        stiffness: Scalar | None = None,
        stages: tuple[SpringStage | Entries, ...] | list[SpringStage | Entries] | None = None,
        torque: Scalar | None = None,
        blocked: Scalar = 0,
        loss_factor: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        friction: Scalar = 0,
        swing: Scalar | None = None,
        friction_coefficient: Scalar | None = None,
        spring_mass: Scalar | None = None,
        spring_radius: Scalar | None = None,
        speed: Scalar | None = None,
        arc_angle: Scalar | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        primary_inertia: Scalar | None,
        secondary_inertia: Scalar | None,
        stiffness: Scalar | None = None,
        stages: tuple[SpringStage | Entries, ...] | list[SpringStage | Entries] | None = None,
        torque: Scalar | None = None,
        blocked: Scalar = 0,
        loss_factor: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        friction: Scalar = 0,
        swing: Scalar | None = None,
        friction_coefficient: Scalar | None = None,
        spring_mass: Scalar | None = None,
        spring_radius: Scalar | None = None,
        speed: Scalar | None = None,
        arc_angle: Scalar | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class FinalDrive(_FinalDrive):
    r"""Pinion and crown wheel, and the differential whose cage the crown wheel is bolted to.

    Mesh row theta_pinion - tau theta_cage (+ (tau - 1) theta_housing) with tau = omega_pinion / omega_cage: held at
    zero, or by the stiffness of the teeth. Differential: 2 theta_cage = theta_left + theta_right; locked, all three
    turn as one; limited-slip, a damping c_s resists theta_left - theta_right besides, as a viscous coupling does, or
    plates whose torque rises with the difference of speeds (for small vibrations; one whose plates stick is locked).
    The cage is the node ``NAME.cage``, or one with a name of its own where a second pinion meshes with the crown wheel.
    The equations are those of ``gear`` and ``differential``.

    Parameters
    ----------
    pinion: the node of the pinion
    left: the node of the left output
    right: the node of the right output
    ratio: speed of the pinion over speed of the cage
    teeth: teeth counts [pinion, crown wheel]; one negative: opposite senses
    cage: a node for the cage, where another element meshes with it
    differential: what the differential does
    slip_damping: limited-slip: torque between the outputs per difference of their speeds [N*m*s/rad]
    pinion_inertia: inertia of the pinion [kg*m^2]
    cage_inertia: inertia of crown wheel and cage [kg*m^2]
    stiffness: mesh stiffness referred to the pinion; none: rigid [N*m/rad]
    damping: mesh damping referred to the pinion [N*m*s/rad]
    housing: the node of the housing, if it moves
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    def __init__(
        self,
        name: str,
        pinion: str,
        left: str,
        right: str,
        ratio: Scalar | None = None,
        teeth: tuple[int, int] | list[int] | None = None,
        cage: str | None = None,
        differential: Literal['open', 'locked', 'limited-slip'] = 'open',
        slip_damping: Scalar | None = None,
        pinion_inertia: Scalar = 0,
        cage_inertia: Scalar = 0,
        stiffness: Scalar | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        housing: str | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class FlexibleCoupling(_FlexibleCoupling):
    r"""A flexible coupling by its maker's sheet, at a working point; or by the material of its rubber.

    The dynamic stiffness is k = k_0 S_T(T) S_A(T_W) S_t(t) n_p/n_s: k_0 as given or read off its curve over the mean
    torque T, factors over T, over the vibratory torque T_W and over the temperature t of the rubber, and n_s groups in
    series of n_p couplings in parallel. The damping is a loss factor, k (1 + j eta S_d(t)); the relative damping of
    the sheets is psi = 2 pi eta, written {psi: 0.9}; or a viscous damping c of one coupling. Curves are straight
    between their rows; over torque these are torques, or shares of T_KN. What is read off may be a parameter, so that
    the coupling follows the mean torque (``by: mean_torque``). Curves over frequency multiply k and replace eta.

    Of a material, k (1 + j eta) = S (G' + j G'') with the factor S of a disc in shear, pi (r_o^4 - r_i^4)/(2 t), or of
    a bush, 4 pi L/(1/r_i^2 - 1/r_o^2), at f by time-temperature superposition; ``scale`` multiplies it, for rubber of
    another hardness, or in a fit.

    Terms as in DIN 740-2 (1986) and ISO 14691 (2008).

    Parameters
    ----------
    nodes: the two halves; twist is the angle of the first minus the second
    stiffness: dynamic stiffness of one coupling [N*m/rad]
    stiffness_over_torque: instead: dynamic stiffness over mean torque
    loss_factor: loss factor, or another measure as {psi: 0.9}
    damping: instead: viscous damping of one coupling [N*m*s/rad]
    T_KN: nominal torque, of which rows are shares [N*m]
    torque: mean torque at the working point [N*m]
    vibratory_torque: amplitude at the working point [N*m]
    temperature: temperature of the rubber [K]
    torque_factor: S_T, k over k_0
    amplitude_factor: S_A, k over k_0
    temperature_factor: S_t, k over k_0
    damping_temperature_factor: S_d, of the loss factor
    frequency_factor: k over k_0
    loss_over_frequency: loss factor
    material: rubber: its moduli
    geometry: rubber: its shape
    scale: factor on the moduli of the material
    in_series: n_s, groups in series
    in_parallel: n_p, couplings in parallel in each group
    first_inertia: inertia that turns with the first node [kg*m^2]
    second_inertia: inertia that turns with the second node [kg*m^2]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        stiffness: Scalar | None = None,
        stiffness_over_torque: NumberByNumber | None = None,
        loss_factor: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        T_KN: Scalar | None = None,
        torque: Scalar | None = None,
        vibratory_torque: Scalar | None = None,
        temperature: Scalar | None = None,
        torque_factor: NumberByNumber | None = None,
        amplitude_factor: NumberByNumber | None = None,
        temperature_factor: NumberByNumber | None = None,
        damping_temperature_factor: NumberByNumber | None = None,
        frequency_factor: NumberByNumber | None = None,
        loss_over_frequency: NumberByNumber | None = None,
        material: Viscoelastic | Entries | None = None,
        geometry: ShearedDisc | ShearedBush | Entries | None = None,
        scale: Scalar | None = None,
        in_series: WholeNumber = 1,
        in_parallel: WholeNumber = 1,
        first_inertia: Scalar = 0,
        second_inertia: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class FluidCoupling(_FluidCoupling):
    r"""A fluid (Foettinger) coupling: pump and turbine pass on one torque T = C(nu) omega_p^2, nu = omega_t / omega_p.

    C is lambda rho D^5 with the performance coefficient lambda(nu), the torque at a test speed over its square, or
    1/K^2 with the K factor omega_p / sqrt(T). Small changes of the speeds change it by dT = omega_p (2 C - nu C')
    domega_p + omega_p C' domega_t: a damper -omega_p C' between pump and turbine, and a torque omega_p (2 C + (1 - nu)
    C') on both that follows the speed of the pump alone, so that the coupling acts one way more than the other. Tables
    are straight between their rows; at a row the piece above it counts. The oil follows without delay here, and what
    of it turns along belongs to the inertias (VDI 2153, Hydrodynamic power transmission).

    T is its law of motion in time, over absolute speeds. Without ``speed`` and ``speed_ratio`` linear results take its
    slopes at the operating point; without one the coupling stands and passes on nothing.

    Parameters
    ----------
    pump: the node of the pump
    turbine: the node of the turbine
    speed: speed of the pump at the operating point; default: as that says [rad/s]
    speed_ratio: speed of the turbine over that of the pump at the operating point
    pump_torque: rows [speed ratio, pump torque at test_speed]
    test_speed: speed of the pump that pump_torque was measured at [rad/s]
    performance: instead: rows [speed ratio, performance coefficient lambda]
    diameter: diameter of the circuit, for performance [m]
    density: density of the oil, for performance [kg/m^3]
    k_factor: instead: rows [speed ratio, K factor in (r/min)/sqrt(N*m)]
    pump_inertia: inertia of the pump with its oil [kg*m^2]
    turbine_inertia: inertia of the turbine with its oil [kg*m^2]
    housing: the node against which both turn, and that carries a stator
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    def __init__(
        self,
        name: str,
        pump: str,
        turbine: str,
        speed: Scalar | None = None,
        speed_ratio: Scalar | None = None,
        pump_torque: NumberRows | None = None,
        test_speed: Scalar | None = None,
        performance: NumberRows | None = None,
        diameter: Scalar | None = None,
        density: Scalar = '840 kg/m^3',
        k_factor: NumberRows | None = None,
        pump_inertia: Scalar = 0,
        turbine_inertia: Scalar = 0,
        housing: str = 'ground',
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Friction(_Friction):
    r"""Dry friction, as of seals, bearings, brakes and friction rings: T sgn(gamma') while it slips.

    The torque T is constant (Coulomb), or follows rows over the slip speed \|gamma'\|, joined by straight lines. While
    it sticks, gamma' = 0 and the torque is what equilibrium asks for, up to the torque ``stick``, T_s, by default that
    at slip zero.

    With a ``stiffness`` k it is a Jenkins element: the friction stands behind a spring, k (gamma - gamma_s), whose
    other end ``NAME.slider`` has no inertia and slides on the second node.

    Linear results take it as stuck unless the operating point lets it slip: a rigid connection, or the spring k.
    Slipping, they have the slope dT/dgamma' at the slip, which is 0 for a constant torque and below zero where the
    torque falls: then it feeds vibrations (stick-slip, squeal).

    Parameters
    ----------
    nodes: the two nodes it connects, one may be ground; twist is the angle of the first minus the second
    torque: torque while it slips [N*m]
    stick: greatest torque while it sticks; default: that at slip zero [N*m]
    torque_over_slip: instead of torque: rows [slip speed, torque] from slip zero on, which hold both ways
    stiffness: stiffness of a spring before the friction; none: rigid [N*m/rad]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        torque: Scalar | None = None,
        stick: Scalar | None = None,
        torque_over_slip: NumberRows | None = None,
        stiffness: Scalar | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Gear(_Gear):
    r"""A gear stage of ratio tau = omega_first / omega_second = z_second / z_first, negative for opposite senses.

    Row gamma = theta_first - tau theta_second (+ (tau - 1) theta_housing): held at zero by a rigid mesh; a compliant
    one stores 1/2 k (theta_first - tau theta_second)^2.

    With a ``backlash`` b, the whole angle that the first shaft turns freely while the second is held, the compliant
    mesh has the law of motion of a clearance: no torque while -b/2 < gamma < b/2, and beyond it max(0, k d + c d') at
    the penetration d = gamma - b/2, with its mirror image on the other side. Linear results take k and c where the
    operating point presses the teeth together; without one the teeth stand free in their backlash.

    Parameters
    ----------
    nodes: the two shafts; the ratio is speed of the first over speed of the second
    ratio: speed of the first node over speed of the second
    teeth: teeth counts [first, second], ratio = second/first; one negative: opposite senses
    stiffness: mesh stiffness referred to the first node; none: rigid [N*m/rad]
    damping: mesh damping referred to the first node [N*m*s/rad]
    housing: the node of the housing, if it moves
    backlash: free angle of the first shaft with the second held; none: 0 [rad]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        ratio: Scalar | None = None,
        teeth: tuple[int, int] | list[int] | None = None,
        stiffness: Scalar | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        housing: str | None = None,
        backlash: Scalar | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Gearbox(_Gearbox):
    r"""A gearbox of spur gears: every pair stays in mesh, and a synchroniser joins one loose wheel to its shaft.

    Pair i has the ratio tau_i = omega_input / omega_output = z_output / z_input, negative for opposite senses. One of
    its wheels is fast on its shaft, the other is loose: on the output shaft (then the input shaft drives the loose
    wheels) or on the input shaft. Mesh row, with the loose wheel i on the output shaft: theta_input - tau_i theta_i
    (+ (tau_i - 1) theta_housing); on the input shaft: theta_i - tau_i theta_output (+ ...). It is held at zero, or by
    the stiffness of the teeth, referred to the input. The engaged wheel turns with its shaft; all others run along, so
    that the input shaft feels J_i / tau_i^2 of each loose wheel on the output shaft. In neutral no wheel is engaged.
    The node of wheel i is ``NAME.i``, as ``box.II``: its vibration makes loose gears rattle. Fast wheels belong to the
    inertias of the shafts (H. Naunheimer et al., Automotive Transmissions, 2nd ed.).

    Parameters
    ----------
    input: the node of the input shaft
    output: the node of the output shaft
    ratios: speed of the input over speed of the output by gear, negative for opposite senses
    teeth: instead: teeth counts [input, output] by gear, one negative for opposite senses
    engaged: the gear that is engaged, or neutral
    loose_wheels: the shaft with the loose wheels and synchronisers
    wheel_inertias: inertia of the loose wheels by gear
    input_inertia: input shaft with its fast wheels [kg*m^2]
    output_inertia: output shaft with its fast wheels [kg*m^2]
    stiffness: mesh stiffness by gear, referred to the input; none: rigid
    damping: damping of each elastic mesh, referred to the input [N*m*s/rad]
    housing: the node of the housing, if it moves
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    def __init__(
        self,
        name: str,
        input: str,
        output: str,
        ratios: Mapping[str, Scalar] | tuple[tuple[str, Scalar], ...] | None = None,
        teeth: Mapping[str, tuple[int, int] | list[int]] | tuple[tuple[str, tuple[int, int] | list[int]], ...] | None = None,
        engaged: str | None = None,
        loose_wheels: Literal['output', 'input'] = 'output',
        wheel_inertias: Mapping[str, Scalar] | tuple[tuple[str, Scalar], ...] | None = None,
        input_inertia: Scalar = 0,
        output_inertia: Scalar = 0,
        stiffness: Mapping[str, Scalar] | tuple[tuple[str, Scalar], ...] | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        housing: str | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class GridGenerator(_GridGenerator):
    r"""A synchronous generator on a grid, by inertia constant and coefficients in per unit, as in power system studies.

    With rated power S, speed omega and line frequency omega_0 = 2 pi f its mechanical values are

        J = 2 H S/omega^2,    k = K_s S omega_0/omega^2,    c = K_D S/omega^2,

    H the inertia constant, K_s the synchronising torque over the electrical angle and K_D the damping torque over the
    change of speed, both per unit. Alone on an infinite bus (the grid is ground) it swings at
    f_n = sqrt(K_s omega_0/(2 H))/(2 pi) with the damping ratio K_D/(2 sqrt(2 H K_s omega_0)) (P. Kundur, Power System
    Stability and Control, chapter 12). Instead of K_s: K_s = sqrt((E V/X)^2 - P^2), which is E V cos(delta)/X, of the
    voltage E behind the reactance X to a bus of voltage V at the power P, all per unit. It stays linear in time;
    a synchronous machine with its pull-out torque follows the sine of the load angle.

    Parameters
    ----------
    node: the node of the rotor
    rated_power: power that is 1 per unit [W]
    speed: synchronous speed of the rotor [rad/s]
    grid_frequency: frequency of the line [Hz]
    inertia_constant: stored energy over rated power, of all masses that stand for it [s]
    synchronising_coefficient: synchronising torque per electrical rad, per unit
    emf: instead: voltage behind the reactance, per unit
    grid_voltage: voltage of the bus, per unit
    reactance: reactance from E to V, per unit
    power: power it gives, per unit
    damping_coefficient: damping torque per change of speed, both per unit
    grid: the grid: ground is an infinite bus; else a node that turns at its speed
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        rated_power: Scalar,
        speed: Scalar,
        grid_frequency: Scalar,
        inertia_constant: Scalar,
        synchronising_coefficient: Scalar | None = None,
        emf: Scalar | None = None,
        grid_voltage: Scalar | None = None,
        reactance: Scalar | None = None,
        power: Scalar | None = None,
        damping_coefficient: Scalar = 0,
        grid: str = 'ground',
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        rated_power: Scalar | None,
        speed: Scalar | None,
        grid_frequency: Scalar | None,
        inertia_constant: Scalar | None,
        synchronising_coefficient: Scalar | None = None,
        emf: Scalar | None = None,
        grid_voltage: Scalar | None = None,
        reactance: Scalar | None = None,
        power: Scalar | None = None,
        damping_coefficient: Scalar = 0,
        grid: str = 'ground',
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class HystereticSpring(_HystereticSpring):
    r"""A spring with rate-independent losses: torque k (1 + j eta) gamma at positive frequency.

    The loss per cycle, pi eta k gamma^2, does not depend on frequency. The law holds in the frequency domain only; in
    the limit of zero frequency its phase lag stays.

    Parameters
    ----------
    nodes: the two nodes it connects, one may be ground; twist is the angle of the first minus the second
    stiffness: torsional stiffness, the real part [N*m/rad]
    loss_factor: loss factor, or another frequency-free damping measure
    damping: viscous damping in parallel [N*m*s/rad]
    outer_diameter: outer diameter of the shaft that it stands for, where its stress is judged [m]
    inner_diameter: inner diameter there [m]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        stiffness: Scalar,
        loss_factor: Scalar | DampingMeasure | Mapping[str, Scalar],
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        outer_diameter: Scalar | None = None,
        inner_diameter: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        stiffness: Scalar | None,
        loss_factor: Scalar | DampingMeasure | Mapping[str, Scalar] | None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        outer_diameter: Scalar | None = None,
        inner_diameter: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class InductionMachine(_InductionMachine):
    r"""An induction motor or generator on a line of fixed frequency: by its slope a damper, with a spring in series.

    Its torque over slip is T = 2 T_k/(s/s_k + s_k/s) (Kloss), with the breakdown torque T_k at the breakdown slip s_k
    and s = 1 - omega/omega_s. Small changes of speed feel its slope,

        c = 2 T_k s_k (s_k^2 - s^2)/(omega_s (s^2 + s_k^2)^2),

    which is below zero beyond s_k: there it drives vibrations. The breakdown slip is given, or follows from the rated
    torque T_n at the rated slip s_n: s_k = s_n (m + sqrt(m^2 - 1)), m = T_k/T_n; the slip is then s_n if it is not
    given. Torque follows the slope with the time constant tau of the rotor currents, T + tau dT/dt = c domega: the
    dashpot c in series with the spring c/tau. With rotor resistance and leakage alone tau = 1/(2 pi f s_k).

    T(s) is its law of motion in time, over the absolute speed of the rotor, whose field turns in the positive sense;
    with a time constant its torque T_m follows as T_m + tau dT_m/dt = T(s), from zero where a simulation starts at
    rest, as after switching on, and else from T(s) of the start. Where neither slip nor rated values say about which
    slip it works, linear results take that of the operating point, and without one that of the unloaded machine, s = 0.
    A torque below T_k stands at two slips, s and s_k^2/s, of which the larger is unstable under a constant torque.

    Parameters
    ----------
    node: the node of the rotor
    synchronous_speed: speed without slip, 2 pi f over the pole pairs [rad/s]
    breakdown_torque: largest torque [N*m]
    breakdown_slip: slip of the largest torque
    slip: slip about which it works, negative as a generator; default: the rated one, or by the operating point
    rated_torque: instead of the breakdown slip: rated torque [N*m]
    rated_slip: slip at the rated torque
    time_constant: time constant of its torque [s]
    inertia: inertia of the rotor [kg*m^2]
    housing: the node of the stator
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        synchronous_speed: Scalar,
        breakdown_torque: Scalar,
        breakdown_slip: Scalar | None = None,
        slip: Scalar | None = None,
        rated_torque: Scalar | None = None,
        rated_slip: Scalar | None = None,
        time_constant: Scalar | None = None,
        inertia: Scalar = 0,
        housing: str = 'ground',
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        synchronous_speed: Scalar | None,
        breakdown_torque: Scalar | None,
        breakdown_slip: Scalar | None = None,
        slip: Scalar | None = None,
        rated_torque: Scalar | None = None,
        rated_slip: Scalar | None = None,
        time_constant: Scalar | None = None,
        inertia: Scalar = 0,
        housing: str = 'ground',
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Inertia(_Inertia):
    r"""A rigid rotating mass at a node: torque J d2theta/dt2.

    Parameters
    ----------
    node: the node it turns with
    inertia: mass moment of inertia [kg*m^2]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        inertia: Scalar,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        inertia: Scalar | None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Lock(_Lock):
    r"""A node clamped to ground; its torque is the reaction the ground has to take.

    Parameters
    ----------
    node: the clamped node
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    def __init__(
        self,
        name: str,
        node: str,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class LumpedMatrices(_LumpedMatrices):
    r"""Matrices M, C and K of a drivetrain, or of a piece of it, that were calculated elsewhere.

    Each matrix A is split into rows a_i with a coefficient d_i >= 0, so that A = sum d_i a_i a_i^T. Where its entries
    off the diagonal are not positive and no row has a negative sum, these are the springs (inertias, dampers) between
    two nodes and to ground,

        A = sum_(i<j) (-A_ij) (e_i - e_j)(e_i - e_j)^T + sum_i (sum_j A_ij) e_i e_i^T

    and otherwise the columns of A = L D L^T (G. H. Golub and C. F. Van Loan, Matrix Computations, 4th ed., 4.2.8, with
    the largest pivot first), all in exact numbers. A matrix that is not symmetric, or in which a motion has
    negative inertia, damping or stiffness, is refused. Differences of a matrix from symmetry, and negative parts, below
    1e-9 of its diagonal count as zero, as do sums of a row that are rounding.

    Parameters
    ----------
    nodes: the node of each row and column
    inertia: inertia matrix M, symmetric, in rows
    damping: damping matrix C, symmetric, in rows
    stiffness: stiffness matrix K, symmetric, in rows
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        nodes: tuple[str, ...] | list[str],
        inertia: NumberRows | None = None,
        damping: NumberRows | None = None,
        stiffness: NumberRows | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        nodes: tuple[str, ...] | list[str] | None,
        inertia: NumberRows | None = None,
        damping: NumberRows | None = None,
        stiffness: NumberRows | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class MassElastic(_MassElastic):
    r"""A maker's mass-elastic sheet: inertias, shafts, damping and gears out of a table beside the model file.

    The columns are known by their headings, with units: inertia, stiffness or compliance to the next mass, damping of a
    mass (to ground) and of a shaft, diameters, speed ratio n (speed of the mass over that of the first), names. A mass
    called ``Cyl. 1`` becomes the inertia and the node ``engine.Cyl_1`` of an element ``engine``, the shaft after it
    ``engine.Cyl_1_to_Cyl_2``; ``at`` puts masses on nodes of the model. Values that the sheet calls referred are made
    real: J = J_ref/n^2, k = k_ref/n^2, c = c_ref/n^2. Where n changes from one mass to the next there is a gear at the
    end of the shaft, of ratio n_first/n_second.

    Parameters
    ----------
    table: the sheet: a file with columns, beside the model file
    at: masses of the sheet that are on nodes of the model, as {flywheel: fly}
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        table: str | Path | Mapping[str, str] | MassElasticSheet,
        at: Mapping[str, str] | tuple[tuple[str, str], ...] = (),
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        table: str | Path | Mapping[str, str] | MassElasticSheet | None,
        at: Mapping[str, str] | tuple[tuple[str, str], ...] = (),
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class PendulumAbsorber(_PendulumAbsorber):
    r"""Pendulums in the centrifugal field of a shaft that turns at Omega: an absorber tuned to an order, at any speed.

    ``count`` masses m run on paths of radius r round points at R from the axis of the shaft. With theta the angle of
    the shaft and psi that of shaft and pendulum together, small motions at constant mean speed have the kinetic energy
    m (R dtheta/dt + r dpsi/dt)^2/2 and the restoring torque m R r Omega^2 (psi - theta). The mass swings at
    n = sqrt(R/r) periods a turn, and at that order its node stands still, whatever the speed and the inertia of the
    shaft. A mass hung at two points (bifilar) does not turn against the shaft; hung at one, it does, and its inertia J
    about its centre of mass makes n = sqrt(m R r/(m r^2 + J)).

    Circle, cycloid and epicycloid have the same law for small motions, r being the radius of curvature at the vertex.
    They differ in how the order follows the ``swing``, the length of path to one side over r: its square goes with
    1 - (1 - lambda^2 (1 + n^2)/n^2) swing^2/8, lambda 0 for a circle, 1 for a cycloid, n/sqrt(1 + n^2) for the
    epicycloid, which keeps its order (H. H. Denman, Tautochronic bifilar pendulum torsion absorbers for reciprocating
    engines, J. Sound Vib. 159 (1992) 251-277; here by harmonic balance to the square of the swing, of a shaft that
    turns evenly, n without J).

    Parameters
    ----------
    node: the node it turns with
    mass: mass of one pendulum [kg]
    pivot_radius: from the axis of the shaft to the centre of the path [m]
    path_radius: radius of the path of the centre of mass at its vertex [m]
    speed: mean speed of the shaft, or a parameter that follows it [rad/s]
    count: how many pendulums, all alike and in phase
    own_inertia: inertia of one mass about its centre of mass [kg*m^2]
    suspension: whether the masses turn against the shaft
    damping: viscous damping between all masses and the shaft [N*m*s/rad]
    path: form of the path
    swing: length of path to one side over r, as an angle [rad]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        mass: Scalar,
        pivot_radius: Scalar,
        path_radius: Scalar,
        speed: Scalar,
        count: WholeNumber = 1,
        own_inertia: Scalar = 0,
        suspension: Literal['bifilar', 'simple'] = 'bifilar',
        damping: Scalar = 0,
        path: Literal['circle', 'cycloid', 'epicycloid'] = 'circle',
        swing: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        mass: Scalar | None,
        pivot_radius: Scalar | None,
        path_radius: Scalar | None,
        speed: Scalar | None,
        count: WholeNumber = 1,
        own_inertia: Scalar = 0,
        suspension: Literal['bifilar', 'simple'] = 'bifilar',
        damping: Scalar = 0,
        path: Literal['circle', 'cycloid', 'epicycloid'] = 'circle',
        swing: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Planetary(_Planetary):
    r"""A simple planetary set with z = z_ring / z_sun: row theta_sun + z theta_ring - (1 + z) theta_carrier.

    Held at zero when rigid; with a stiffness, the compliance of the meshes is lumped between the planets and the ring
    and referred to the sun. The planets roll on the sun: theta_planet = theta_carrier - 2 (theta_sun - theta_carrier) /
    (z - 1), so that their own inertia acts on that row and their mass, at the orbit radius, on the carrier. Any member
    may be on ``ground``. For meshes apart from each other build the set from gears with the carrier as housing. A
    ``backlash``, the whole free angle of the sun while ring and carrier are held, makes the compliant mesh a clearance
    on its row, as that of a gear.

    Parameters
    ----------
    sun: the node of the sun
    ring: the node of the ring
    carrier: the node of the carrier
    ratio: teeth of the ring over teeth of the sun
    teeth: teeth counts [sun, ring], both positive
    stiffness: mesh stiffness referred to the sun; none: rigid [N*m/rad]
    damping: mesh damping referred to the sun [N*m*s/rad]
    planets: how many planets
    planet_inertia: inertia of one planet about its own axis [kg*m^2]
    planet_mass: mass of one planet [kg]
    orbit_radius: radius on which the planets orbit [m]
    backlash: free angle of the sun with the others held; none: 0 [rad]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    def __init__(
        self,
        name: str,
        sun: str,
        ring: str,
        carrier: str,
        ratio: Scalar | None = None,
        teeth: tuple[int, int] | list[int] | None = None,
        stiffness: Scalar | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        planets: WholeNumber = 3,
        planet_inertia: Scalar = 0,
        planet_mass: Scalar = 0,
        orbit_radius: Scalar = 0,
        backlash: Scalar | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Propeller(_Propeller):
    r"""A ship's propeller with entrained water and damping.

    The inertia in water is J (1 + w), w the share of entrained water, or J + J_w. The damping c acts between propeller
    and water, which stands for ground; it is given, or follows from the mean torque Q at the speed omega, both of the
    propeller, which may be parameters that follow the operating point:

    * by Archer c = a Q/n with Q in N m and n in r/min, so that c = a Q pi/(30 omega); the factor a is mostly taken as
      30 (S. Archer, Torsional vibration damping coefficients for marine propellers, Engineering, 1955);
    * as the slope of a torque that follows omega^m: c = m Q/omega;
    * as the slope of the open-water torque K_Q(J_a) rho D^5 (omega/2 pi)^2 while the ship keeps its speed, which moves
      the advance ratio J_a = 2 pi v/(omega D): c = (2 - J_a/K_Q dK_Q/dJ_a) Q/omega.

    The last two are laws of motion in time, over the absolute speed: with r the speed over omega, Q r^m, and
    Q ((1 - b) r^2 + b r) with b = J_a/K_Q dK_Q/dJ_a.

    Water is entrained by what moves across the blade. Where that is given for the design pitch p_d (pitch over
    diameter) and the blades stand at another pitch p, it is taken as the square of the sine of the pitch angle at 0.7
    of the radius: times p^2 (p_d^2 + x^2)/(p_d^2 (p^2 + x^2)), x = 0.7 pi. At zero pitch nothing is entrained.

    Parameters
    ----------
    node: the node it turns with
    inertia: mass moment of inertia in air [kg*m^2]
    entrained_water: share that entrained water adds, as 25 %
    entrained_inertia: instead: inertia of entrained water [kg*m^2]
    pitch_ratio: pitch over diameter at which the blades stand
    design_pitch_ratio: pitch over diameter for which entrained water is given
    damping: damping by the water [N*m*s/rad]
    archer: instead: factor of Archer's formula, about 30
    exponent: instead: exponent m of torque over speed, about 2
    torque_slope: instead: slope dK_Q/dJ_a of the open-water torque, below zero
    torque_coefficient: open-water torque coefficient K_Q there
    advance_ratio: advance ratio at which it works
    torque: mean torque, for the laws of damping [N*m]
    speed: speed of the propeller, for the laws of damping [rad/s]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        inertia: Scalar,
        entrained_water: Scalar = 0,
        entrained_inertia: Scalar | None = None,
        pitch_ratio: Scalar | None = None,
        design_pitch_ratio: Scalar | None = None,
        damping: Scalar | None = None,
        archer: Scalar | None = None,
        exponent: Scalar | None = None,
        torque_slope: Scalar | None = None,
        torque_coefficient: Scalar | None = None,
        advance_ratio: Scalar | None = None,
        torque: Scalar | None = None,
        speed: Scalar | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        inertia: Scalar | None,
        entrained_water: Scalar = 0,
        entrained_inertia: Scalar | None = None,
        pitch_ratio: Scalar | None = None,
        design_pitch_ratio: Scalar | None = None,
        damping: Scalar | None = None,
        archer: Scalar | None = None,
        exponent: Scalar | None = None,
        torque_slope: Scalar | None = None,
        torque_coefficient: Scalar | None = None,
        advance_ratio: Scalar | None = None,
        torque: Scalar | None = None,
        speed: Scalar | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class RigidCoupling(_RigidCoupling):
    r"""Two nodes that turn as one; the torque it carries is what a stiff torque meter reads.

    Parameters
    ----------
    nodes: the two nodes it joins; torque is positive from the first to the second
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Shaft(_Shaft):
    r"""A uniform round shaft, solid or hollow, in n equal segments.

    With the polar moment of area I_p = pi (D^4 - d^4) / 32 the whole shaft has stiffness k = G I_p / L and inertia
    J = rho I_p L; each segment has n k and J / n. The inertia of a segment is lumped half and half on its ends
    (J/2n each), or consistent with a linear twist: J/(6n) [[2, 1], [1, 2]], which is J/4n on the sum and J/12n on the
    difference of its end angles. With more segments the frequencies approach those of the continuum, lumped ones from
    below, consistent ones from above.

    Parameters
    ----------
    nodes: its two ends; twist is the angle of the first minus the second
    outer_diameter: outer diameter [m]
    length: length [m]
    shear_modulus: shear modulus [Pa]
    density: density [kg/m^3]
    inner_diameter: inner diameter, 0 for a solid shaft [m]
    segments: number of equal segments
    inertia: how its inertia is modelled
    damping: viscous damping of the whole shaft in twist [N*m*s/rad]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        outer_diameter: Scalar,
        length: Scalar,
        shear_modulus: Scalar = '79.3 GPa',
        density: Scalar = '7850 kg/m^3',
        inner_diameter: Scalar = 0,
        segments: WholeNumber = 1,
        inertia: Literal['consistent', 'lumped', 'none'] = 'consistent',
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        outer_diameter: Scalar | None,
        length: Scalar | None,
        shear_modulus: Scalar = '79.3 GPa',
        density: Scalar = '7850 kg/m^3',
        inner_diameter: Scalar = 0,
        segments: WholeNumber = 1,
        inertia: Literal['consistent', 'lumped', 'none'] = 'consistent',
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Spring(_Spring):
    r"""A torsion spring, with a viscous damper in parallel if wanted: torque k gamma + c dgamma/dt.

    Springs that are not linear have a law of motion T(gamma) instead of k gamma, of one of these forms:

    * ``cubic`` beside the stiffness: T = k gamma + k_3 gamma^3.
    * ``stages``, the same both ways: on stage i, T = T_i + k_i (gamma - gamma_i) from the end gamma_i of the stage
      before it, with T_i the torque there plus the ``preload`` P_i of the stage. That is the torque under which its
      springs are installed: at gamma_i the twist stands still until the torque exceeds that of the stage before by P_i.
    * ``torque_over_twist``, rows joined by straight lines. From zero on they hold both ways; rows through negative
      twists may differ, and may have a torque at zero twist.

    Linear results take the slope dT/dgamma at the operating point, without one that at rest without twist; at a corner
    that of the piece above it. Beyond the last row, or the end of the last stage, the torque is not known: results that
    reach there are refused.

    Parameters
    ----------
    nodes: the two nodes it connects, one may be ground; twist is the angle of the first minus the second
    stiffness: torsional stiffness [N*m/rad]
    damping: viscous damping, or a damping measure at a frequency [N*m*s/rad]
    outer_diameter: outer diameter of the shaft that it stands for, where its stress is judged [m]
    inner_diameter: inner diameter there [m]
    cubic: torque over the cube of the twist, besides the stiffness [N*m/rad^3]
    stages: instead: stages from zero torque on, each up to a torque or an angle
    torque_over_twist: instead: rows [twist, torque]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        stiffness: Scalar | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        outer_diameter: Scalar | None = None,
        inner_diameter: Scalar = 0,
        cubic: Scalar | None = None,
        stages: tuple[SpringStage | Entries, ...] | list[SpringStage | Entries] | None = None,
        torque_over_twist: NumberRows | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class SpringDamper(_SpringDamper):
    r"""A torsional vibration damper of steel springs and oil: an inner star on the shaft, an outer ring on leaf springs.

    Springs k and oil act between star and ring. The oil that the springs displace through gaps damps with c; it is a
    constant, or a measure at a frequency, as {eta: 0.4, at: 25 Hz}. Makers state the hydrodynamic damping by
    eta(f) = c omega/k, the undimensioned damping factor, and the dynamic stiffness by k(f) over that at rest; both
    over frequency make the law k(f) (1 + j eta(f)), between the rows by powers of the frequency.

    Parameters
    ----------
    node: the node its inner star turns with
    ring_inertia: inertia of the outer ring [kg*m^2]
    stiffness: stiffness of the springs [N*m/rad]
    damping: damping by the oil, or a measure at a frequency [N*m*s/rad]
    loss_over_frequency: instead: c omega/k
    stiffness_over_frequency: k(f) over the stiffness
    hub_inertia: inertia of the inner star [kg*m^2]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        ring_inertia: Scalar,
        stiffness: Scalar,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        loss_over_frequency: NumberByNumber | None = None,
        stiffness_over_frequency: NumberByNumber | None = None,
        hub_inertia: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        ring_inertia: Scalar | None,
        stiffness: Scalar | None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        loss_over_frequency: NumberByNumber | None = None,
        stiffness_over_frequency: NumberByNumber | None = None,
        hub_inertia: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class SynchronousMachine(_SynchronousMachine):
    r"""A synchronous motor or generator on a line of fixed frequency: a spring and a damper to its turning field.

    At the load angle delta (electrical, p times the mechanical one of p pole pairs) it has the torque
    T = T_e sin(delta) + T_r sin(2 delta), with T_e = 3 U E/(Omega X_d) of phase voltages U and E, reactance X_d and
    speed Omega, and T_r = 3 U^2 (1/X_q - 1/X_d)/(2 Omega) of salient poles. Small changes of the mechanical angle feel
    k = p dT/ddelta = p (T_e cos(delta) + 2 T_r cos(2 delta)); without saliency k = p sqrt(T_e^2 - T^2). The damper
    winding acts as c. Angles are against the steadily turning field, which stands for ground, or for the housing if
    that gives way. For swings against an excitation that cannot follow, take transient values.

    With a pull-out torque, T(p gamma) is its law of motion in time, over the twist gamma of the rotor against the
    field. Linear results take ``torque`` or ``load_angle``, or the unloaded machine, unless an operating point is asked
    for.

    Parameters
    ----------
    node: the node of the rotor
    stiffness: magnetic stiffness over the mechanical angle [N*m/rad]
    pull_out_torque: instead: torque T_e of the field at 90 degrees [N*m]
    pole_pairs: electrical periods of a revolution
    torque: mean torque it gives or takes, a size [N*m]
    load_angle: instead: load angle, electrical, a size [rad]
    reluctance_torque: torque T_r of salient poles [N*m]
    damping: damping of the damper winding, over the mechanical speed [N*m*s/rad]
    inertia: inertia of the rotor [kg*m^2]
    housing: the node of the stator
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    def __init__(
        self,
        name: str,
        node: str,
        stiffness: Scalar | None = None,
        pull_out_torque: Scalar | None = None,
        pole_pairs: WholeNumber | None = None,
        torque: Scalar | None = None,
        load_angle: Scalar | None = None,
        reluctance_torque: Scalar | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        inertia: Scalar = 0,
        housing: str = 'ground',
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class TabulatedSpring(_TabulatedSpring):
    r"""A coupling known by its measured dynamic stiffness k(f) + j omega c(f), interpolated linearly between the rows.

    Parameters
    ----------
    nodes: the two nodes it connects, one may be ground; twist is the angle of the first minus the second
    table: rows [frequency in Hz, stiffness in N*m/rad, damping in N*m*s/rad]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        table: StiffnessTable | NumberRows,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        table: StiffnessTable | NumberRows | None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class TorqueConverter(_TorqueConverter):
    r"""A hydrodynamic torque converter: T_p = C(nu) omega_p^2 and T_t = mu(nu) T_p, nu = omega_t / omega_p.

    With E = mu C and slopes over nu, small changes of the speeds change the torques by
    dT_p = omega_p (2 C - nu C') domega_p + omega_p C' domega_t and
    dT_t = omega_p (2 E - nu E') domega_p + omega_p E' domega_t: a matrix that is not symmetric. The stator takes the
    difference to the housing. C is given as for ``fluid_coupling``: by the performance coefficient lambda(nu) of
    C = lambda rho D^5, by the pump torque at a test speed (as MP2000 curves at 2000 r/min), or by the K factor
    omega_p / sqrt(T_p). Both tables are straight between their rows; at a row the piece above it counts. A lock-up
    clutch is a ``clutch`` beside it (A. J. Kotwicki, Dynamic models for torque converter equipped vehicles, SAE 820393,
    1982).

    T_p and T_t are its laws of motion in time, over absolute speeds. Without ``speed`` and ``speed_ratio`` linear
    results take their slopes at the operating point; without one the converter stands and passes on nothing.

    Parameters
    ----------
    pump: the node of the pump
    turbine: the node of the turbine
    speed: speed of the pump at the operating point; default: as that says [rad/s]
    speed_ratio: speed of the turbine over that of the pump at the operating point
    pump_torque: rows [speed ratio, pump torque at test_speed]
    test_speed: speed of the pump that pump_torque was measured at [rad/s]
    performance: instead: rows [speed ratio, performance coefficient lambda]
    diameter: diameter of the circuit, for performance [m]
    density: density of the oil, for performance [kg/m^3]
    k_factor: instead: rows [speed ratio, K factor in (r/min)/sqrt(N*m)]
    pump_inertia: inertia of the pump with its oil [kg*m^2]
    turbine_inertia: inertia of the turbine with its oil [kg*m^2]
    housing: the node against which both turn, and that carries a stator
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    torque_ratio: rows [speed ratio, turbine torque over pump torque]
    """
    @overload
    def __init__(
        self,
        name: str,
        pump: str,
        turbine: str,
        speed: Scalar | None = None,
        speed_ratio: Scalar | None = None,
        pump_torque: NumberRows | None = None,
        test_speed: Scalar | None = None,
        performance: NumberRows | None = None,
        diameter: Scalar | None = None,
        density: Scalar = '840 kg/m^3',
        k_factor: NumberRows | None = None,
        pump_inertia: Scalar = 0,
        turbine_inertia: Scalar = 0,
        housing: str = 'ground',
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
        torque_ratio: NumberRows,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        pump: str,
        turbine: str,
        speed: Scalar | None = None,
        speed_ratio: Scalar | None = None,
        pump_torque: NumberRows | None = None,
        test_speed: Scalar | None = None,
        performance: NumberRows | None = None,
        diameter: Scalar | None = None,
        density: Scalar = '840 kg/m^3',
        k_factor: NumberRows | None = None,
        pump_inertia: Scalar = 0,
        turbine_inertia: Scalar = 0,
        housing: str = 'ground',
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
        torque_ratio: NumberRows | None,
    ) -> None: ...

class TunedDamper(_TunedDamper):
    r"""A tuned torsional damper: a ring on an elastic and damping layer, mostly of rubber, on a hub.

    Its spring k is given, or by the natural frequency f_r of the ring on the hub held fast, k = J_r (2 pi f_r)^2. Its
    damping is a loss factor, k (1 + j eta), which suits rubber; or viscous, c itself or by the damping ratio of the
    ring on the hub held fast, c = 2 zeta sqrt(k J_r). On a mass on a spring, J with the hub and K, mu = J_r/J, the best
    viscous damper has f_r = sqrt(K/J)/(2 pi (1 + mu)) and zeta = sqrt(3 mu/(8 (1 + mu))); then theta is about
    sqrt(1 + 2/mu) times what the torque amplitude would turn the spring at rest (J. P. Den Hartog, Mechanical
    Vibrations, 4th ed., chapter 3).

    Parameters
    ----------
    node: the node its hub turns with
    ring_inertia: inertia of the ring [kg*m^2]
    stiffness: stiffness of the layer [N*m/rad]
    natural_frequency: instead: natural frequency of the ring, hub held fast [Hz]
    loss_factor: loss factor of the layer, or another measure of it
    damping_ratio: instead: damping ratio of the ring, hub held fast
    damping: instead: viscous damping, or a measure at a frequency [N*m*s/rad]
    hub_inertia: inertia of the hub [kg*m^2]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        ring_inertia: Scalar,
        stiffness: Scalar | None = None,
        natural_frequency: Scalar | None = None,
        loss_factor: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        damping_ratio: Scalar | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        hub_inertia: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        ring_inertia: Scalar | None,
        stiffness: Scalar | None = None,
        natural_frequency: Scalar | None = None,
        loss_factor: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        damping_ratio: Scalar | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        hub_inertia: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Tyre(_Tyre):
    r"""A tyre between rim and road: carcass and sidewall as a spring, and longitudinal slip as a damper behind it.

    At the speed v a slip of 1 makes the force C, so that the torque T = C r^2 (omega_rim - omega_road) / v is that of a
    damper c = C r^2 / v. In series with the stiffness k the torque follows the slip with a first-order lag:
    sigma/v dT/dt + T = c (omega_rim - omega_road), with the relaxation length sigma = C r^2 / k (H. B. Pacejka, Tire
    and Vehicle Dynamics, 3rd ed., chapter 7). Standing on the road, without slip, only the spring is left. The belt is
    the node ``NAME.belt``; it may have an inertia of its own. The node of the road turns with the vehicle, v / r.

    Parameters
    ----------
    nodes: rim and road; twist is the angle of the first minus the second
    state: whether it rolls, with slip, or stands without
    radius: rolling radius [m]
    slip_stiffness: longitudinal force per slip [N]
    speed: speed on the road [m/s]
    stiffness: torsional stiffness of rim against road [N*m/rad]
    relaxation_length: instead of the stiffness: relaxation length [m]
    damping: viscous damping in parallel to the stiffness [N*m*s/rad]
    belt_inertia: inertia of belt and tread [kg*m^2]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    def __init__(
        self,
        name: str,
        nodes: TwoNames,
        state: Literal['rolling', 'standing'] = 'rolling',
        radius: Scalar | None = None,
        slip_stiffness: Scalar | None = None,
        speed: Scalar | None = None,
        stiffness: Scalar | None = None,
        relaxation_length: Scalar | None = None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] = 0,
        belt_inertia: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class Vehicle(_Vehicle):
    r"""A vehicle of mass m on wheels of rolling radius r: inertia m r^2 + J_w on the node that turns with the wheels.

    Air drag F = rho A_d v^2 / 2 with the drag area A_d = c_w A, and a rolling resistance F = m g (f_0 + f_1 v), make a
    damping at the speed v: c = r^2 dF/dv = r^2 (rho A_d v + m g f_1). Constant parts, as f_0 or a gradient, only load
    the drivetrain in the mean (M. Mitschke, H. Wallentowitz, Dynamik der Kraftfahrzeuge).
    The speed may be a parameter that follows the operating point, as v = n*r with n {by: speed, of: hub}.

    Parameters
    ----------
    node: the node that turns with the wheels, behind the tyres
    mass: mass of the vehicle [kg]
    wheel_radius: rolling radius of the wheels [m]
    wheel_inertia: inertia of wheels that no drive shaft turns [kg*m^2]
    speed: speed of the vehicle, for what damps [m/s]
    drag_area: drag coefficient times frontal area [m^2]
    air_density: density of the air [kg/m^3]
    rolling_slope: growth of the rolling resistance coefficient with speed [s/m]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        mass: Scalar,
        wheel_radius: Scalar,
        wheel_inertia: Scalar = 0,
        speed: Scalar | None = None,
        drag_area: Scalar | None = None,
        air_density: Scalar = '1.204 kg/m^3',
        rolling_slope: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        mass: Scalar | None,
        wheel_radius: Scalar | None,
        wheel_inertia: Scalar = 0,
        speed: Scalar | None = None,
        drag_area: Scalar | None = None,
        air_density: Scalar = '1.204 kg/m^3',
        rolling_slope: Scalar = 0,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...

class ViscousDamper(_ViscousDamper):
    r"""A viscous torsional damper (Houde damper) on a shaft: a free ring in a film of silicone oil, in a hub.

    The ring, of inertia J_r, is dragged along by the film: J_r d2theta_r/dt2 = T_f, with T_f = c dgamma/dt + k gamma
    and gamma = theta - theta_r; the torque it takes from the shaft is J_h d2theta/dt2 + T_f. A film without stiffness
    (untuned) has its best damping on a mass on a spring, J and K, at c = 2 zeta J_r sqrt(K/J) with
    zeta = 1/sqrt(2 (1 + mu) (2 + mu)) and mu = J_r/J, J with the hub; then theta is at most (2 + mu)/mu times what the
    torque amplitude would turn the spring at rest (J. P. Den Hartog, Mechanical Vibrations, 4th ed., chapter 3).
    Silicone oils are stiff, too, and both values change with frequency and temperature: c and k are constants, or a
    table over frequency that holds at one temperature, or S (G' + j G'') of the silicone in the gaps round the ring at
    the temperature of the film, by time-temperature superposition, with S = pi (r_o^4 - r_i^4)/h_a + 2 pi b r_o^3/h_o
    + 2 pi b r_i^3/h_i; ``scale`` multiplies either, for an oil of another viscosity, or in a fit.

    Parameters
    ----------
    node: the node its hub turns with
    ring_inertia: inertia of the ring [kg*m^2]
    damping: viscous damping of the film, or a measure of its damping [N*m*s/rad]
    stiffness: stiffness of the film [N*m/rad]
    hub_inertia: inertia of hub and casing [kg*m^2]
    table: instead: rows [frequency in Hz, stiffness in N*m/rad, damping in N*m*s/rad] of the film
    silicone: instead: moduli of the silicone
    gap: its gaps round the ring
    scale: factor on the table or on the moduli
    temperature: temperature of the silicone [K]
    description: free text for tables and reports
    enabled: whether the element takes part before a configuration says otherwise
    catalogue: a table from which it takes the entries that are not given here, as couplings.csv
    size: the row of the catalogue
    referred_to: a node of the shaft at whose speed the values are quoted; default: its own shaft
    """
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        ring_inertia: Scalar,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        stiffness: Scalar = 0,
        hub_inertia: Scalar = 0,
        table: StiffnessTable | NumberRows | None = None,
        silicone: Viscoelastic | Entries | None = None,
        gap: FilmGap | Entries | None = None,
        scale: Scalar | None = None,
        temperature: Scalar | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow | None = None,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        node: str,
        ring_inertia: Scalar | None,
        damping: Scalar | DampingMeasure | Mapping[str, Scalar] | None = None,
        stiffness: Scalar = 0,
        hub_inertia: Scalar = 0,
        table: StiffnessTable | NumberRows | None = None,
        silicone: Viscoelastic | Entries | None = None,
        gap: FilmGap | Entries | None = None,
        scale: Scalar | None = None,
        temperature: Scalar | None = None,
        *,
        description: str = '',
        enabled: bool = True,
        catalogue: PurePath | Catalogue | CatalogueRow,
        size: str | float = '',
        referred_to: str | None = None,
    ) -> None: ...
