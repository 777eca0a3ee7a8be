"""Files of other programs, of records and of responses. Each function reads or writes whole files, or returns text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.core.lazy import names_on_demand

_HOMES = {
    "from_tors": "torsionnet.io.tors_reading",
    "iter_blocks": "torsionnet.io.records",
    "read_frequency_response": "torsionnet.io.responses.response_files",
    "read_recording": "torsionnet.io.records",
    "read_tors": "torsionnet.io.tors_reading",
    "to_matlab": "torsionnet.io.matlab",
    "to_modelica": "torsionnet.io.modelica",
    "to_tors": "torsionnet.io.tors_writing",
    "write_fmu": "torsionnet.io.fmu",
    "write_frequency_response": "torsionnet.io.responses.response_files",
    "write_matlab": "torsionnet.io.matlab",
    "write_modelica": "torsionnet.io.modelica",
    "write_recording": "torsionnet.io.records",
    "write_tors": "torsionnet.io.tors_writing",
}

__all__ = [
    "from_tors",
    "iter_blocks",
    "read_frequency_response",
    "read_recording",
    "read_tors",
    "to_matlab",
    "to_modelica",
    "to_tors",
    "write_fmu",
    "write_frequency_response",
    "write_matlab",
    "write_modelica",
    "write_recording",
    "write_tors",
]
__getattr__ = names_on_demand(__name__, _HOMES)

if TYPE_CHECKING:
    from torsionnet.io.fmu import write_fmu
    from torsionnet.io.matlab import to_matlab, write_matlab
    from torsionnet.io.modelica import to_modelica, write_modelica
    from torsionnet.io.records import iter_blocks, read_recording, write_recording
    from torsionnet.io.responses.response_files import read_frequency_response, write_frequency_response
    from torsionnet.io.tors_reading import from_tors, read_tors
    from torsionnet.io.tors_writing import to_tors, write_tors
