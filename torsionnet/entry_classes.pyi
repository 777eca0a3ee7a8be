# Written by `make generate`.
import datetime
from collections.abc import Mapping
from torsionnet.core.entries.accepted_types import Entries, NumberByNumber, Scalar, Scalars, WholeNumber
from torsionnet.model.report import SECTIONS
from typing import Literal
from torsionnet.model.bench.parts import Acquisition as _Acquisition
from torsionnet.signals.excitation.broadband import BurstRandom as _BurstRandom
from torsionnet.study.space.correlation import Correlation as _Correlation
from torsionnet.model.bench.parts import Encoder as _Encoder
from torsionnet.model.bench.parts import Exciter as _Exciter
from torsionnet.signals.excitation.sweeps import LinearChirp as _LinearChirp
from torsionnet.study.space.variations.list_of_values import ListOfValues as _ListOfValues
from torsionnet.signals.excitation.sweeps import LogarithmicSweep as _LogarithmicSweep
from torsionnet.study.space.variations.lognormal import Lognormal as _Lognormal
from torsionnet.signals.excitation.broadband import Multisine as _Multisine
from torsionnet.study.space.variations.normal import Normal as _Normal
from torsionnet.model.operating_point import OperatingPoint as _OperatingPoint
from torsionnet.model.parameters import Parameter as _Parameter
from torsionnet.model.bench.plan import Plan as _Plan
from torsionnet.model.report.report_plan import ReportPlan as _ReportPlan
from torsionnet.model.report.title_block import Revision as _Revision
from torsionnet.study.space.samples import Samples as _Samples
from torsionnet.signals.excitation.sweeps import SteppedSine as _SteppedSine
from torsionnet.model.report.title_block import TitleBlock as _TitleBlock
from torsionnet.model.bench.parts import Transducer as _Transducer
from torsionnet.study.space.variations.triangle import Triangular as _Triangular
from torsionnet.study.space.variations.uniform import Uniform as _Uniform
from torsionnet.study.space.variations.range_of_values import ValueRange as _ValueRange

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

class Plan(_Plan):
    r"""A test: what drives the drivetrain, what is measured, and how it is recorded.

    Attributes
    ----------
    excitation : Excitation
        Set-point of the torque.
    channels : mapping of str to Transducer or Encoder
        By the name of a sensor of the model, or of any other name with a ``sensor`` of its own.
    acquisition : Acquisition
    exciter : Exciter, optional
        By default delivers its set-point exactly.
    drive : str, optional
        Input of the model on which the torque acts; by default the only one there is.
    seed : int, optional
        Of noise and of the encoders' starting positions; the same seed gives the same record.

    Parameters
    ----------
    drive: input on which the torque acts, if there are several
    excitation: what the torque is to be
    exciter: the motor that shakes
    channels: what is recorded, by the name of a sensor
    acquisition: sampling of all channels
    seed: the same seed gives the same record
    """
    def __init__(
        self,
        *,
        drive: str = '',
        excitation: LinearChirp | LogarithmicSweep | SteppedSine | Multisine | BurstRandom | Entries,
        exciter: Exciter | Entries = Exciter(bandwidth=None, compensated=False, harmonics=None, limit=None, bits=None, full_scale=None),
        channels: Mapping[str, Transducer | Encoder | Entries],
        acquisition: Acquisition | Entries,
        seed: WholeNumber = 0,
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
