"""Commands on a drivetrain under torques: ``static`` at rest, ``simulate`` over time, and ``periodic``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import TABLE, Answer, ConfiguredCase, ModelCommand, result_path, separated_by_lines
from torsionnet.app.cli.options import ANGLE, EntryOption, PairOption, argument, file_option, option
from torsionnet.app.cli.terminal import message
from torsionnet.base.errors import UsageError
from torsionnet.base.packages import imported

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.machinery.mean.static_state import StaticState
    from torsionnet.motion.contact_states import MotionStart
    from torsionnet.motion.periodic.periodic_result import PeriodicResponse
    from torsionnet.signals.recording import Recording


# Commands on a drivetrain under torques: ``static`` at rest and ``simulate`` over time.

# Command ``torsionnet static``, which prints mean torque, twist, stress and power of every element.


class StaticCommand(ModelCommand):
    """Mean torque, twist, shear stress and power of every element under the load of the model.

    The model says in its entry load: who drives and who absorbs, or gives torques in its operating point. Without
    --speed it is examined at the speed of the operating point, else at the rated speed.

    \b
    torsionnet static plant.yaml -c all
    torsionnet static plant.yaml --speed "500 rpm" --csv static.csv
    """

    forms = TABLE

    speed: float | None = option(
        "--speed",
        type=EntryOption("SPEED", "machinery.excitations.speed_range:SPEED"),
        help='Another speed of the node of the entry speeds:, as "500 rpm".',
    )
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions

        conventions = Conventions(angle=self.angle)
        cases, states = self._loaded_states()
        return Answer(
            screen=lambda: separated_by_lines(state.table(conventions) for state in states),
            data=lambda: states,
            csv=lambda: [("", self.combined_table(cases, [state.table(conventions) for state in states]))],
        )

    def _loaded_states(self) -> tuple[list[ConfiguredCase], list[StaticState]]:
        """Drivetrains for which the load determines mean torques, and their mean torques, twists and powers.

        Notes name the cases left out.
        """
        from torsionnet.model.load.external_torques import CutOffError

        asked = self.cases()
        cases: list[ConfiguredCase] = []
        states: list[StaticState] = []
        for case in asked:
            try:
                states.append(case.drivetrain.static_state(self.speed))
                cases.append(case)
            except CutOffError as error:
                if len(asked) == 1:
                    raise
                message("note", f"left out {case.configuration}: {error}")
        if not states:
            raise CutOffError(
                "the load determines no mean torques in any of these configurations, for the reasons above; "
                "name with -c one in which the shafts of the load turn together",
                kind="no-ratio",
            )
        return cases, states


# Command ``torsionnet simulate``, which moves a model over time by one of its scenarios.


class SimulateCommand(ModelCommand):
    """Motion over time under a scenario of the model: peaks, events and energies.

    A scenario stands in the entry scenarios: of the model, as torques over time or a short circuit. Outputs are the
    sensors of the model unless others are named. Linear drivetrains move exactly; laws of motion, as of clearances and
    friction, act in full.

    \b
    torsionnet simulate turbine_generator_ssr two_phases --plot fault.png
    torsionnet simulate plant.yaml tip_in -c V --output "torque(shaft)" -o tip_in.npz
    """

    forms = TABLE
    picture = "the signals over time with events"

    scenario: str = argument("SCENARIO")
    outputs: tuple[str, ...] = option(
        "--output",
        metavar="NAME",
        help='Sensor or node, or "torque(coupling)". Repeatable.  [default: the sensors of the model]',
    )
    rate: float | None = option(
        "--sampling-rate",
        type=EntryOption("RATE", "motion.scenarios.scenario:RATE"),
        help='Samples a second instead of those of the scenario, as "20 kHz".',
    )
    check: bool = option(
        "--check", help="Repeat the motion in steps half as long, and say until when both agree: contacts are chaotic."
    )
    output_file: str | None = file_option("Write the record; the ending tells the format, as .npz, .csv or .mat.")
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions
        from torsionnet.motion.motion_record import SimulatedMotion, peak_table
        from torsionnet.signals.formats.registry import format_of
        from torsionnet.signals.records.recording_files import write_recording

        # An ending that no format has is refused before anything is simulated.
        if self.output_file:
            format_of(Path(self.output_file), "recording")
        cases = self.cases()
        records = self.each("simulating", cases, self._run)
        pairs = list(zip(cases, records, strict=True))
        conventions = Conventions(angle=self.angle)
        return Answer(
            screen=lambda: separated_by_lines(self._tables(pairs)),
            data=lambda: [SimulatedMotion(case.configuration, self.scenario, record) for case, record in pairs],
            csv=lambda: [
                (
                    "",
                    self.combined_table(
                        cases, [peak_table(record_of_case, self._title(record_of_case)) for record_of_case in records]
                    ),
                )
            ],
            files=[
                (result_path(self.output_file, case.configuration, len(pairs)), partial(write_recording, record))
                for case, record in pairs
                if self.output_file
            ],
            figures=lambda _: [
                (case.configuration, draw(record, conventions=conventions, title=self._title(record)))
                for draw in (imported("torsionnet.plot.histories:scenario_motion"),)
                for case, record in pairs
            ],
        )

    def _run(self, case: ConfiguredCase) -> Recording:
        outputs = self.outputs or None
        return case.drivetrain.simulate(outputs, sampling_rate=self.rate, scenario=self.scenario, check=self.check)

    def _title(self, record: Recording) -> str:
        return f"{record.title}: {self.scenario}"

    def _tables(self, pairs: list[tuple[ConfiguredCase, Recording]]) -> Iterator[Table]:
        from torsionnet.motion.motion_record import motion_tables

        for case, record in pairs:
            words = case.drivetrain.definition.scenarios[self.scenario].words
            yield from motion_tables(record, self._title(record), words)


# Command ``torsionnet periodic``, which finds the periodic motions of a drivetrain whose laws are not linear.


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
