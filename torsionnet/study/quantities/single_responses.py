"""The response of one variant, by a method that does not depend on how much is asked."""

from __future__ import annotations

from typing import Any

import numpy as np

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.solve.dynamic_stiffness.transfer_request import remembered
from torsionnet.solve.responses.transfer import responses, warn_infinite

GRAPH = "graph"
"""The method of responses, unless another is asked for."""


def single_response(
    model: AssembledModel, outputs: Any, inputs: Any, frequencies: FloatArray, excitation: str | None = None
) -> ComplexArray:
    """Transfer functions (n_f, n_out, n_in) at frequencies >= 0 in Hz."""
    request = remembered(model, outputs, inputs, excitation)
    found = responses([model], request, frequencies, GRAPH)
    warn_infinite(found.values, found.conditioning, frequencies)
    return np.asarray(found.values[0])
