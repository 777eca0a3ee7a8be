"""Files of other programs, recordings and frequency responses.

Each function reads or writes whole files, or returns text.
"""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "iter_blocks": "torsionnet.signals.records.recording_files",
        "mass_elastic_report": "torsionnet.io.mass_elastic_files",
        "read_catalogue": "torsionnet.model.catalogues.catalogue_reading",
        "read_frequency_response": "torsionnet.signals.response_files",
        "read_mass_elastic": "torsionnet.io.mass_elastic_files",
        "read_recording": "torsionnet.signals.records.recording_files",
        "read_tors": "torsionnet.io.tors_reading",
        "read_wheel_pattern": "torsionnet.io.wheel_files",
        "read_tracked_orders": "torsionnet.io.tracked_order_tables",
        "to_matlab": "torsionnet.io.matlab",
        "to_modelica": "torsionnet.io.modelica",
        "write_fmu": "torsionnet.io.fmu",
        "write_frequency_response": "torsionnet.signals.response_files",
        "write_mass_elastic": "torsionnet.io.mass_elastic_files",
        "write_matlab": "torsionnet.io.matlab",
        "write_modelica": "torsionnet.io.modelica",
        "write_recording": "torsionnet.signals.records.recording_files",
        "write_tors": "torsionnet.io.tors_writing",
        "write_wheel_pattern": "torsionnet.io.wheel_files",
        "write_tracked_orders": "torsionnet.io.tracked_order_tables",
    },
)
