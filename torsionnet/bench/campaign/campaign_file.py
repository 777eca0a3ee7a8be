"""Entries of a campaign file, which describes all records of a rotating test at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from torsionnet.base.entries.composite import Named, Nested
from torsionnet.base.entries.declared import KEY, Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import MODEL_NAME, Count, Flag, OneOf, Text, entry
from torsionnet.base.errors import MISSING_KEY, Fault
from torsionnet.bench.campaign.campaign_checks import CampaignChecks
from torsionnet.bench.campaign.campaign_responses import CampaignResponses
from torsionnet.identification.plan.fit_entries import QUANTITIES, READING, FileReading, FitParameter, ParameterTable
from torsionnet.model.sections import section_class
from torsionnet.signals.orders.tracking_entries import BANDWIDTH, ORDERS, OrderList
from torsionnet.signals.orders.vold_kalman import VoldKalman
from torsionnet.signals.rotation.wheel_channel import WheelChannel

if TYPE_CHECKING:
    from torsionnet.report.plan.report_plan import ReportPlan

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
            return [Fault("start comes before stop", ("stop",))]
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
        found = []
        if self.bandwidth is not None and self.method == METHODS[0]:
            found.append(Fault("a bandwidth belongs to method: vold-kalman", ("bandwidth",), on_key=True))
        if self.cycles and self.method == METHODS[1]:
            found.append(Fault("cycles belong to method: average", ("cycles",), on_key=True))
        if self.cycles and self.step:
            found.append(Fault("cycles and step both say over what is averaged; leave one out", ("step",), on_key=True))
        return found


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
        found = super().key_faults(raw, name)
        if not {"orders", "responses"} & set(raw):
            text = "a campaign needs orders, of turning machines, or responses, of a rig that is shaken or hammered"
            found.append(Fault(text, on_key=True, kind=MISSING_KEY, about="orders"))
        if "orders" in raw and not raw.get("wheels"):
            found.append(cls.missing("wheels", name))
        return found


def tracked_entries(plan: CampaignFile) -> dict[str, CampaignChannel | CampaignWheel | CampaignTwist]:
    """Channels, wheels and twists of a campaign by name, in this order."""
    return {**(plan.channels or {}), **plan.wheels, **(plan.twists or {})}
