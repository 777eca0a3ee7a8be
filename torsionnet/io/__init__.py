"""Files of other programs, of records and of responses. Each function reads or writes whole files, or returns text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.core.lazy import names_on_demand

_HOMES = {
    "from_tors": "torsionnet.io.tors_reading",
    "iter_blocks": "torsionnet.io.recording_files",
    "mass_elastic_report": "torsionnet.io.mass_elastic_reading",
    "read_catalogue": "torsionnet.model.catalogues.catalogue_reading",
    "read_frequency_response": "torsionnet.io.response_files",
    "read_mass_elastic": "torsionnet.io.mass_elastic_reading",
    "read_recording": "torsionnet.io.recording_files",
    "read_tors": "torsionnet.io.tors_reading",
    "to_mass_elastic": "torsionnet.io.mass_elastic_writing",
    "to_matlab": "torsionnet.io.matlab",
    "to_modelica": "torsionnet.io.modelica",
    "to_tors": "torsionnet.io.tors_writing",
    "write_fmu": "torsionnet.io.fmu",
    "write_frequency_response": "torsionnet.io.response_files",
    "write_mass_elastic": "torsionnet.io.mass_elastic_writing",
    "write_matlab": "torsionnet.io.matlab",
    "write_modelica": "torsionnet.io.modelica",
    "write_recording": "torsionnet.io.recording_files",
    "write_tors": "torsionnet.io.tors_writing",
}

__all__ = [*_HOMES]  # noqa: PLE0604
__getattr__ = names_on_demand(__name__, _HOMES)

if TYPE_CHECKING:
    from torsionnet.io.fmu import write_fmu as write_fmu
    from torsionnet.io.mass_elastic_reading import mass_elastic_report as mass_elastic_report
    from torsionnet.io.mass_elastic_reading import read_mass_elastic as read_mass_elastic
    from torsionnet.io.mass_elastic_writing import to_mass_elastic as to_mass_elastic
    from torsionnet.io.mass_elastic_writing import write_mass_elastic as write_mass_elastic
    from torsionnet.io.matlab import to_matlab as to_matlab
    from torsionnet.io.matlab import write_matlab as write_matlab
    from torsionnet.io.modelica import to_modelica as to_modelica
    from torsionnet.io.modelica import write_modelica as write_modelica
    from torsionnet.io.recording_files import iter_blocks as iter_blocks
    from torsionnet.io.recording_files import read_recording as read_recording
    from torsionnet.io.recording_files import write_recording as write_recording
    from torsionnet.io.response_files import read_frequency_response as read_frequency_response
    from torsionnet.io.response_files import write_frequency_response as write_frequency_response
    from torsionnet.io.tors_reading import from_tors as from_tors
    from torsionnet.io.tors_reading import read_tors as read_tors
    from torsionnet.io.tors_writing import to_tors as to_tors
    from torsionnet.io.tors_writing import write_tors as write_tors
    from torsionnet.model.catalogues.catalogue_reading import read_catalogue as read_catalogue
