"""Command ``torsionnet periodic``, which finds the periodic motions of a drivetrain whose laws are not linear."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import TABLE, Answer, ConfiguredCase, ModelCommand, separated_by_lines
from torsionnet.app.cli.options import ANGLE, PairOption, option
from torsionnet.base.errors import UsageError

if TYPE_CHECKING:
    from torsionnet.motion.contact_states import MotionStart
    from torsionnet.motion.periodic.periodic_result import PeriodicResponse


class PeriodicCommand(ModelCommand):
    """Every periodic motion of a model whose laws are not linear, which of them are stable, and where a sweep jumps.

    Over the speeds of the model under its excitations; or over --frequencies under torques, each with its mean and the
    amplitudes of its harmonics. Springs in stages, clearances and friction act in full.

    \b
    torsionnet periodic car.yaml --output "twist(dmf)" --subharmonics 2 --plot car.png
    torsionnet periodic rig.yaml --output "twist(dmf)" --frequencies 4:24:0.5 --torque T_M=40,60
    """

    forms = TABLE
    picture = "the peak to peak over frequency or speed, unstable parts dashed"

    outputs: tuple[str, ...] = option(
        "--output", metavar="NAME", required=True, help='Sensor or node, or "twist(dmf)". Repeatable.'
    )
    listed: str | None = option(
        "--frequencies", metavar="LIST", help='Hz, as "4:24:0.5" (start:stop:step) or "9,10,11", with --torque.'
    )
    torques: tuple[tuple[str, str], ...] = option(
        "--torque",
        type=PairOption("INPUT", "MEAN,AMPLITUDE", "T_M=40,60"),
        help="Torque in N m over frequency: mean and amplitudes of harmonics 1, 2, ... Repeatable.",
    )
    excitations: tuple[str, ...] = option(
        "--excitation", metavar="NAME", help="Over speed only this one acts. Repeatable.  [default: all of the model]"
    )
    harmonics: int | None = option(
        "--harmonics",
        type=click.IntRange(1, 600),
        help="Harmonics taken; 1 is the method of describing functions.  [default: as many as are needed]",
    )
    subharmonics: str = option(
        "--subharmonics",
        type=click.Choice(["1", "2", "4", "8"]),
        default="1",
        show_default=True,
        help="Most periods of the torques after which motions that are followed repeat.",
    )
    states: tuple[str, ...] = option(
        "--initial-state",
        metavar="STATE",
        help='Also simulate, from "rest", from the "operating_point", or from "NODE=ANGLE,SPEED" in rad and rad/s '
        "(repeatable), for motions that no other start leads to.",
    )
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions

        conventions = Conventions(angle=self.angle)
        over = self._driven()
        cases = self.cases()
        responses = self.each("periodic", cases, lambda case: self._run(case, over))
        return Answer(
            screen=lambda: separated_by_lines(response.table(conventions) for response in responses),
            data=lambda: [case.data(response) for case, response in zip(cases, responses, strict=True)],
            csv=lambda: [("", self.combined_table(cases, [response.table(conventions) for response in responses]))],
            figures=lambda plot: [
                (case.configuration, plot.periodic_response(response, conventions=conventions))
                for case, response in zip(cases, responses, strict=True)
            ],
        )

    def _driven(self) -> dict[str, Any]:
        """Arguments of the periodic response that say what drives it."""
        from torsionnet.app.cli.frf_output import read_list

        if self.listed is None:
            if self.torques:
                raise UsageError("--torque goes with --frequencies", kind="missing-entry")
            return {"excitation": list(self.excitations) or None}
        if self.excitations:
            text = "--excitation names excitations over speed; over --frequencies give --torque"
            raise UsageError(text, kind="contradicting-entries")
        if not self.torques:
            raise UsageError("over --frequencies --torque says what drives, as T_M=40,60", kind="missing-entry")
        torques = {name: _harmonics(name, text) for name, text in self.torques}
        return {"frequencies": read_list(self.listed), "excitation": torques}

    def _run(self, case: ConfiguredCase, over: dict[str, Any]) -> PeriodicResponse:
        response: PeriodicResponse = case.drivetrain.periodic_response(
            list(self.outputs),
            harmonics=self.harmonics or "auto",
            subharmonics=int(self.subharmonics),
            initial_state=_initial_state(self.states),
            **over,
        )
        return response


def _harmonics(name: str, text: str) -> dict[int, complex]:
    """Amplitudes in N m by harmonic from "mean,first,second".

    >>> _harmonics("T_M", "40, 60")
    {0: 40.0, 1: 60.0}
    """
    try:
        return dict(enumerate(float(part) for part in text.split(",")))
    except ValueError:
        what = f'{name}: a torque is written as its mean and amplitudes in N m, "40,60", got "{text}"'
        raise UsageError(what, kind="wrong-form") from None


def _initial_state(states: Sequence[str]) -> str | MotionStart | None:
    """State in which simulations begin: a word, or angles and speeds from "NODE=ANGLE,SPEED"; None without one.

    >>> _initial_state(["a=0.1,0", "b=0,-2"])
    MotionStart(angles={'a': 0.1, 'b': 0.0}, speeds={'a': 0.0, 'b': -2.0})
    """
    from torsionnet.motion.contact_states import MotionStart

    if len(states) <= 1 and not any("=" in state for state in states):
        return states[0] if states else None
    angles: dict[str, float] = {}
    speeds: dict[str, float] = {}
    for state in states:
        node, _, text = state.partition("=")
        try:
            angles[node], speeds[node] = map(float, text.split(","))
        except ValueError:
            what = f'a state is "rest", "operating_point", or "NODE=ANGLE,SPEED" in rad and rad/s, got "{state}"'
            raise UsageError(what, kind="wrong-form") from None
    return MotionStart(angles, speeds)
