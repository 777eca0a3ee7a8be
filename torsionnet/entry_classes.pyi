# Written by `make generate`.
from collections.abc import Mapping
from torsionnet.base.entries.accepted_types import Entries, Scalar, WholeNumber
from torsionnet.bench.plan.parts import DropOuts, Exciter, Hum, PitchErrors, RadialVibration, RecordingSystem, StrainGauge
from torsionnet.bench.plan.plan import CoastDown, GivenSpeed, RunDown, SteadyPoints
from torsionnet.signals.excitation import LoadCycles, LogarithmicSweep, Multisine, SteppedSine
from typing import Any, Literal
from torsionnet.bench.plan.parts import Acquisition as _Acquisition
from torsionnet.signals.excitation import BurstRandom as _BurstRandom
from torsionnet.bench.plan.parts import Encoder as _Encoder
from torsionnet.signals.excitation import LinearChirp as _LinearChirp
from torsionnet.study.space.variations.normal import Normal as _Normal
from torsionnet.bench.plan.plan import Plan as _Plan
from torsionnet.signals.rotation.counter import PulseReading as _PulseReading
from torsionnet.bench.plan.plan import RunUp as _RunUp
from torsionnet.motion.scenarios.short_circuit import ShortCircuitScenario as _ShortCircuitScenario
from torsionnet.bench.plan.parts import ToothedWheel as _ToothedWheel
from torsionnet.motion.scenarios.torques_of_nodes import TorqueScenario as _TorqueScenario
from torsionnet.bench.plan.parts import Transducer as _Transducer
from torsionnet.signals.rotation.wheel import Wheel as _Wheel

class Acquisition(_Acquisition):
    r"""Sampling of all channels at once.

    Parameters
    ----------
    rate: sampling rate
    bits: resolution of the analog inputs over the range of each transducer
    anti_alias: cut-off (-3 dB) of a Butterworth filter of order 4 in the analog channels
    """
    def __init__(
        self,
        *,
        rate: Scalar,
        bits: WholeNumber | None = None,
        anti_alias: Scalar | None = None,
    ) -> None: ...

class BurstRandom(_BurstRandom):
    r"""Test signal, a burst of noise in a band for a share of each period, then silence in which the drivetrain rests.

    Every period has noise of its own. ``amplitude`` is the peak.

    Attributes
    ----------
    share : float
        Of a period with noise, 0 to 1.

    Parameters
    ----------
    amplitude: peak of the alternating torque
    mean: torque added throughout; the test begins in its equilibrium
    start: lower end of the band
    stop: upper end of the band
    period: length of a period; lines are 1/period apart
    periods: how many periods
    seed: the same seed gives the same signal
    share: share of a period with noise
    """
    def __init__(
        self,
        *,
        amplitude: Scalar = 1.0,
        mean: Scalar = 0.0,
        start: Scalar,
        stop: Scalar,
        period: Scalar,
        periods: WholeNumber = 1,
        seed: WholeNumber = 0,
        share: Scalar = 0.5,
    ) -> None: ...

class Encoder(_Encoder):
    r"""An incremental encoder: the angle in whole steps, from wherever the shaft stands when counting begins.

    Parameters
    ----------
    sensor: what it reads if its name is no sensor of the model: "velocity(motor)", "torque(gearbox,
        output_shaft)"
    lines: lines per revolution
    quadrature: whether all four edges of the two tracks are counted
    delay: time by which the channel lags behind the others
    """
    def __init__(
        self,
        *,
        sensor: str | None = None,
        lines: WholeNumber,
        quadrature: bool = False,
        delay: Scalar = 0.0,
    ) -> None: ...

class LinearChirp(_LinearChirp):
    r"""Test signal, a sine whose frequency changes by the same number of Hz every second.

    f(t) = f_0 + (f_1 - f_0) t / T, and its phase is the integral 2 pi (f_0 t + (f_1 - f_0) t^2 / (2 T)). Equations (1)
    and (2) of Galvagno et al. (2015) print sin(2 pi f(t) t) and f_0 - f_1, which would run the wrong way and twice as
    fast.

    Parameters
    ----------
    amplitude: peak of the alternating torque
    mean: torque added throughout; the test begins in its equilibrium
    start: first frequency
    stop: last frequency
    duration: length of the sweep
    """
    def __init__(
        self,
        *,
        amplitude: Scalar = 1.0,
        mean: Scalar = 0.0,
        start: Scalar,
        stop: Scalar,
        duration: Scalar,
    ) -> None: ...

class Normal(_Normal):
    r"""Normal variation of a parameter, with limits beyond which values are left out and the rest keeps its proportions.

    Mean and deviation are those before anything is left out.

    Parameters
    ----------
    mean: mean; by default the value in the model
    deviation: standard deviation; in percent it is a share of the mean
    low: no value is below; by default there is no such limit
    high: no value is above; by default there is no such limit
    """
    def __init__(
        self,
        *,
        mean: object | None = None,
        deviation: object,
        low: object | None = None,
        high: object | None = None,
    ) -> None: ...

class Plan(_Plan):
    r"""A test: what drives the drivetrain, what is measured, and how it is recorded.

    Attributes
    ----------
    excitation : Excitation, optional
        Set-point of the torque that shakes the drivetrain.
    motion : BenchMotion, optional
        Instead: how the drivetrain turns under the excitations of its model.
    channels : mapping of str to Transducer, StrainGauge, Encoder or ToothedWheel
        By the name of a sensor of the model, or of any other name with a ``sensor`` of its own.
    acquisition : Acquisition
    exciter : Exciter, optional
        By default delivers its set-point exactly.
    drive : str, optional
        Input of the model on which the torque acts; by default the only one there is.
    seed : int, optional
        Of noise and of the encoders' starting positions; the same seed gives the same record.
    systems : mapping of str to RecordingSystem
        Further recording systems by name, with the channels that they record.

    Parameters
    ----------
    drive: input on which the torque acts, if there are several
    excitation: what the torque is to be
    motion: how the drivetrain turns
    exciter: the motor that shakes
    channels: what is recorded, by the name of a sensor
    acquisition: sampling of all channels
    seed: the same seed gives the same record
    systems: further recording systems, by name
    """
    def __init__(
        self,
        *,
        drive: str = '',
        excitation: LinearChirp | LogarithmicSweep | SteppedSine | LoadCycles | Multisine | BurstRandom | Entries | None = None,
        motion: SteadyPoints | RunUp | RunDown | CoastDown | GivenSpeed | Entries | None = None,
        exciter: Exciter | Entries = Exciter(bandwidth=None, compensated=False, harmonics=None, limit=None, bits=None, full_scale=None),
        channels: Mapping[str, Transducer | StrainGauge | Encoder | ToothedWheel | Entries],
        acquisition: Acquisition | Entries,
        seed: WholeNumber = 0,
        systems: Mapping[str, RecordingSystem | Entries] | None = None,
    ) -> None: ...

class PulseReading(_PulseReading):
    r"""Reading of the values of a channel of pulses: counts of a clock, which may wrap, times, or the signal of teeth.

    Without ``tick`` and ``clock`` the values are times of pulses in the unit of the channel.

    Parameters
    ----------
    tick: time of one count of the counter
    clock: instead: frequency that the counter counts
    bits: width of the counter in bits, which begins at 0 again when it is full
    level: value that a tooth signal passes, in its unit; default: the middle
    hysteresis: share of its height by which a tooth signal must pass on either side
    edge: which flanks of a tooth signal are pulses
    pickup: whether a tooth signal switches, or grows with the speed
    second: channel of a second track a quarter pitch further, which tells the direction
    """
    def __init__(
        self,
        *,
        tick: Scalar | None = None,
        clock: Scalar | None = None,
        bits: WholeNumber | None = None,
        level: Scalar | None = None,
        hysteresis: Scalar = 0.2,
        edge: Literal['rising', 'falling'] = 'rising',
        pickup: Literal['switching', 'inductive'] = 'switching',
        second: str = '',
    ) -> None: ...

class RunUp(_RunUp):
    r"""A speed that rises straight over time.

    Parameters
    ----------
    speed_of: node whose speed it is; by default that of speeds:
    start_angle: angle of the reference shaft at the beginning; 0 is where phases of orders are counted from
    without: excitations of the model that are off
    outside_speeds: whether speeds outside those of the model are meant
    start: a speed
    stop: a speed
    duration: time from start to stop
    rate: instead: change of the speed
    """
    def __init__(
        self,
        *,
        speed_of: str = '',
        start_angle: Scalar = 0.0,
        without: tuple[str, ...] | list[str] = (),
        outside_speeds: bool = False,
        start: Scalar,
        stop: Scalar,
        duration: Scalar | None = None,
        rate: Scalar | None = None,
    ) -> None: ...

class ShortCircuitScenario(_ShortCircuitScenario):
    r"""A short circuit at the terminals of a synchronous machine, or its connection to the grid at a wrong angle.

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

    Parameters
    ----------
    duration: time that is simulated
    rate: samples a second; default: 100 in the shortest period of vibration
    start: state in which it begins
    machine: the element of the machine, or its excitation electric_machine
    phases: how many phases are short, 2 or 3
    angle: instead, faulty synchronisation: electrical angle of the rotor ahead of the grid [rad]
    at: time of the fault
    x: subtransient reactance, per unit
    x_external: reactance from the machine to the fault or the grid, per unit
    decay: time constant in which the torque at the line frequency dies away; none: it stays [s]
    decay_double: the same of the torque at twice the line frequency [s]
    rated_torque: torque of 1 per unit; default: that of the machine [N*m]
    frequency: line frequency; default: that of the machine [Hz]
    pole_pairs: pole pairs of a machine that is synchronised; default: from machine, or its speed
    """
    def __init__(
        self,
        *,
        duration: Scalar | None = None,
        rate: Scalar | None = None,
        start: Literal['rest', 'operating_point'] | None = None,
        machine: str,
        phases: WholeNumber | None = None,
        angle: Scalar | None = None,
        at: Scalar = 0,
        x: Scalar,
        x_external: Scalar = 0,
        decay: Scalar | None = None,
        decay_double: Scalar | None = None,
        rated_torque: Scalar | None = None,
        frequency: Scalar | None = None,
        pole_pairs: WholeNumber | None = None,
    ) -> None: ...

class ToothedWheel(_ToothedWheel):
    r"""A toothed wheel with a pickup, whose pulses a counter stamps; a channel of pulse times.

    Tooth k passes the pickup where the wheel's angle, positive in its sense of rotation, is 2 pi k/teeth plus the error
    of its place plus the pickup's angle. Channels with ``wheel`` are further pickups on the wheel of another channel.

    Parameters
    ----------
    sensor: the angle of its node, if its name is no sensor of the model: "angle(fly)"
    wheel: channel of the wheel's first pickup, of a further pickup on it
    teeth: teeth on the circumference, missing ones included
    missing_teeth: teeth that the gap lacks, the last ones of a turn
    gearing: turns of the wheel per turn of its node, as 0.5 of a camshaft
    mounting: angle of the wheel where that of its node is 0, in its sense of rotation
    pitch_errors: errors of the places of the teeth
    radius: radius at the tips of the teeth
    radial_vibration: vibration of the wheel's centre
    pickup_angle: place of the pickup in the sense of rotation, so that a tooth passes it later
    index: whether a pulse per turn is recorded, too, as NAME_index, at the place of tooth 0
    missing_pulses: share of the pulses that are lost
    double_pulses: share of the pulses followed by a second one
    jitter: standard deviation of the time of a pulse
    tick: step of the counter, to which times are rounded down
    """
    def __init__(
        self,
        *,
        sensor: str | None = None,
        wheel: str = '',
        teeth: WholeNumber | None = None,
        missing_teeth: WholeNumber = 0,
        gearing: Scalar = 1.0,
        mounting: Scalar = 0.0,
        pitch_errors: PitchErrors | Entries = PitchErrors(normal=0.0, uniform=0.0, eccentricity=0.0, eccentricity_phase=0.0, list=()),
        radius: Scalar | None = None,
        radial_vibration: RadialVibration | Entries | None = None,
        pickup_angle: Scalar = 0.0,
        index: bool = False,
        missing_pulses: Scalar = 0.0,
        double_pulses: Scalar = 0.0,
        jitter: Scalar = 0.0,
        tick: Scalar = 0.0,
    ) -> None: ...

class TorqueScenario(_TorqueScenario):
    r"""Torques over time on nodes, in place of the mean torques that act there, and what scales torques of elements.

    A torque is a constant, runs straight between rows ``{0 s: 20 N*m, 50 ms: 250 N*m}``, or is
    mean + amplitude cos(2 pi frequency t + phase). Mean torques of the operating point on other nodes go on acting
    where the scenario starts there; from rest only its own torques act. ``clutch: {clamp: {0 s: 0 N*m,
    0.5 s: 300 N*m}}`` gives what scales the torque of an element over time, as the clamp torque of a clutch.

    Parameters
    ----------
    duration: time that is simulated
    rate: samples a second; default: 100 in the shortest period of vibration
    start: state in which it begins
    torque: torque over time by node
    elements: what scales the torques of elements, over time, by element
    """
    def __init__(
        self,
        *,
        duration: Scalar,
        rate: Scalar | None = None,
        start: Literal['rest', 'operating_point'] | None = None,
        torque: Mapping[str, Scalar | Mapping[Any, Scalar] | list[list[Scalar]]] | None = None,
        elements: Mapping[str, Mapping[str, Scalar | Mapping[Any, Scalar] | list[list[Scalar]]]] | None = None,
    ) -> None: ...

class Transducer(_Transducer):
    r"""An analog sensor: torque transducer, tachometer, accelerometer. It reads gain * value + offset + noise.

    Parameters
    ----------
    sensor: what it reads if its name is no sensor of the model: "velocity(motor)", "torque(gearbox,
        output_shaft)"
    range: largest value, plus or minus; beyond it the reading is clipped
    noise: standard deviation of white noise at the sampling rate
    offset: added to every value
    gain: what it reads over what is there
    delay: time by which the channel lags behind the others
    hum: hum of the mains
    drop_outs: times without telemetry
    """
    def __init__(
        self,
        *,
        sensor: str | None = None,
        range: Scalar | None = None,
        noise: Scalar | None = None,
        offset: Scalar | None = None,
        gain: Scalar = 1.0,
        delay: Scalar = 0.0,
        hum: Hum | Entries | None = None,
        drop_outs: DropOuts | Entries | None = None,
    ) -> None: ...

class Wheel(_Wheel):
    r"""A toothed wheel or an encoder, as its pulses are read.

    Parameters
    ----------
    teeth: pulses per revolution of the wheel, missing ones included
    missing_teeth: teeth that the gap lacks, as 2 of a wheel 60-2
    ratio: turns of the reference shaft per turn of the wheel
    reversed: whether the wheel turns against the sense of the model
    pattern: file of its pitch pattern, from the folder of this file; or where its teeth stand: 4 teeth, 2
        missing, 2 teeth, 1 missing; or 0, 80, 180, 270 deg
    """
    def __init__(
        self,
        *,
        teeth: WholeNumber,
        missing_teeth: WholeNumber = 0,
        ratio: Scalar = 1.0,
        reversed: bool = False,
        pattern: str = '',
    ) -> None: ...
