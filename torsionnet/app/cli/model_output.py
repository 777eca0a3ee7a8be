"""Model as ``torsionnet show --json`` prints it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from torsionnet.app.cli.equation_output import EquationsOfMotion, MatricesRecord, equations_of_motion, matrices_record
from torsionnet.base.result_rows import Out
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.overview import ModelRecord, model_record


@dataclass(frozen=True)
class ShownModel(ModelRecord):
    """Model with its values, and its equations of motion and matrices where these are asked for."""

    equations: Annotated[EquationsOfMotion | None, Out(optional=True)]
    matrices: Annotated[MatricesRecord | None, Out(optional=True)]


def shown_model(rig: Drivetrain, *, equations: bool, matrices: bool) -> ShownModel:
    """Model of one configuration as plain data, for JSON."""
    return ShownModel(
        **vars(model_record(rig)),
        equations=equations_of_motion(rig) if equations else None,
        matrices=matrices_record(rig) if matrices else None,
    )
