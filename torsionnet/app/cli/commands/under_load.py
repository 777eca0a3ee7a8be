"""Commands on a drivetrain under torques: ``static`` at rest and ``simulate`` over time."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from torsionnet.app.cli.command import TABLE, Answer, ConfiguredCase, ModelCommand, result_path, separated_by_lines
from torsionnet.app.cli.options import ANGLE, EntryOption, argument, file_option, option
from torsionnet.app.cli.terminal import message
from torsionnet.base.packages import imported

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.machinery.mean.static_state import StaticState
    from torsionnet.signals.recording import Recording


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
        from torsionnet.motion.motion_summary import SimulatedMotion, peak_table
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
        from torsionnet.motion.motion_summary import motion_tables

        for case, record in pairs:
            words = case.drivetrain.definition.scenarios[self.scenario].words
            yield from motion_tables(record, self._title(record), words)
