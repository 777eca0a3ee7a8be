"""Entries of what is checked in the records of a campaign, and from which share on a record is left out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault


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
            return [Fault(f"a check needs leave_out or fail: {self.form}", on_key=True)]
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
