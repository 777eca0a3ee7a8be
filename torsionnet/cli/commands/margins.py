"""``torsionnet margins``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from torsionnet.cli.cases import ConfiguredCase, ModelCommand
from torsionnet.cli.command import TABLE, Answer, click_command, separated_by_lines
from torsionnet.cli.declarations import option

if TYPE_CHECKING:
    from torsionnet.response.loop_margins import LoopMargins, Margin


class MarginsCommand(ModelCommand):
    """Stability margins of the loop opened at a controller: gain, phase, delay, and the distance from -1.

    All other loops are closed. --plot draws Nyquist's plot.
    """

    forms = TABLE
    picture = "Nyquist's plot"

    at: str | None = option("--at", metavar="NAME", help="The controller.  [default: the only one]")

    def answer(self) -> Answer:
        cases = self.cases()
        found = [case.drivetrain.loop_margins(self.at) for case in cases]
        tables = [one.table() for one in found]
        pairs = list(zip(cases, found, strict=True))
        return Answer(
            screen=lambda: separated_by_lines(tables),
            data=lambda: [_as_data(*pair) for pair in pairs],
            csv=lambda: [("", self.combined_table(cases, tables))],
            figures=lambda plot: [(case.configuration, plot.nyquist(one)) for case, one in pairs],
        )


def _as_data(case: ConfiguredCase, found: LoopMargins) -> dict[str, Any]:
    return {
        "title": found.title,
        "configuration": case.configuration,
        "controller": found.controller,
        "stable": found.stable,
        "gain_increase": _margin(found.gain_increase),
        "gain_decrease": _margin(found.gain_decrease),
        "phase_deg": _margin(found.phase),
        "delay_s": _margin(found.delay),
        "modulus": _margin(found.modulus),
    }


def _margin(one: Margin) -> dict[str, float]:
    return {"value": one.value, "frequency_Hz": one.frequency}


command = click_command("margins", MarginsCommand)
