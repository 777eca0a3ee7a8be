# Written by `make generate`.
from torsionnet.io.fmu import write_fmu as write_fmu
from torsionnet.io.mass_elastic_files import mass_elastic_report as mass_elastic_report
from torsionnet.io.mass_elastic_files import read_mass_elastic as read_mass_elastic
from torsionnet.io.mass_elastic_files import write_mass_elastic as write_mass_elastic
from torsionnet.io.matlab import to_matlab as to_matlab
from torsionnet.io.matlab import write_matlab as write_matlab
from torsionnet.io.modelica import to_modelica as to_modelica
from torsionnet.io.modelica import write_modelica as write_modelica
from torsionnet.io.tors_reading import read_tors as read_tors
from torsionnet.io.tors_writing import write_tors as write_tors
from torsionnet.io.tracked_order_tables import read_tracked_orders as read_tracked_orders
from torsionnet.io.tracked_order_tables import write_tracked_orders as write_tracked_orders
from torsionnet.io.wheel_files import read_wheel_pattern as read_wheel_pattern
from torsionnet.io.wheel_files import write_wheel_pattern as write_wheel_pattern
from torsionnet.model.catalogues.catalogue_reading import read_catalogue as read_catalogue
from torsionnet.signals.records.recording_files import iter_blocks as iter_blocks
from torsionnet.signals.records.recording_files import read_recording as read_recording
from torsionnet.signals.records.recording_files import write_recording as write_recording
from torsionnet.signals.response_files import read_frequency_response as read_frequency_response
from torsionnet.signals.response_files import write_frequency_response as write_frequency_response

__all__ = [
    "iter_blocks",
    "mass_elastic_report",
    "read_catalogue",
    "read_frequency_response",
    "read_mass_elastic",
    "read_recording",
    "read_tors",
    "read_tracked_orders",
    "read_wheel_pattern",
    "to_matlab",
    "to_modelica",
    "write_fmu",
    "write_frequency_response",
    "write_mass_elastic",
    "write_matlab",
    "write_modelica",
    "write_recording",
    "write_tors",
    "write_tracked_orders",
    "write_wheel_pattern",
]
