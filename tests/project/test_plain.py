"""Random plants of components and parts against equations written down from what is documented of each component."""

import pytest

pytest.importorskip("flint", reason="exact values need python-flint")

from plain.campaign import run
from support import campaigns

from torsionnet.model.elements import ELEMENT_TYPES

IN_ANOTHER_CAMPAIGN = {"damper", "planetary", "differential", "rigid_coupling", "lock", "shaft", "tabulated_spring"}
"""Drawn by ``oracle``; a sheet, matrices and arc springs have tests of their own."""
LAWS_OF_MOTION = {"clearance", "friction"}
"""Without equations of a linear plant; drawn by the random plants of ``test_operating_point_of_laws`` and ``test_random_motion``."""


@pytest.mark.slow
def test_some():
    assert run(f"short-{i}" for i in range(8)).wrong == []


@pytest.mark.slow
@pytest.mark.parametrize("block", range(campaigns.examples(1, 4)))
def test_many(block):
    findings = run(f"long-{block}-{i}" for i in range(campaigns.examples(20, 100)))
    assert findings.wrong == []
    assert (
        set(ELEMENT_TYPES) - {"arc_spring", "lumped_matrices", "mass_elastic"} - IN_ANOTHER_CAMPAIGN - LAWS_OF_MOTION
        <= findings.drawn.keys()
    )
    assert min(findings.compared.values()) > 0
