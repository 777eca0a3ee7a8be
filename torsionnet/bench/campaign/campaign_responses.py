"""Entries of the frequency responses of a campaign, of a rig that is shaken or hammered."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import Listed, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Band, Bands, Value
from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import Fault
from torsionnet.identification.plan.fit_entries import FitSettings


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
        found = []
        if not self.outputs:
            found.append(Fault("name at least one output", ("outputs",)))
        if self.input in self.outputs:
            place = self.outputs.index(self.input)
            found.append(Fault(f"{self.input} is the input, too; leave it out", ("outputs", place)))
        return found
