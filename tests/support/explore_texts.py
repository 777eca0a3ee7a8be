"""Texts that the explore page opens, and a page that is asked without a network."""

import json

from torsionnet.app.explore import open_documents
from torsionnet.app.explore.api import reply

RIG = """torsionnet: 1
name: rig
parameters: {k: 400 N*m/rad}
elements:
  motor: {type: inertia, node: motor, inertia: 0.08 kg*m^2}
  shaft: {type: spring, nodes: [motor, brake], stiffness: k}
  brake: {type: inertia, node: brake, inertia: 0.32 kg*m^2}
configurations: {soft: {k: 100 N*m/rad}, stiff: {k: 1600 N*m/rad}}
"""


class Page:
    """A page of a file, asked without a network."""

    def __init__(self, documents):
        self.documents = documents

    @classmethod
    def of(cls, path):
        """That of a model file."""
        return cls(open_documents(path)[0])

    def ask(self, path, tab="tab", **entries):
        return json.loads(reply(self.documents, f"api/{path}", json.dumps({"document": tab, **entries}).encode()))

    def type(self, text, revision=1, tab="tab"):
        return self.ask("text", tab, text=text, revision=revision)


ENGINE, VEHICLE, RATIO = 0.15, 24.0, 4.0
CRANK, WHEEL, MOWER = (f"operating_point.torque.{node}" for node in ("crank", "wheel", "mower"))
LINE = """torsionnet: 1
name: line
parameters:
  J: 0.15 kg*m^2  # of the engine
elements:
  engine: {type: inertia, node: crank, inertia: J}
  dmf: {type: spring, nodes: [crank, box], stages: [{stiffness: 450, to: 0.1 rad}, {stiffness: 1800}]}
  set: {type: gear, nodes: [box, wheel], ratio: 4}
  vehicle: {type: inertia, node: wheel, inertia: 24 kg*m^2}
operating_point: {torque: {crank: 20 N*m, wheel: -80 N*m}}  # at idle
"""
GEARS = """configurations:
  low: {operating_point: {torque: {crank: 100 N*m, wheel: -400 N*m}}}
"""
