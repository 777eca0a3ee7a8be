"""Reading and writing of model files, with every fault located; their JSON Schema and the library.

>>> from torsionnet.model.files.reader import read_file
>>> definition, faults = read_file("amt_rig")
>>> list(definition.parameters)[:2], [fault.severity for fault in faults if fault.severity == "error"]
(['I_MT', 'I_1'], [])
"""
