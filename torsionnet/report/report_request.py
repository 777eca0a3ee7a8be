"""Request for a report, from the plan in the model's file and the options of the call that replace it."""

from __future__ import annotations

import datetime as dt
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from torsionnet.base.errors import UsageError
from torsionnet.model.channels import Pair
from torsionnet.report.plan.report_plan import SECTIONS, ReportPlan

if TYPE_CHECKING:
    from torsionnet.identification import Fit
    from torsionnet.linear.frequency_response import FrequencyResponse
    from torsionnet.report.measured_orders import MeasuredFile
    from torsionnet.signals.torque_loops.loop_result import TorqueLoops
    from torsionnet.study.study_result import StudyResult


@dataclass(frozen=True, eq=False)
class Measured:
    """Measured response and the configuration it was measured in; an empty name is the one of the report.

    Attributes
    ----------
    response : FrequencyResponse
        Its output and input have their names of the model.
    configuration : str
    excitation : str, optional
        What drives the model, if it has several inputs.
    """

    response: FrequencyResponse
    configuration: str = ""
    excitation: str | None = None


@dataclass(frozen=True, eq=False)
class ReportRequest:
    """Plan, settings, date, tests, fits and studies of a report.

    Attributes
    ----------
    plan : ReportPlan
        Of the model's file, with what was said against it.
    settings : tuple of (str, str)
        Parameters changed for this report.
    date : dt.date, optional
        None: without a date.
    tests : tuple of Measured
    fits : tuple of Fit
    studies : tuple of StudyResult
    measured : tuple of MeasuredFile
        Files with orders measured on board, for the measurement plan.
    loops : tuple of TorqueLoops
    """

    plan: ReportPlan = field(default_factory=ReportPlan)
    settings: tuple[tuple[str, str], ...] = ()
    date: dt.date | None = None
    tests: tuple[Measured, ...] = ()
    fits: tuple[Fit, ...] = ()
    studies: tuple[StudyResult, ...] = ()
    measured: tuple[MeasuredFile, ...] = ()
    loops: tuple[TorqueLoops, ...] = ()

    def wants(self, section: str) -> bool:
        """Whether the report has a section of this name."""
        chosen = self.plan.sections
        if_given = {
            "test": bool(self.tests),
            "loops": bool(self.loops),
            "fit": bool(self.fits),
            "study": bool(self.studies),
            "simplified": self.plan.simplify is not None or "simplified" in chosen,
        }
        needed = section == "measurement_plan" and bool(self.measured)
        by_kind = self.is_of_kind(section) or self.plan.appendix or needed
        return if_given.get(section, section in chosen if chosen else by_kind)

    def is_of_kind(self, section: str) -> bool:
        """Whether a section belongs to the kind of document that the report is."""
        return (self.plan.kind or "rig") in SECTIONS[section].kinds

    @property
    def pairs(self) -> tuple[Pair, ...]:
        return self.plan.transfer_functions


def read_date(raw: str | dt.date | None) -> dt.date | None:
    """Date of a report from a text such as ``2025-03-31``; None for ``none``.

    Raises
    ------
    UsageError
        No such date.

    Examples
    --------
    >>> read_date("2025-03-31"), read_date("none")
    (datetime.date(2025, 3, 31), None)
    """
    if raw is None or isinstance(raw, dt.date):
        return raw
    if raw.strip().lower() in ("none", ""):
        return None
    try:
        return dt.date.fromisoformat(raw.strip())
    except ValueError:
        raise UsageError(
            f'a date is written 2025-03-31 (year-month-day), or none; got "{raw}"', kind="wrong-form"
        ) from None
