"""An element type is one file: what is dropped into the folder of elements, or registered, is known everywhere."""

import os
import random
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.made_up_elements import MadeUpInerter
from support.patience import PATIENCE

import torsionnet as tn
from torsionnet.model import elements
from torsionnet.model.elements import ELEMENT_TYPES, register
from torsionnet.model.files.model_schema import schema_text

ROOT = Path(__file__).parents[2]

FILE = '''
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.element_entries import NodePair
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.expressions import Expression
from torsionnet.model.element_base.laws import Law, difference


@register
@dataclass(frozen=True, eq=False, repr=False)
class AnInerter(Element):
    """Two nodes that resist their relative acceleration.

    >>> AnInerter("flywheel", nodes=("a", "b"), inertance=3).kind
    'an_inerter'
    """

    kind: ClassVar[str] = "an_inerter"
    glyph: ClassVar[str] = "damper"

    nodes: tuple[str, str] = entry(NodePair("the two nodes it connects"))
    inertance: Expression = entry(PhysicalQuantity("inertance", "inertia", "b"))

    def own_parts(self, value):
        return (Law(difference(*self.nodes), inertia=value(self.inertance)),)
'''

PROGRAM = '''
import math, pathlib, sys
import torsionnet as tn
from torsionnet import *

assert "AnInerter" in tn.__all__ and "AnInerter" in dir(tn) and AnInerter is tn.AnInerter

rig = tn.loads("""
torsionnet: 1
parameters: {b: 3 kg*m^2}
elements:
  one: {type: inertia, node: a, inertia: 1}
  made: {type: an_inerter, nodes: [a, c], inertance: b}
  two: {type: inertia, node: c, inertia: 2}
inputs: {T: {torque: a}}
sensors: {angle: {angle: a}, through: {torque: made}}
""")
value = rig.frequency_response("angle", "T", [1.0]).values.item()
expected = -1 / (1 + 1 / (1 / 3 + 1 / 2)) / (2 * math.pi) ** 2
assert abs(value / expected - 1) < 1e-12
assert {fault.severity for fault in rig.check()} == {"note"}
assert str(rig.symbolic().M[0]) == "b + 1"

from torsionnet.model.files.model_schema import json_schema
assert json_schema()["$defs"]["element_an_inerter"]["properties"]["inertance"]

sys.path.append(sys.argv[1])
import generate, stubs, symbol_picture
assert "## an_inerter" in generate.elements_page()
import reference_pages
assert "(reference/torsionnet.AnInerter.md)" in reference_pages.reference_index()
assert "    inertance: Scalar," in stubs.element_types_stub().partition("class AnInerter(_AnInerter):")[2]
assert " AnInerter as AnInerter" in stubs.package_stub("torsionnet")
symbol_picture.write(pathlib.Path(), "an_inerter", [generate.sample(tn.AnInerter, full=True)])
assert pathlib.Path("symbol_an_inerter.svg").stat().st_size

from torsionnet.io import to_modelica
from torsionnet.io.tors_writing import to_tors
assert "Inertia made_inertia(J=b*4);" in to_modelica(rig)
try:
    to_tors(rig)
except tn.UsageError as refusal:
    assert "made (an_inerter), inertia on a - c" in str(refusal)
else:
    raise AssertionError

from torsionnet.io.fmu.traced_matrices import trace_system
assert len(list(trace_system(rig).matrices["M"])) == 4

assert "made" in [text.get_text() for text in tn.plot.schematic(rig).axes[0].texts]
'''


@pytest.fixture
def registered():
    """The register as it was, afterwards."""
    before = dict(ELEMENT_TYPES)
    yield ELEMENT_TYPES
    ELEMENT_TYPES.clear()
    ELEMENT_TYPES.update(before)


def test_schema_does_not_depend_on_the_order_of_registration(registered):
    expected, classes = schema_text(), list(registered.values())
    for seed in range(3):
        registered.clear()
        for cls in random.Random(seed).sample(classes, len(classes)):
            register(cls)
        assert schema_text() == expected


@pytest.mark.usefixtures("registered")
def test_what_a_program_registers_is_offered_by_name():
    assert "MadeUpInerter" not in tn.__all__
    with pytest.raises(AttributeError, match="has no attribute 'MadeUpInerter'"):
        tn.MadeUpInerter  # noqa: B018
    made = register(type("MadeUpInerter", (MadeUpInerter,), {"kind": "an_inerter", "__doc__": "An inerter."}))
    assert tn.MadeUpInerter is elements.MadeUpInerter is made
    assert "MadeUpInerter" in tn.__all__
    assert '"element_an_inerter"' in schema_text()


def test_every_element_type_is_public():
    assert {cls.__name__ for cls in ELEMENT_TYPES.values()} < set(tn.__all__) == set(dir(tn))
    assert all(getattr(tn, cls.__name__) is cls for cls in ELEMENT_TYPES.values())


@pytest.mark.slow
def test_a_file_in_the_folder_of_elements_is_all_a_new_type_needs(tmp_path):
    shutil.copytree(ROOT / "torsionnet", tmp_path / "torsionnet")
    shutil.copytree(ROOT / "library", tmp_path / "library")
    (tmp_path / "torsionnet" / "model" / "elements" / "an_inerter.py").write_text(FILE, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(ROOT / "docs")],
        env=os.environ | {"PYTHONPATH": str(tmp_path), "MPLBACKEND": "Agg"},
        cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
