"""Entries of a campaign file, which describes all records of a rotating test at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from torsionnet.base.entries.composite import Listed, Named, Nested
from torsionnet.base.entries.declared import KEY, Declared
from torsionnet.base.entries.scalars import Band, Bands, Value
from torsionnet.base.entries.spec import MODEL_NAME, Count, Flag, OneOf, Text, entry
from torsionnet.base.errors import EntryPath, Fault, TorsionnetError, UsageError, fault_of
from torsionnet.drivetrain import Drivetrain
from torsionnet.identification.plan.fit_entries import (
    QUANTITIES,
    READING,
    FileReading,
    FitParameter,
    FitSettings,
    ParameterTable,
)
from torsionnet.identification.residuals.measurement_blocks import welch_settings
from torsionnet.model.channels import Pair
from torsionnet.model.checks.names import pair_faults
from torsionnet.model.sections import section_class
from torsionnet.signals.orders.tracking_entries import BANDWIDTH, ORDERS, OrderList
from torsionnet.signals.orders.vold_kalman import VoldKalman
from torsionnet.signals.rotation.wheel_channel import WheelChannel

if TYPE_CHECKING:
    from torsionnet.report.plan.report_plan import ReportPlan


# Entries of what is checked in the records of a campaign, and from which share on a record is left out.


@dataclass(frozen=True, kw_only=True)
class CheckLevels(Declared):
    """Shares from which a fault of a record has consequences; below them it is a remark."""

    kind: ClassVar[str] = "check levels"
    article: ClassVar[str] = "a check"
    form: ClassVar[str] = "{leave_out: 0.1 %, fail: 1 %}"

    leave_out: float | None = entry(Value("share from which the record is left out", "1"), None)
    fail: float | None = entry(Value("share from which the command fails with exit code 1", "1"), None)

    def contradictions(self) -> list[Fault]:
        if self.leave_out is None and self.fail is None:
            return [Fault(f"a check needs leave_out or fail: {self.form}", on_key=True, kind="missing-entry")]
        return []

    def consequence(self, share: float) -> str:
        """Name of the consequence of a share of faulty samples or pulses; empty where it is a remark alone."""
        if self.fail is not None and share >= self.fail:
            return "fails"
        return "left out" if self.leave_out is not None and share >= self.leave_out else ""


@dataclass(frozen=True, kw_only=True)
class CampaignChecks(Declared):
    """Levels of the checks of the records of a campaign; without one what is found is a remark."""

    kind: ClassVar[str] = "campaign checks"
    article: ClassVar[str] = "the section checks"
    form: ClassVar[str] = "{clipping: {leave_out: 0.1 %}}"

    clipping: CheckLevels | None = entry(
        Nested("samples of a channel at the limit of its range", lambda: CheckLevels, "check_levels"), None
    )
    drop_outs: CheckLevels | None = entry(
        Nested("samples in which a channel stands still or has no number", lambda: CheckLevels, "check_levels"), None
    )
    pulses: CheckLevels | None = entry(
        Nested("pulses of a wheel that are missing or too many", lambda: CheckLevels, "check_levels"), None
    )


# Entries of the frequency responses of a campaign, of a rig that is shaken or hammered.


@dataclass(frozen=True, kw_only=True)
class CampaignResponses(Declared):
    """Frequency responses that are estimated from the records of a campaign; the entries are those of a fit's tests."""

    kind: ClassVar[str] = "campaign responses"
    article: ClassVar[str] = "the section responses"
    form: ClassVar[str] = "{input: T_T, outputs: [theta_1]}"

    input: str = entry(Text("channel of what drives the rig"))
    outputs: tuple[str, ...] = entry(Listed("channels", Text("channel"), form="a list of channels, [theta_1]"))
    model_input: str = entry(Text("input or sensor of the model, if it has another name there"), "")
    excitation: str | None = entry(Text("what drives the model, if it has several inputs"), None)
    band: tuple[float, float] | None = entry(Band("frequencies that are compared", from_zero=True), None)
    excluded: tuple[tuple[float, float], ...] = entry(Bands("bands that the fit leaves out"), None)
    reference: str = entry(Text("channel of the set-point; by default none"), "")
    settling: float = entry(Value("time at the start that the fit leaves out", "time"), 0.0)
    settings: FitSettings | None = entry(
        Nested("how records are averaged", lambda: FitSettings, "settings", optional=True), None
    )

    def contradictions(self) -> list[Fault]:
        faults = []
        if not self.outputs:
            faults.append(Fault("name at least one output", ("outputs",), kind="missing-entry"))
        if self.input in self.outputs:
            place = self.outputs.index(self.input)
            faults.append(
                Fault(f"{self.input} is the input, too; leave it out", ("outputs", place), kind="needless-entry")
            )
        return faults


SHOWS = ("orders", "responses")
"""Names of what a record shows: orders of a turning machine, or frequency responses of a rig that is shaken."""
METHODS = ("average", "vold-kalman")
"""Ways to track orders: synchronous averages over cycles, or Vold-Kalman filters."""
_OWN_ORDERS = OrderList("orders tracked of it, instead of those of all")


@dataclass(frozen=True, kw_only=True)
class CampaignWheel(WheelChannel):
    """A toothed wheel of a campaign: how its pulses are read, and the sensor of the model whose angle it shows."""

    kind: ClassVar[str] = "campaign wheel"

    sensor: str = entry(Text("angle of the model that it shows; by default the sensor of its name"), "")
    orders: tuple[float, ...] | None = entry(_OWN_ORDERS, None)


@dataclass(frozen=True, kw_only=True)
class CampaignChannel(Declared):
    """A sampled channel of a campaign with its calibration, and the sensor of the model that it reads."""

    kind: ClassVar[str] = "campaign channel"
    article: ClassVar[str] = "a channel"
    form: ClassVar[str] = "{sensor: torque(shaft), gain: 1.02}"

    sensor: str = entry(Text("sensor of the model; by default that of its name"), "")
    quantity: str | None = entry(OneOf("what it is, where its unit does not tell it", QUANTITIES), None)
    unit: str = entry(Text("its unit, where the file has none or a wrong one"), "")
    gain: float = entry(
        Value("factor by which its values are multiplied, as from a shunt calibration", "1", lower=None), 1.0
    )
    delay: float = entry(Value("time by which it lags behind the pulses, as by telemetry; it is removed", "time"), 0.0)
    orders: tuple[float, ...] | None = entry(_OWN_ORDERS, None)


@dataclass(frozen=True, kw_only=True)
class CampaignTwist(Declared):
    """The twist between two wheels, or the torque that a stiffness makes of it."""

    kind: ClassVar[str] = "campaign twist"
    article: ClassVar[str] = "a twist"
    form: ClassVar[str] = "{first: wheel, second: wheel, stiffness: 2 MN*m/rad}"

    first: str = entry(Text("wheel whose angle counts as positive"))
    second: str = entry(Text("wheel whose angle is taken off, over the ratio of the two"))
    stiffness: float | None = entry(
        Value("of the shaft between them; makes a torque", "stiffness", exclusive=True), None
    )
    sensor: str = entry(Text("sensor of the model; by default that of its name"), "")
    orders: tuple[float, ...] | None = entry(_OWN_ORDERS, None)


@dataclass(frozen=True, kw_only=True)
class CampaignRecord(Declared):
    """A record of a campaign with the conditions under which it was taken."""

    kind: ClassVar[str] = "campaign record"
    article: ClassVar[str] = "a record"
    form: ClassVar[str] = "{file: run_up.npz, configuration: normal}"

    file: str = entry(Text("file of signals and pulses, from the folder of this file"))
    configuration: str = entry(Text("configuration of the model, as the gear or a misfire"), "")
    condition: str = entry(Text("load, temperature and what else repeats; records of one condition are compared"), "")
    temperature: float | None = entry(
        Value("temperature of the oil or the elastic parts, for the tables", "temperature", lower=None), None
    )
    shows: str | None = entry(
        OneOf("orders or frequency responses, where the campaign has both; by default both", SHOWS), None
    )
    start: float | None = entry(Value("time from which the record counts", "time", lower=None), None)
    stop: float | None = entry(Value("time up to which the record counts", "time", lower=None), None)
    reading: FileReading | None = entry(READING, None)

    def arguments(self, channels: Mapping[str, CampaignChannel]) -> dict[str, Any]:
        """Keyword arguments of :func:`read_recording` for channels of a campaign: what these and the record say."""
        given = (self.reading or FileReading()).arguments
        quantities = {name: channel.quantity for name, channel in channels.items() if channel.quantity}
        units = {name: channel.unit for name, channel in channels.items() if channel.unit}
        own = {"quantities": quantities | given.get("quantities", {}), "units": units | given.get("units", {})}
        return given | own

    def contradictions(self) -> list[Fault]:
        if self.start is not None and self.stop is not None and not self.start < self.stop:
            return [Fault("start comes before stop", ("stop",), kind="unordered-rows")]
        return []


@dataclass(frozen=True, kw_only=True)
class CampaignPhase(Declared):
    """Reference of phases: a mark on the shaft, and the angle from it to top dead centre."""

    kind: ClassVar[str] = "campaign phase"
    article: ClassVar[str] = "the section phase"

    index: str = entry(
        Text("pulses once per turn; by default cam, else the gap or the index of the reference wheel"), ""
    )
    cam: str = entry(Text("pulses once per cycle; the first mark after it begins the cycle, or it is the mark"), "")
    tdc: float | None = entry(Value("angle from the mark to top dead centre", "angle", lower=None), None)
    cylinder: str = entry(Text("cylinder of that top dead centre"), "1")


@dataclass(frozen=True, kw_only=True)
class CampaignOrders(Declared):
    """Orders that are tracked, and how."""

    kind: ClassVar[str] = "campaign orders"
    article: ClassVar[str] = "the section orders"
    form: ClassVar[str] = "{tracked: 0.5:12:0.5}"

    tracked: tuple[float, ...] = entry(ORDERS)
    method: str = entry(OneOf("averages over cycles, or Vold-Kalman filters", METHODS), METHODS[0])
    bandwidth: VoldKalman | None = entry(BANDWIDTH, None)
    cycles: int | None = entry(Count("cycles of an average", lower=2), None)
    step: float | None = entry(
        Value("step of speed of an average, instead of a number of cycles", "speed", exclusive=True), None
    )
    cycle: int = entry(Count("turns after which vibration repeats", lower=1, upper=100), 2)

    def contradictions(self) -> list[Fault]:
        faults = []
        if self.bandwidth is not None and self.method == METHODS[0]:
            faults.append(
                Fault("a bandwidth belongs to method: vold-kalman", ("bandwidth",), on_key=True, kind="needless-entry")
            )
        if self.cycles and self.method == METHODS[1]:
            faults.append(Fault("cycles belong to method: average", ("cycles",), on_key=True, kind="needless-entry"))
        if self.cycles and self.step:
            faults.append(
                Fault(
                    "cycles and step both say over what is averaged; leave one out",
                    ("step",),
                    on_key=True,
                    kind="contradicting-entries",
                )
            )
        return faults


@dataclass(frozen=True, kw_only=True)
class CampaignFit(Declared):
    """Parameters that are found from the orders and responses of all records together."""

    kind: ClassVar[str] = "campaign fit"
    article: ClassVar[str] = "the section fit"

    parameters: Mapping[str, FitParameter | None] | None = entry(
        ParameterTable(
            "the parameters to be found, by name",
            _PARAMETER := Nested(
                "a parameter to be found", lambda: FitParameter, "unknown", shorthand="start", optional=True
            ),
            fewest=1,
        ),
        None,
    )
    rank: bool = entry(Flag("rank which value, freed alone, would explain what is left"), False)
    reference_angle: bool = entry(Flag("find the angle along at which the reference of the phases stands"), False)


@dataclass(frozen=True, kw_only=True)
class CampaignFile(Declared):
    """A campaign: records of one machine, read, tracked, compared with its model and fitted by one command."""

    kind: ClassVar[str] = "campaign"
    article: ClassVar[str] = "a campaign"
    head: ClassVar[tuple[str, ...]] = (KEY,)

    name: str = entry(Text("title of the campaign"), "")
    source: str = entry(Text("where its records come from"), "")
    description: str = entry(Text("what was tested, where and when"), "")
    model: str = entry(
        Text("name of a library model, or path of a model file from the folder of this file", MODEL_NAME)
    )
    wheels: Mapping[str, CampaignWheel] = entry(
        Named(
            "toothed wheels, by the name of their channel; orders need one",
            Nested("a wheel", lambda: CampaignWheel, "campaign_wheel"),
        ),
        None,
    )
    reference: str = entry(Text("wheel of the shaft whose revolutions orders count; by default the only one"), "")
    phase: CampaignPhase | None = entry(Nested("what phases count from", lambda: CampaignPhase, "campaign_phase"), None)
    channels: Mapping[str, CampaignChannel] = entry(
        Named("sampled channels, by name", Nested("a channel", lambda: CampaignChannel, "campaign_channel")), None
    )
    twists: Mapping[str, CampaignTwist] = entry(
        Named("twists between wheels, by name", Nested("a twist", lambda: CampaignTwist, "campaign_twist")), None
    )
    records: Mapping[str, CampaignRecord] = entry(
        Named(
            "records, by name",
            Nested("a record", lambda: CampaignRecord, "campaign_record", shorthand="file"),
            fewest=1,
        )
    )
    orders: CampaignOrders | None = entry(
        Nested("orders that are tracked", lambda: CampaignOrders, "campaign_orders", shorthand="tracked"), None
    )
    responses: CampaignResponses | None = entry(
        Nested("frequency responses that are estimated", lambda: CampaignResponses, "campaign_responses"), None
    )
    checks: CampaignChecks | None = entry(
        Nested("when a record is left out, or the command fails", lambda: CampaignChecks, "campaign_checks"), None
    )
    fit: CampaignFit | None = entry(Nested("parameters that are found", lambda: CampaignFit, "campaign_fit"), None)
    report: ReportPlan | None = entry(
        Nested(
            "the report, where it differs from that of the model",
            lambda: section_class("report"),
            "report",
            optional=True,
        ),
        None,
    )

    @classmethod
    def key_faults(cls, raw: Mapping[Any, Any], name: str = "") -> list[Fault]:
        """Faults of missing or unknown keys; a campaign has orders, which need wheels, or responses."""
        faults = super().key_faults(raw, name)
        if not {"orders", "responses"} & set(raw):
            text = "a campaign needs orders, of turning machines, or responses, of a rig that is shaken or hammered"
            faults.append(Fault(text, on_key=True, kind="missing-entry", about="orders"))
        if "orders" in raw and not raw.get("wheels"):
            faults.append(cls.missing("wheels", name))
        return faults


def tracked_entries(plan: CampaignFile) -> dict[str, CampaignChannel | CampaignWheel | CampaignTwist]:
    """Channels, wheels and twists of a campaign by name, in this order."""
    return {**(plan.channels or {}), **plan.wheels, **(plan.twists or {})}


# Faults of the section ``responses`` of a campaign file, found before a record is read.

ANY_FREQUENCY = 1.0
"""Frequency in Hz at which the model is asked whether it has a response at all; any will do."""


def response_faults(plan: CampaignFile, model: Drivetrain) -> Iterator[Fault]:
    """Yield the faults of the responses of a campaign: settings, and names that the model does not have."""
    asked = plan.responses
    if asked is None:
        return
    if asked.settings is not None:
        try:
            welch_settings(asked.settings)
        except UsageError as error:
            yield replace(error.fault, path=("responses", "settings"))
    for place, output in enumerate(asked.outputs):
        channel = (plan.channels or {}).get(output)
        named = Pair(
            (channel.sensor if channel else "") or output, asked.model_input or asked.input, asked.excitation or ""
        )
        at: EntryPath = (
            ("channels", output, "sensor") if channel and channel.sensor else ("responses", "outputs", place)
        )
        placed = [_placed(fault, named, asked, at, first=not place) for fault in pair_faults(named, model.definition)]
        known = [fault for fault in placed if fault is not None]
        yield from known
        if not placed:
            yield from _of_model(plan, model, named, at)


def _placed(fault: Fault, pair: Pair, asked: CampaignResponses, at: EntryPath, *, first: bool) -> Fault | None:
    """Fault at its place in the file; None where an earlier output or the section channels had it already."""
    if fault.about == pair.output:
        hint = "; name its sensor in the model under channels" if at[0] == "responses" else ""
        return None if at[0] == "channels" else Fault(f"{fault.message}{hint}", at, kind=fault.kind)
    key = "excitation" if fault.about == asked.excitation else "model_input" if asked.model_input else "input"
    hint = "; name that of the model by model_input" if key == "input" else ""
    return Fault(f"{fault.message}{hint}", ("responses", key), kind=fault.kind) if first else None


def _of_model(plan: CampaignFile, model: Drivetrain, pair: Pair, at: EntryPath) -> Iterator[Fault]:
    """Yield what the model answers where it has no such response in the configuration of the first record."""
    name = next((record.configuration for record in plan.records.values() if record.shows in (None, "responses")), "")
    try:
        rig = model.configured(name) if name else model
    except TorsionnetError:
        return  # said of the record
    try:
        rig.frequency_response(pair.output, pair.input, [ANY_FREQUENCY], driven_by=pair.excitation or None)
    except TorsionnetError as error:
        yield replace(fault_of(error, error.kind), path=at)
