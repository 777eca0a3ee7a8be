"""The latest frequency response of a set of rows, kept for conditions that change excitations and nothing else."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsionnet.assembly.action_law import ActionLaw
from torsionnet.assembly.assembled import AssembledModel
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import Law
from torsionnet.response.frequency_response import FloatArray, FrequencyResponse
from torsionnet.solve.dynamic_stiffness.transfer_request import stressed_sections
from torsionnet.solve.responses.transfer import frequency_response


@dataclass
class LatestResponse:
    """What was asked last of these rows, and the answer; only one, for an answer may be large."""

    laws: tuple[Law | ActionLaw, ...] = ()
    asked: Any = None
    frequencies: FloatArray | None = None
    found: FrequencyResponse | None = None


def shared_response(
    drivetrain: AssembledModel,
    outputs: str | Sensor | Sequence[str | Sensor],
    inputs: Sequence[Any],
    frequencies: FloatArray,
) -> FrequencyResponse:
    """As :func:`frequency_response`, but the same question on the same numbers is answered once.

    A misfire changes torques, not the drivetrain: eight firing conditions need one solution.
    """
    latest = drivetrain.assembly.system.memo.once(LatestResponse, None, LatestResponse)
    asked = (outputs, inputs, stressed_sections(drivetrain, (outputs,)))
    laws: tuple[Law | ActionLaw, ...] = (*drivetrain.assembly.laws, *drivetrain.assembly.system.actions)
    if latest.found is not None and latest.frequencies is not None:
        alike = latest.asked == asked and np.array_equal(latest.frequencies, frequencies)
        if alike and latest.laws == laws:
            return latest.found
    found = frequency_response(drivetrain, outputs, inputs, frequencies)
    latest.laws, latest.asked = laws, asked
    latest.frequencies, latest.found = frequencies, found
    return found
