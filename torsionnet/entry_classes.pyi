# Written by `make generate`.
import datetime
from collections.abc import Mapping
from torsionnet.base.entries.accepted_types import Entries, NumberByNumber, NumberRows, Scalar, Scalars, WholeNumber
from torsionnet.report.plan import SECTIONS
from typing import Any, Literal
from torsionnet.bench.plan.parts import Acquisition as _Acquisition
from torsionnet.signals.excitation import BurstRandom as _BurstRandom
from torsionnet.bench.plan.bench_motions import CoastDown as _CoastDown
from torsionnet.study.space.correlation import Correlation as _Correlation
from torsionnet.bench.plan.parts import DropOuts as _DropOuts
from torsionnet.bench.plan.parts import Encoder as _Encoder
from torsionnet.bench.plan.parts import Exciter as _Exciter
from torsionnet.bench.plan.bench_motions import GivenSpeed as _GivenSpeed
from torsionnet.bench.plan.parts import Hum as _Hum
from torsionnet.signals.excitation import LinearChirp as _LinearChirp
from torsionnet.study.space.variations.uniform import ListOfValues as _ListOfValues
from torsionnet.signals.excitation import LogarithmicSweep as _LogarithmicSweep
from torsionnet.study.space.variations.normal import Lognormal as _Lognormal
from torsionnet.signals.excitation import Multisine as _Multisine
from torsionnet.study.space.variations.normal import Normal as _Normal
from torsionnet.model.operating_point import OperatingPoint as _OperatingPoint
from torsionnet.model.parameters import Parameter as _Parameter
from torsionnet.bench.plan.parts import PitchErrors as _PitchErrors
from torsionnet.bench.plan.plan import Plan as _Plan
from torsionnet.signals.rotation.counter import PulseReading as _PulseReading
from torsionnet.bench.plan.parts import RadialVibration as _RadialVibration
from torsionnet.bench.plan.parts import RecordingSystem as _RecordingSystem
from torsionnet.report.plan.report_plan import ReportPlan as _ReportPlan
from torsionnet.report.plan.title_block import Revision as _Revision
from torsionnet.bench.plan.bench_motions import RunDown as _RunDown
from torsionnet.bench.plan.bench_motions import RunUp as _RunUp
from torsionnet.study.space.samples import Samples as _Samples
from torsionnet.motion.scenarios.short_circuit import ShortCircuitScenario as _ShortCircuitScenario
from torsionnet.bench.plan.parts import ShuntCalibration as _ShuntCalibration
from torsionnet.bench.plan.bench_motions import SteadyPoints as _SteadyPoints
from torsionnet.signals.excitation import SteppedSine as _SteppedSine
from torsionnet.bench.plan.parts import StrainGauge as _StrainGauge
from torsionnet.report.plan.title_block import TitleBlock as _TitleBlock
from torsionnet.bench.plan.parts import ToothedWheel as _ToothedWheel
from torsionnet.motion.scenarios.torques_of_nodes import TorqueScenario as _TorqueScenario
from torsionnet.bench.plan.parts import Transducer as _Transducer
from torsionnet.study.space.variations.uniform import Triangular as _Triangular
from torsionnet.study.space.variations.uniform import Uniform as _Uniform
from torsionnet.study.space.variations.uniform import ValueRange as _ValueRange
from torsionnet.signals.rotation.wheel import Wheel as _Wheel
from torsionnet.signals.rotation.wheel_channel import WheelChannel as _WheelChannel
from torsionnet.bench.plan.parts import ZeroDrift as _ZeroDrift

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

class CoastDown(_CoastDown):
    r"""A speed that falls by itself: with a time constant, or by the drag of the model's load.

    Without a time constant the torque that the load absorbs at each speed brakes all inertias that turn with the
    reference shaft. An engine that runs out without injection is a configuration with ``gas_off`` or ``misfire`` of all
    its cylinders; what does not act at all stands in ``without``.

    Parameters
    ----------
    speed_of: node whose speed it is; by default that of speeds:
    start_angle: angle of the reference shaft at the beginning; 0 is where phases of orders are counted from
    without: excitations of the model that are off
    outside_speeds: whether speeds outside those of the model are meant
    start: a speed
    stop: a speed
    time_constant: time in which the speed falls to 1/e; without it the load of the model brakes
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
        time_constant: Scalar | None = None,
    ) -> None: ...

class Correlation(_Correlation):
    r"""Linear correlation, from -1 to 1, of the values of parameters, of every two where more are named.

    The distributions are those of the parameters all the same; they are joined as functions of correlated normal
    variables (a Gaussian copula, in structural reliability Nataf's model).

    Parameters
    ----------
    between: parameters
    coefficient: linear correlation of the values, above -1 and below 1
    """
    def __init__(
        self,
        *,
        between: tuple[str, ...] | list[str],
        coefficient: Scalar,
    ) -> None: ...

class DropOuts(_DropOuts):
    r"""Times without telemetry, at random, in which the channel holds its last value or reads zero.

    Parameters
    ----------
    rate: how many there are per second, on average
    duration: length of each
    reads: what is recorded meanwhile
    """
    def __init__(
        self,
        *,
        rate: Scalar,
        duration: Scalar,
        reads: Literal['held', 'zero'] = 'held',
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

class Exciter(_Exciter):
    r"""A torque-controlled motor that shakes the drivetrain; without entries it delivers its set-point exactly.

    The set-point is clipped at the rated torque, rounded by the analog output, and followed with a first-order lag.
    The harmonics bend the torque so delivered: a sine of the excitation's full amplitude A gets the shares of A.

    Parameters
    ----------
    bandwidth: frequency at which the torque is 3 dB below its set-point
    compensated: whether the set-point is raised beforehand so that the delivered torque is flat (feed-forward)
    harmonics: share of the amplitude that a sine gets at its multiples
    limit: rated torque, at which the set-point is clipped
    bits: resolution of the analog output of the set-point
    full_scale: torque at the end of the analog output's range, -full_scale to +full_scale
    """
    def __init__(
        self,
        *,
        bandwidth: Scalar | None = None,
        compensated: bool = False,
        harmonics: object | None = None,
        limit: Scalar | None = None,
        bits: WholeNumber | None = None,
        full_scale: Scalar | None = None,
    ) -> None: ...

class GivenSpeed(_GivenSpeed):
    r"""A speed given over time by a table, straight between its rows.

    Parameters
    ----------
    speed_of: node whose speed it is; by default that of speeds:
    start_angle: angle of the reference shaft at the beginning; 0 is where phases of orders are counted from
    without: excitations of the model that are off
    outside_speeds: whether speeds outside those of the model are meant
    table: rows of time and speed
    """
    def __init__(
        self,
        *,
        speed_of: str = '',
        start_angle: Scalar = 0.0,
        without: tuple[str, ...] | list[str] = (),
        outside_speeds: bool = False,
        table: NumberRows,
    ) -> None: ...

class Hum(_Hum):
    r"""A sine that the mains add to an analog channel, from a phase that the seed decides.

    Parameters
    ----------
    amplitude: peak
    frequency: frequency of the mains
    """
    def __init__(
        self,
        *,
        amplitude: Scalar,
        frequency: Scalar = 50.0,
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

class ListOfValues(_ListOfValues):
    r"""Variation of a parameter over a list of values, each crossed with whatever else varies.

    Parameters
    ----------
    values: the values
    """
    def __init__(
        self,
        *,
        values: tuple[object, ...] | list[object],
    ) -> None: ...

class LogarithmicSweep(_LogarithmicSweep):
    r"""Test signal, a sine whose frequency changes by the same factor every second, f(t) = f_0 (f_1/f_0)^(t/T).

    It stays longer at low frequencies, where the resonances of drivetrains with soft springs lie close together.

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

class Lognormal(_Lognormal):
    r"""Lognormal variation of a parameter, by mean and deviation of the values themselves, not of their logarithms.

    With limits, values beyond them are left out and the rest keeps its proportions.

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

class Multisine(_Multisine):
    r"""Test signal, a multisine with equal amplitudes at all lines of a band, and phases for a low peak.

    From Schroeder's phases on, the signal is clipped and its amplitudes are restored again and again (Van der Ouderaa,
    Schoukens and Renneboog 1988).

    Parameters
    ----------
    amplitude: peak of the alternating torque
    mean: torque added throughout; the test begins in its equilibrium
    start: lower end of the band
    stop: upper end of the band
    period: length of a period; lines are 1/period apart
    periods: how many periods
    seed: the same seed gives the same signal
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

class OperatingPoint(_OperatingPoint):
    r"""Mean speeds (rad/s) and mean external torques (N m) by node, as given in the model.

    A torque between two nodes, ``pulley-block``, acts on the first and as much the other way on the second.

    Parameters
    ----------
    speed: mean speed by node, as 1500 rpm
    torque: mean external torque by node, as 80 N*m, or between two as pulley-block
    """
    def __init__(
        self,
        speed: Mapping[str, Scalar] | None = None,
        torque: Mapping[str, Scalar] | None = None,
    ) -> None: ...

class Parameter(_Parameter):
    r"""A named value.

    ``value`` is a number, a quantity or an expression of other parameters; ``bounds`` (lower, upper) in SI say what is
    plausible and limit fits.

    Parameters
    ----------
    value: a number in SI units, a value with unit, or an expression of parameters
    description: what the parameter is
    bounds: [lower, upper]: what is plausible; limits of a fit
    by: instead of a value: the part of the operating point it follows
    of: the node or element of the operating point it follows
    table: values over that, without sign; default: the speed or torque itself
    """
    def __init__(
        self,
        value: Scalar | None = None,
        description: str = '',
        bounds: object | None = None,
        by: Literal['speed', 'load', 'mean_torque', 'vibratory_torque'] | None = None,
        of: str = '',
        table: NumberByNumber | None = None,
    ) -> None: ...

class PitchErrors(_PitchErrors):
    r"""Errors of the places of the teeth of a wheel; those that are given add up.

    Independent errors of standard deviation s at z teeth add 2 s/sqrt(z) to the peak amplitude of each whole order,
    as the RMS over wheels.

    Parameters
    ----------
    normal: standard deviation of each tooth's place, as a share of a pitch
    uniform: largest error of each tooth's place, plus or minus, as a share of a pitch
    eccentricity: amplitude once per turn, as an angle
    eccentricity_phase: phase of the eccentricity: tooth k is late by a cos(2 pi k/teeth + phase)
    list: by how much each tooth stands beyond its place
    """
    def __init__(
        self,
        *,
        normal: Scalar = 0.0,
        uniform: Scalar = 0.0,
        eccentricity: Scalar = 0.0,
        eccentricity_phase: Scalar = 0.0,
        list: Scalars = (),
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
        excitation: LinearChirp | LogarithmicSweep | SteppedSine | Multisine | BurstRandom | Entries | None = None,
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

class RadialVibration(_RadialVibration):
    r"""Vibration of the centre of a wheel, which a pickup reads as a rotation of displacement over radius.

    The displacement is amplitude cos(order phi + 2 pi frequency t + phase), phi the angle of the reference shaft.

    Parameters
    ----------
    amplitude: peak displacement of the centre
    order: vibrations per revolution of the reference shaft
    frequency: instead: fixed frequency
    phase: phase where phi and time are 0
    direction: direction of the displacement, from the pickup at 0 in the sense of rotation
    """
    def __init__(
        self,
        *,
        amplitude: Scalar,
        order: Scalar | None = None,
        frequency: Scalar | None = None,
        phase: Scalar = 0.0,
        direction: Scalar = 1.5707963267948966,
    ) -> None: ...

class RecordingSystem(_RecordingSystem):
    r"""A second system that records some channels on a clock of its own, into a record of its own.

    It begins ``offset`` after the first one, and its clock gains ``drift`` on that of the first.

    Parameters
    ----------
    channels: channels that it records
    drift: share by which its clock is fast
    offset: time on the first system's clock at which it begins, at its own time 0
    rate: sampling rate, by default that of the first
    """
    def __init__(
        self,
        *,
        channels: tuple[str, ...] | list[str],
        drift: Scalar = 0.0,
        offset: Scalar = 0.0,
        rate: Scalar | None = None,
    ) -> None: ...

class ReportPlan(_ReportPlan):
    r"""Plan of a report: what it holds beside the model itself; empty entries have their default.

    Attributes
    ----------
    kind : {"rig", "approval"}, optional
        Kind of document; default: approval for a model with speeds, excitations and limits.
    title, author, notes : str
    sections : tuple of str
        Names out of :data:`SECTIONS`.
    transfer_functions : tuple of Pair
    orders : tuple of str
        Outputs whose response to the model's excitations is shown over speed.
    measure : tuple of str
        Outputs that are to be measured on board; default: free end of the engine, and the shaft used most.
    configurations : tuple of str
    normal : str
        Configuration that is the normal condition at rated load; on axes that it does not name, the first alternative.
    band : (float, float), optional
        Hz; frequencies of the Bode plots.
    angle : {"rad", "deg"}
    language : {"en", "de"}
        Language of the report's own texts; names and texts of the model stay as they are.
    simplify : float, optional
        Largest relative change of the modes in the band by which transfer functions may be simplified.
    passage : tuple of float
        Times in s in which the passage of barred ranges is shown.
    template : str
        Folder, as seen from the file.
    rules : str, optional
        Short name of a classification society out of ``SOCIETIES``, or of a rule of separation margins.
    appendix : bool
        Whether the sections of the other kind follow in an appendix.
    title_block : TitleBlock, optional
        A document for approval has one in any case, with blank fields.
    not_examined : mapping of str to str
        Conditions that the calculation leaves out, with the reasons.
    idling : tuple of float
        Speeds of longer idling in rad/s, of the shaft of the model's speeds.
    holzer : int, optional
        Number of modes, from the lowest on, whose Holzer tables the calculation for approval prints.

    Parameters
    ----------
    kind: rig: the model with its equations, modes and transfer functions; approval: the torsional calculation
        that a classification society or a customer approves; default: by the model
    title: title of the report; default: name of the model
    author: who signs it
    sections: sections of the report; default: those of its kind that apply
    transfer_functions: OUTPUT/INPUT, in this order
    orders: sensors or nodes shown over speed; default: the sensors of torque
    measure: sensors of the measurement plan; default: free end of the engine and the shaft used most
    configurations: configurations to report; default: all
    normal: configuration that is the normal one at rated load, with which sections begin; default: the first of
        each axis
    band: frequencies of the plots
    angle: unit of angles
    language: language of the report's own texts
    simplify: how far leaving elements out may move the modes in the band, as 1 %
    passage: times in which barred ranges of speed are passed; default: 10 s and 60 s
    notes: remarks of the author, printed under the title
    template: folder with letterhead, style and wording, as seen from this file
    rules: society whose words and list of particulars the document has, or standard of the separation margins of
        a train
    appendix: true: the sections of the other kind of document follow in an appendix
    title_block: title block of the document, with its revisions
    not_examined: conditions that no configuration stands for -> why they were not examined
    idling: speeds of longer idling, of the shaft of speeds:
    holzer: modes with a Holzer table in the document for approval; default: those excited, at most 3
    """
    def __init__(
        self,
        kind: Literal['rig', 'approval'] | None = None,
        title: str = '',
        author: str = '',
        sections: tuple[object, ...] | list[object] = (),
        transfer_functions: tuple[object, ...] | list[object] = (),
        orders: tuple[str, ...] | list[str] = (),
        measure: tuple[str, ...] | list[str] = (),
        configurations: tuple[object, ...] | list[object] = (),
        normal: object = '',
        band: str | tuple[Scalar, Scalar] | list[Scalar] | list[float] | list[str] | None = None,
        angle: Literal['rad', 'deg'] = 'rad',
        language: Literal['en', 'de'] = 'en',
        simplify: Scalar | None = None,
        passage: Scalars = (),
        notes: str = '',
        template: str = '',
        rules: Literal['m68', 'kr', 'lr', 'api610', 'api617', 'api618', 'api684'] | None = None,
        appendix: bool = False,
        title_block: TitleBlock | Entries | None = None,
        not_examined: Mapping[str, str] | None = None,
        idling: Scalars = (),
        holzer: WholeNumber | None = None,
    ) -> None: ...

class Revision(_Revision):
    r"""Revision of a report: its number or letter, date, what was changed and who signed it.

    Attributes
    ----------
    revision, description : str
    date : str
        ISO, as 2025-03-31; empty if blank.
    prepared, checked, approved : str
        Names; empty if blank.

    Parameters
    ----------
    revision: number or letter of the revision
    date: date of the revision, as 2025-03-31
    description: what was changed
    prepared: who prepared it: name, or blank to be written by hand
    checked: who checked it: name, or blank to be written by hand
    approved: who approved it: name, or blank to be written by hand
    """
    def __init__(
        self,
        revision: str | int = '',
        date: str | datetime.date = '',
        description: str | int = '',
        prepared: str | int = '',
        checked: str | int = '',
        approved: str | int = '',
    ) -> None: ...

class RunDown(_RunDown):
    r"""A speed that falls straight over time.

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

class Samples(_Samples):
    r"""Number, method and seed of the draws of parameters with a distribution.

    Random draws are independent of each other, which confidence intervals rest on. A Latin hypercube has one draw in
    each of ``count`` equally likely ranges of every parameter; a Sobol sequence fills the space evenly, best where
    ``count`` is a power of two. Of parameters that are correlated only the first has one draw in each of these ranges;
    the others follow it as their correlation says.

    Parameters
    ----------
    method: how values are drawn
    count: number of draws
    seed: another seed draws other values
    """
    def __init__(
        self,
        *,
        method: Literal['random', 'latin_hypercube', 'sobol'] = 'random',
        count: WholeNumber,
        seed: WholeNumber = 1,
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

class ShuntCalibration(_ShuntCalibration):
    r"""A resistor beside an arm of the bridge, which reads like a known value for a while.

    Parameters
    ----------
    value: what the resistor is to read, added to the measurand
    duration: time for which it is connected
    at: end of the record where it is connected
    """
    def __init__(
        self,
        *,
        value: Scalar,
        duration: Scalar,
        at: Literal['start', 'end'] = 'start',
    ) -> None: ...

class SteadyPoints(_SteadyPoints):
    r"""Steady speeds, each held for a while and recorded by itself; the time between them is left out.

    Parameters
    ----------
    speed_of: node whose speed it is; by default that of speeds:
    start_angle: angle of the reference shaft at the beginning; 0 is where phases of orders are counted from
    without: excitations of the model that are off
    outside_speeds: whether speeds outside those of the model are meant
    speeds: speeds of the points
    duration: time recorded at each
    """
    def __init__(
        self,
        *,
        speed_of: str = '',
        start_angle: Scalar = 0.0,
        without: tuple[str, ...] | list[str] = (),
        outside_speeds: bool = False,
        speeds: Scalars,
        duration: Scalar,
    ) -> None: ...

class SteppedSine(_SteppedSine):
    r"""Test signal, a sine that holds each frequency for whole periods, without jumps of the phase.

    Attributes
    ----------
    frequencies : tuple of float
        Hz.
    hold : float
        Time for each in s, rounded up to whole periods.

    Parameters
    ----------
    amplitude: peak of the alternating torque
    mean: torque added throughout; the test begins in its equilibrium
    frequencies: frequencies, one after the other
    hold: time for each frequency, rounded up to whole periods
    """
    def __init__(
        self,
        *,
        amplitude: Scalar = 1.0,
        mean: Scalar = 0.0,
        frequencies: object,
        hold: Scalar,
    ) -> None: ...

class StrainGauge(_StrainGauge):
    r"""A strain gauge bridge on a shaft with its amplifier and telemetry; it reads gain * value + zero + noise.

    Parameters
    ----------
    sensor: what it reads if its name is no sensor of the model: "velocity(motor)", "torque(gearbox,
        output_shaft)"
    range: largest value, plus or minus; beyond it the reading is clipped
    noise: standard deviation of white noise at the sampling rate
    offset: added to every value
    gain: bridge factor: what the chain reads over what is there
    delay: time by which the channel lags behind the others
    hum: hum of the mains
    drop_outs: times without telemetry
    shunt: shunt calibration
    zero_drift: drift of the zero
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
        shunt: ShuntCalibration | Entries | None = None,
        zero_drift: ZeroDrift | Entries | None = None,
    ) -> None: ...

class TitleBlock(_TitleBlock):
    r"""Title block of a document that is signed: what it is about, whose it is, its revisions and who signs it.

    Every entry may be left out or blank; the document shows a blank field to be filled in by hand.

    Attributes
    ----------
    project, hull, plant, yard, owner, class_society, rules, edition, engine, rating, document_number : str
        A ship has a hull, a plant ashore is named by ``plant``.
    prepared, checked, approved : str
        Names of those who sign.
    revisions : tuple of Revision
        The oldest first; the last one is the revision of the document.

    Parameters
    ----------
    project: project
    hull: hull of the ship, by the number of the yard
    plant: instead of hull: plant, for machinery ashore
    yard: yard or manufacturer
    owner: owner or customer
    class_society: classification society
    rules: rules or standard by which the calculation is judged
    edition: edition of the rules
    engine: type of the engine or driver
    rating: rated power and speed, as 15 MW at 105 r/min
    document_number: number of the document
    prepared: who prepared the document: name, or blank to be written by hand; default: the author
    checked: who checked the document: name, or blank to be written by hand
    approved: who approved the document: name, or blank to be written by hand
    revisions: revisions of the document, the oldest first
    """
    def __init__(
        self,
        project: str | int = '',
        hull: str | int = '',
        plant: str | int = '',
        yard: str | int = '',
        owner: str | int = '',
        class_society: str | int = '',
        rules: str | int = '',
        edition: str | int = '',
        engine: str | int = '',
        rating: str | int = '',
        document_number: str | int = '',
        prepared: str | int = '',
        checked: str | int = '',
        approved: str | int = '',
        revisions: tuple[Revision | Entries, ...] | list[Revision | Entries] = (),
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

class Triangular(_Triangular):
    r"""Triangular variation of a parameter, by lowest, most frequent and highest value.

    Parameters
    ----------
    low: lowest value; -10 % is relative to the value in the model
    mode: most frequent value; by default the value in the model
    high: highest value; +10 % is relative to the value in the model
    """
    def __init__(
        self,
        *,
        low: object,
        mode: object | None = None,
        high: object,
    ) -> None: ...

class Uniform(_Uniform):
    r"""Uniform variation of a parameter, by lowest and highest value.

    Parameters
    ----------
    low: lowest value; -10 % is relative to the value in the model
    high: highest value; +10 % is relative to the value in the model
    """
    def __init__(
        self,
        *,
        low: object,
        high: object,
    ) -> None: ...

class ValueRange(_ValueRange):
    r"""Variation of a parameter from the lowest to the highest value, both included, crossed with whatever else varies.

    Parameters
    ----------
    low: lowest value; -10 % is relative to the value in the model
    high: highest value; +10 % is relative to the value in the model
    count: number of values
    spacing: equal steps, or equal ratios of one value to the next
    """
    def __init__(
        self,
        *,
        low: object,
        high: object,
        count: WholeNumber,
        spacing: Literal['linear', 'log'] = 'linear',
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

class WheelChannel(_WheelChannel):
    r"""A channel of pulses: the wheel that it sees, and how its values are read.

    Parameters
    ----------
    teeth: pulses per revolution of the wheel, missing ones included
    missing_teeth: teeth that the gap lacks, as 2 of a wheel 60-2
    ratio: turns of the reference shaft per turn of the wheel
    reversed: whether the wheel turns against the sense of the model
    pattern: file of its pitch pattern, from the folder of this file; or where its teeth stand: 4 teeth, 2
        missing, 2 teeth, 1 missing; or 0, 80, 180, 270 deg
    tick: time of one count of the counter
    clock: instead: frequency that the counter counts
    bits: width of the counter in bits, which begins at 0 again when it is full
    level: value that a tooth signal passes, in its unit; default: the middle
    hysteresis: share of its height by which a tooth signal must pass on either side
    edge: which flanks of a tooth signal are pulses
    pickup: whether a tooth signal switches, or grows with the speed
    second: channel of a second track a quarter pitch further, which tells the direction
    index: channel of an index pulse, once in a turn of the wheel or in several
    """
    def __init__(
        self,
        *,
        teeth: WholeNumber,
        missing_teeth: WholeNumber = 0,
        ratio: Scalar = 1.0,
        reversed: bool = False,
        pattern: str = '',
        tick: Scalar | None = None,
        clock: Scalar | None = None,
        bits: WholeNumber | None = None,
        level: Scalar | None = None,
        hysteresis: Scalar = 0.2,
        edge: Literal['rising', 'falling'] = 'rising',
        pickup: Literal['switching', 'inductive'] = 'switching',
        second: str = '',
        index: str = '',
    ) -> None: ...

class ZeroDrift(_ZeroDrift):
    r"""A zero that moves over the record, straight or as something that warms up.

    Parameters
    ----------
    change: change of the zero from the first to the last sample
    warming: time constant of warming up; without it the zero moves straight
    """
    def __init__(
        self,
        *,
        change: Scalar,
        warming: Scalar | None = None,
    ) -> None: ...
