"""Command ``torsionnet identify-modes``, which finds modes in a record without a model."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import TABLE, Answer, separated_by_lines
from torsionnet.app.cli.options import WrongUsage, option
from torsionnet.app.cli.record_options import EstimateArguments
from torsionnet.app.cli.terminal import print_warnings

if TYPE_CHECKING:
    from torsionnet.linear.frequency_response import FrequencyResponse
    from torsionnet.modal.matching import Match
    from torsionnet.modal.modal_estimate import ModalEstimate

METHODS = ("auto", "rational", "lscf", "peaks")


class IdentifyModesCommand(EstimateArguments):
    """Natural frequencies, damping ratios and shapes at the sensors from a record, without a model.

    Against a measured torque these are the poles of the drivetrain cut at the transducer; --model compares them with
    those of a model in the same way.

    \b
    torsionnet identify-modes test.npz --output theta_1 --input T_T --preset paper --model amt_rig -c V
    """

    forms = TABLE
    picture = "the stabilisation diagram"

    method: str = option(
        "--method",
        type=click.Choice(METHODS),
        default="auto",
        show_default=True,
        help="rational: few modes of any damping, also close ones; lscf: many light modes; auto: the better of these.",
    )
    model_order: int | None = option("--model-order", type=click.IntRange(1), help="Highest order of the fit.")
    model: str | None = option("--model", metavar="MODEL", help="Compare with the modes of this model.")
    configuration: str = option("--configuration", "-c", metavar="NAME", default="", help="Of that model.")

    def answer(self) -> Answer:
        from torsionnet.app.cli.commands.estimate import estimate_record

        if self.output.plot_file and self.method == "peaks":
            raise WrongUsage(
                "peak picking has no stabilisation diagram; leave --plot out, or choose another --method",
                kind="needless-entry",
            )
        response = estimate_record(
            self.record,
            self.reading,
            self.outputs,
            self.inputs,
            self.averaging,
            self.estimator,
            self.band,
            align=False,
        )
        if self.band is None and response.usable_up_to is not None:
            response = response.between(0, response.usable_up_to)
        found, diagram = _identified(response, self.method, self.model_order)
        compared = _compared(found, self.model, self.configuration, self.inputs) if self.model else None
        print_warnings(found.notes)
        return Answer(
            screen=lambda: separated_by_lines([found.table(), *([compared.table()] if compared else [])]),
            data=lambda: replace(found, against_model=compared),
            csv=lambda: [("", found.table())],
            figures=lambda plot: [("", plot.stabilisation(diagram, found))],
        )


def _identified(response: FrequencyResponse, method: Any, order: int | None) -> tuple[ModalEstimate, Any]:
    from torsionnet.modal import Settings, identify_modes, peak_picking, stabilisation

    if method == "peaks":
        return peak_picking(response), None
    chosen = Settings(method, order, weights=_weights(response))
    diagram = stabilisation(response, chosen)
    return identify_modes(diagram), diagram


def _weights(response: FrequencyResponse) -> Any:
    return "coherence" if response.coherence is not None else "uniform"


def _compared(found: ModalEstimate, model: str, configuration: str, inputs: tuple[str, ...]) -> Match:
    from torsionnet.loading import load
    from torsionnet.modal import match

    rig = load(model)
    rig = rig.configured(configuration) if configuration else rig
    measured = [name for name in inputs if name in rig.sensors]
    return match(found, rig.modes(measured_input=measured) if measured else rig.modes())
