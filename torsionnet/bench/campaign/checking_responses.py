"""Faults of the section ``responses`` of a campaign file, found before a record is read."""

from __future__ import annotations

from collections.abc import Iterator

from torsionnet.base.errors import EntryPath, Fault, TorsionnetError, UsageError
from torsionnet.bench.campaign.campaign_file import CampaignFile
from torsionnet.bench.campaign.campaign_responses import CampaignResponses
from torsionnet.drivetrain import Drivetrain
from torsionnet.identification.residuals.welch_choice import welch_settings
from torsionnet.model.checks.names import pair_faults
from torsionnet.model.response_pair import Pair

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
            yield Fault(str(error), ("responses", "settings"))
    for place, output in enumerate(asked.outputs):
        channel = (plan.channels or {}).get(output)
        named = Pair(
            (channel.sensor if channel else "") or output, asked.model_input or asked.input, asked.excitation or ""
        )
        at: EntryPath = (
            ("channels", output, "sensor") if channel and channel.sensor else ("responses", "outputs", place)
        )
        found = [_placed(fault, named, asked, at, first=not place) for fault in pair_faults(named, model.definition)]
        known = [fault for fault in found if fault is not None]
        yield from known
        if not found:
            yield from _of_model(plan, model, named, at)


def _placed(fault: Fault, pair: Pair, asked: CampaignResponses, at: EntryPath, *, first: bool) -> Fault | None:
    """Fault at its place in the file; None where an earlier output or the section channels had it already."""
    if fault.about == pair.output:
        hint = "; name its sensor in the model under channels" if at[0] == "responses" else ""
        return None if at[0] == "channels" else Fault(f"{fault.message}{hint}", at)
    key = "excitation" if fault.about == asked.excitation else "model_input" if asked.model_input else "input"
    hint = "; name that of the model by model_input" if key == "input" else ""
    return Fault(f"{fault.message}{hint}", ("responses", key)) if first else None


def _of_model(plan: CampaignFile, model: Drivetrain, pair: Pair, at: EntryPath) -> Iterator[Fault]:
    """Yield what the model answers where it has no such response in the configuration of the first record."""
    name = next((one.configuration for one in plan.records.values() if one.shows in (None, "responses")), "")
    try:
        rig = model.configured(name) if name else model
    except TorsionnetError:
        return  # said of the record
    try:
        rig.frequency_response(pair.output, pair.input, [ANY_FREQUENCY], excitation=pair.excitation or None)
    except TorsionnetError as error:
        yield Fault(str(error), at)
