"""``torsionnet critical-speeds``."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import click

from torsionnet.cli.cases import ConfiguredCase, ModelCommand
from torsionnet.cli.command import TABLE, Answer, click_command, separated_by_lines
from torsionnet.cli.declarations import option

if TYPE_CHECKING:
    from types import ModuleType

    from matplotlib.figure import Figure

    from torsionnet.response.critical_speeds import CriticalSpeed, CriticalSpeeds
    from torsionnet.response.table import Table

STATES = ("as_modelled", "free", "locked", "half")


class CriticalSpeedsCommand(ModelCommand):
    """Critical speeds, at which orders meet natural frequencies, their margin to the operating range, and excitation.

    The model says what runs and at which speeds in its entries excitations: and speeds:. With several configurations
    a crossing that one of them does not excite says which others do.

    \b
    torsionnet critical-speeds plant.yaml --margin api684 --plot campbell.png
    torsionnet critical-speeds plant.yaml -c normal -c misfire --output "torque(crank)"
    torsionnet critical-speeds plant.yaml --stars 1 --plot stars.png
    """

    forms = TABLE
    picture = "the interference (Campbell) diagram, or star diagrams"

    outputs: tuple[str, ...] = option(
        "--output", metavar="NAME", help="Also the speed at which orders of this are largest. Repeatable."
    )
    excitations: tuple[str, ...] = option(
        "--excitation", metavar="NAME", help="Only this one counts. Repeatable.  [default: all of the model]"
    )
    margin: str | None = option(
        "--margin", metavar="RULE", help="api610, api617, api618, api684, line_frequency, or a share as 15%."
    )
    reach: float = option(
        "--reach", default=0.25, show_default=True, help="How far outside the operating range, as a share of speed."
    )
    lowest: int | None = option("--lowest", type=click.IntRange(min=1), metavar="N", help="Only the N lowest modes.")
    line_frequency: float | None = option("--line-frequency", metavar="HZ", help="Also once and twice this frequency.")
    dampers: str = option(
        "--dampers", type=click.Choice(STATES), default=STATES[0], show_default=True, help="Rings of viscous dampers."
    )
    damper_names: tuple[str, ...] = option(
        "--damper", metavar="NAME", help="A damper, or a film.  [default: every viscous_damper]"
    )
    stars: int | None = option("--stars", type=click.IntRange(min=1), metavar="MODE", help="--plot draws these.")

    def answer(self) -> Answer:
        cases = self.cases()
        each = [self._run(case) for case in cases]
        found = [one.in_conditions([other for other in each if other is not one]) for one in each]
        pairs = list(zip(cases, found, strict=True))
        return Answer(
            screen=lambda: separated_by_lines(part for one in found for part in _shown(one)),
            data=lambda: [_as_data(*pair) for pair in pairs],
            csv=lambda: [("", self.combined_table(cases, [one.table() for one in found]))],
            figures=lambda plot: [(case.configuration, self._picture(plot, one)) for case, one in pairs],
        )

    def _run(self, case: ConfiguredCase) -> CriticalSpeeds:
        return case.drivetrain.critical_speeds(
            list(self.outputs),
            excitations=self.excitations or None,
            margin=self.margin,
            reach=self.reach,
            lowest=self.lowest,
            line_frequency=self.line_frequency,
            dampers=self.dampers,
            damper_names=self.damper_names or None,
        )

    def _picture(self, plot: ModuleType, found: CriticalSpeeds) -> Figure:
        if self.stars is None:
            return plot.interference_diagram(found)  # type: ignore[no-any-return]
        found.mode(self.stars)
        stars = [one.star for one in found.crossings if one.mode.number == self.stars and one.star is not None]
        several = [star for star in stars if len(star.vectors) > 1]
        return plot.star_diagrams(several or stars)  # type: ignore[no-any-return]


def _shown(found: CriticalSpeeds) -> Iterator[Table]:
    yield found.mode_table()
    yield found.table()


def _as_data(case: ConfiguredCase, found: CriticalSpeeds) -> dict[str, Any]:
    rule = found.rule
    return {
        "title": found.title,
        "configuration": case.configuration,
        "speed_of": found.reference,
        "speed_range_rad_per_s": list(found.speed_range),
        "margin_rule": None if rule is None else str(rule),
        "modes": [
            {
                "mode": mode.number,
                "undamped_natural_frequency_Hz": mode.undamped_frequency,
                "natural_frequency_Hz": mode.natural_frequency,
                "damped_frequency_Hz": mode.damped_frequency,
                "damping_ratio": mode.damping_ratio,
                "amplification": mode.amplification,
                "similarity": mode.similarity,
                "shape": {node: [value.real, value.imag] for node, value in found.shape(mode.number).items()},
            }
            for mode in found.modes
        ],
        "crossings": [_crossing(one) for one in found.crossings],
    }


def _crossing(one: CriticalSpeed) -> dict[str, Any]:
    star = one.star
    return {
        "mode": one.mode.number,
        "excitation": one.excitation,
        "order": one.order,
        "fixed_Hz": one.fixed,
        "of_reference": one.order * float(one.ratio),
        "undamped_rad_per_s": one.speed("undamped"),
        "natural_rad_per_s": one.speed("natural"),
        "damped_rad_per_s": one.speed("damped"),
        "margin": one.margin,
        "required": one.required,
        "generalised_force_Nm": one.generalised_force,
        "relative_force": one.relative_force,
        "excited": one.excited,
        "excited_in": list(one.excited_in),
        "peaks": [{"output": peak.output, "rad_per_s": peak.speed, "amplitude": peak.amplitude} for peak in one.peaks],
        "star": []
        if star is None
        else [
            {"label": label, "node": node, "vector": [vector.real, vector.imag]}
            for label, node, vector in zip(star.labels, star.nodes, star.vectors.tolist(), strict=True)
        ],
    }


command = click_command("critical-speeds", CriticalSpeedsCommand)
