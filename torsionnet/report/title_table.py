"""Title block of a report, from its plan and from what the model and the program know themselves."""

from __future__ import annotations

from torsionnet.report.document_tree import TitleTable
from torsionnet.report.plan import Revision, TitleBlock
from torsionnet.report.report_data import ReportData

REVISION_HEADS = ("Revision", "Date", "Description", "Prepared", "Checked", "Approved")
"""Headings of the table of revisions."""
SIGNATURE_HEADS = ("", "Name", "Date", "Signature")
"""Headings of the table that is signed by hand."""
TITLE_FACTS = ("Model", "Author", "Date", "Calculated with", "Model file", "SHA-256")
"""Words of the facts that the title block holds, which the list of facts below it leaves out."""


def title_table(subject: ReportData, version: str) -> TitleTable | None:
    """Title block of a report with all its fields, blank ones too; None for the report on a rig unless it is given.

    ``version`` is that of the program.
    """
    plan = subject.request.plan
    if plan.title_block is None and plan.kind != "approval":
        return None
    block = plan.title_block or TitleBlock()
    hull = ("Hull", block.hull) if block.hull else ("Plant", block.plant) if block.plant else ("Hull or plant", "")
    date = subject.request.date.isoformat() if subject.request.date else ""
    file = subject.file or "described in Python"
    return TitleTable(
        rows=(
            (("Project", block.project), ("Document number", block.document_number)),
            (hull, ("Revision", block.revision)),
            (("Owner", block.owner), ("Date", date)),
            (("Yard", block.yard), ("Class society", block.class_society)),
            (("Rules", block.rules), ("Edition", block.edition)),
            (("Engine", block.engine), ("Rating", block.rating)),
            (("Model", subject.model.name), ("Calculated with", f"torsionnet {version}")),
            (("Model file", f"{file}, SHA-256 {subject.digest}"),),
        ),
        revision_heads=REVISION_HEADS,
        revisions=tuple(map(_revision, block.revisions or (Revision(),))),
        signature_heads=SIGNATURE_HEADS,
        signatures=(
            ("Prepared", block.prepared or plan.author),
            ("Checked", block.checked),
            ("Approved", block.approved),
        ),
    )


def _revision(one: Revision) -> tuple[str, ...]:
    return (one.revision, one.date, one.description, one.prepared, one.checked, one.approved)
