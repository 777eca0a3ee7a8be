"""Plan of the report on a model, from the ``report:`` section of its file.

Here as well: sections of a report, in their order, and the kinds of document they belong to.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

from torsionnet.base.entries.composite import Listed, Named, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Band, Value
from torsionnet.base.entries.spec import (
    Count,
    EntryError,
    Flag,
    OneOf,
    Schema,
    Spec,
    Text,
    entry,
)
from torsionnet.base.errors import Fault, unfit_word
from torsionnet.base.packages import imported
from torsionnet.model.channels import PAIR, ChannelName, Pair
from torsionnet.model.configurations import ConfigurationName

if TYPE_CHECKING:
    from torsionnet.report.plan.title_block import TitleBlock

KINDS = {
    "rig": "the model with its equations, modes and transfer functions",
    "approval": "the torsional calculation that a classification society or a customer approves",
}
"""Description of every kind of document that a report may be, by its name."""


@dataclass(frozen=True)
class SectionContent:
    """Description of what a section of a report contains, and the kinds of document that have it unless asked."""

    description: str
    kinds: tuple[str, ...] = ("rig",)


APPROVAL, BOTH = ("approval",), ("rig", "approval")
"""Names of the kinds of document that have a section: the one for approval alone, or each."""

SECTIONS = {
    "conclusion": SectionContent(
        "verdict of every component, operating instructions, and what is not covered", APPROVAL
    ),
    "summary": SectionContent("natural frequencies, damping ratios, static values and peaks at a glance"),
    "conditions": SectionContent("conditions of operation: which were examined, which not and why", APPROVAL),
    "installation": SectionContent(
        "engine, propeller, gear and couplings with data and sources; power, speed and torque along the line", APPROVAL
    ),
    "schematic": SectionContent("the drivetrain drawn", BOTH),
    "elements": SectionContent("elements with their values, inputs and sensors"),
    "parameters": SectionContent("parameters, configurations, operating point"),
    "kinematics": SectionContent("which node follows which, and by what ratio"),
    "equations": SectionContent("equations of motion, M, C and K in symbols and numbers"),
    "mass_elastic": SectionContent("one table of all inertias, shafts and dampers, referred and as they are", APPROVAL),
    "modes": SectionContent("modes of every configuration, energy shares, shapes"),
    "natural_frequencies": SectionContent(
        "natural frequencies, relative amplitudes with nodes drawn, Holzer tables", APPROVAL
    ),
    "formulas": SectionContent("transfer functions in symbols with their limits"),
    "simplified": SectionContent(
        "the same without elements that hardly matter, with the error, if asked for or `simplify` is given"
    ),
    "responses": SectionContent("transfer functions over frequency, overlaid by configuration"),
    "excitations": SectionContent("what runs, at which speeds, and the torques it excites with by order"),
    "harmonics": SectionContent(
        "mean indicated pressure, tangential harmonics, vector sums by mode, misfire, propeller", APPROVAL
    ),
    "mean_torques": SectionContent("mean torque, stress and power of every element under the load"),
    "critical_speeds": SectionContent("orders against natural frequencies, interference diagram, Holzer tables"),
    "resonances": SectionContent(
        "critical speeds with equilibrium amplitude, generalised force, damping shares and stress at the peak", APPROVAL
    ),
    "orders": SectionContent("amplitudes over speed by order, and all orders together, in every configuration"),
    "periodic_motions": SectionContent(
        "all steady motions where laws of motion act in full, which are stable, and where sweeps jump", BOTH
    ),
    "forced_response": SectionContent(
        "stress or torque over speed of every component in every condition, and the orders of the peaks", APPROVAL
    ),
    "limits": SectionContent(
        "stresses, couplings, gears and dampers against what they bear; barred ranges and the conclusion"
    ),
    "components": SectionContent(
        "rules, factors and sources of shafts, crankshaft, couplings, gears, dampers and generators", APPROVAL
    ),
    "passage": SectionContent(
        "stress and cycles while a barred range of speeds is passed slowly and quickly", APPROVAL
    ),
    "scenarios": SectionContent("motion over time under scenarios: peaks, events, energies, signals drawn", BOTH),
    "measurement_plan": SectionContent(
        "where to measure on board, the amplitudes expected, and measured orders beside them", APPROVAL
    ),
    "test": SectionContent("tests over the model", BOTH),
    "loops": SectionContent("loops of a component bench: picture, stages, what was corrected and what was not", BOTH),
    "fit": SectionContent("fitted parameters with intervals", BOTH),
    "study": SectionContent("what varies, every quantity over all variants, limits kept, and what is concluded", BOTH),
    "checks": SectionContent("findings of the checks, and how well the numbers agree with a second way to them"),
    "validity": SectionContent("what the results rest on", BOTH),
}
"""Content of every section of a report by the section's name, in the order of the document."""

ANGLES = ("rad", "deg")
"""Names of the units of angle that a report may use."""
SOCIETY_NAMES = ("m68", "kr", "lr")
"""Short names of the societies whose words a report can have, as rows of data on them stand in the room of limits."""
LANGUAGES = ("en", "de")
"""Codes of the languages in which a report can be written: English and German."""


def unknown_section(name: Any) -> Fault | None:
    """Fault that there is no section of that name in a report, or None."""
    rest = f"known: {', '.join(SECTIONS)}"
    return None if name in SECTIONS else unfit_word(f'no section is named "{name}"', str(name), SECTIONS, rest=rest)


class SectionName(Spec[str]):
    """Entry of the name of a section of the report."""

    def coerce(self, raw: object) -> str:
        name = ConfigurationName("").coerce(raw)
        if reason := unknown_section(name):
            raise EntryError(reason, kind="unknown-word")
        return name

    def schema(self) -> Schema:
        return {"oneOf": [{"const": name, "description": content.description} for name, content in SECTIONS.items()]}


SIMPLIFY = Value("how far leaving elements out may move the modes in the band, as 1 %", "1", exclusive=True, below=1)
"""Specification of the report's entry for the largest change of modes in simplified transfer functions."""
_KIND = OneOf("; ".join(f"{name}: {text}" for name, text in KINDS.items()) + "; default: by the model", tuple(KINDS))
_SECTIONS = Listed(
    "sections of the report; default: those of its kind that apply", SectionName(""), form="a list of names"
)
_PAIRS = Listed("OUTPUT/INPUT, in this order", PAIR, form="a list such as [theta_1/T_T]")
_ORDERS = Listed(
    "sensors or nodes shown over speed; default: the sensors of torque",
    ChannelName("sensor or node"),
    form="a list such as [T_C]",
)
_RULES = OneOf(
    "society whose words and list of particulars the document has, or standard of the separation margins of a train",
    (*SOCIETY_NAMES, "api610", "api617", "api618", "api684"),
)
_NOT_EXAMINED = Named(
    "conditions that no configuration stands for -> why they were not examined",
    Text("the reason", "the reason in words"),
    form='conditions with the reason in words, {"PTO engaged": no generator is fitted}',
)
_IDLING = Listed(
    "speeds of longer idling, of the shaft of speeds:",
    Value("a speed", "speed", exclusive=True),
    form="a list such as [300 rpm]",
)
_PASSAGE = Listed(
    "times in which barred ranges of speed are passed; default: 10 s and 60 s",
    Value("from one end of a range to the other", "time", exclusive=True),
    form="a list such as [10 s, 60 s]",
)
_MEASURE = Listed(
    "sensors of the measurement plan; default: free end of the engine and the shaft used most",
    ChannelName("sensor or node"),
    form="a list such as [phi_1, T_int]",
)
_NORMAL = ConfigurationName(
    "configuration that is the normal one at rated load, with which sections begin; default: the first of each axis"
)
_TITLE_BLOCK = Nested(
    "title block of the document, with its revisions",
    partial(imported, "torsionnet.report.plan.title_block:TitleBlock"),
    "report_title_block",
)
_NAMES = Listed("configurations to report; default: all", ConfigurationName(""), form="a list of names")


@dataclass(frozen=True)
class ReportPlan(Declared):
    """Plan of a report: what it holds beside the model itself; empty entries have their default.

    Attributes
    ----------
    kind : {"rig", "approval"}, optional
        Kind of document; default: approval for a model with speeds, excitations and limits.
    title, author, notes : str
    sections : tuple of str
        Names out of :data:`torsionnet.report.plan.SECTIONS`.
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
    """

    article: ClassVar[str] = "a report"
    kind: str | None = entry(_KIND, None)  # type: ignore[assignment, misc]  # here an entry, elsewhere the name of a class

    title: str = entry(Text("title of the report; default: name of the model"), "")
    author: str = entry(Text("who signs it"), "")
    sections: tuple[str, ...] = entry(_SECTIONS, ())
    transfer_functions: tuple[Pair, ...] = entry(_PAIRS, ())
    orders: tuple[str, ...] = entry(_ORDERS, ())
    measure: tuple[str, ...] = entry(_MEASURE, ())
    configurations: tuple[str, ...] = entry(_NAMES, ())
    normal: str = entry(_NORMAL, "")
    band: tuple[float, float] | None = entry(Band("frequencies of the plots"), None)
    angle: str = entry(OneOf("unit of angles", ANGLES), "rad")
    language: str = entry(OneOf("language of the report's own texts", LANGUAGES), "en")
    simplify: float | None = entry(SIMPLIFY, None)
    passage: tuple[float, ...] = entry(_PASSAGE, ())
    notes: str = entry(Text("remarks of the author, printed under the title"), "")
    template: str = entry(Text("folder with letterhead, style and wording, as seen from this file"), "")
    rules: str | None = entry(_RULES, None)
    appendix: bool = entry(Flag("true: the sections of the other kind of document follow in an appendix"), False)
    title_block: TitleBlock | None = entry(_TITLE_BLOCK, None)
    not_examined: Mapping[str, str] = entry(_NOT_EXAMINED, None)
    idling: tuple[float, ...] = entry(_IDLING, ())
    holzer: int | None = entry(
        Count("modes with a Holzer table in the document for approval; default: those excited, at most 3", 0, 99), None
    )


ReportPlan.form = f"the entries {', '.join(name for name, _ in ReportPlan.specs())}"
