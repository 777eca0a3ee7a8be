"""Messages on values with another unit or sign than their entry wants, and on changes of nested entries."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.entries.spec import EntryError
from torsionnet.machinery.excitations.propeller_torque import PropellerCondition
from torsionnet.machinery.excitations.table_by_pressure import interpolated, mean_pressure
from torsionnet.model.files.library import library_models


def test_the_torque_of_a_condition_is_a_share():
    with pytest.raises(tn.ModelError, match=r"torque: .*11\.2.*78.*wrong-form"):
        PropellerCondition(torque="78.9 kN*m", blade_orders={1: {"share": "10 %"}})
    assert PropellerCondition(torque="11.2 %", blade_orders={1: {"share": "10 %"}}).torque == pytest.approx(0.112)
    with pytest.raises(tn.ModelError, match=r"torque: .*out-of-range"):
        PropellerCondition(torque="-1 %", blade_orders={1: {"share": "10 %"}})


def test_a_negative_mean_indicated_pressure_has_its_unit():
    """Losses of a motored trace; the unit is there, so that nothing is said of it."""
    with pytest.raises(EntryError, match=r"(?s)-0\.04.*out-of-range"):
        mean_pressure("-0.04 bar")
    with pytest.raises(EntryError, match=r"(?s)27.*missing-unit"):
        mean_pressure("low")
    assert mean_pressure("19 bar") == pytest.approx(19e5)


def test_a_table_that_ends_names_the_pressure_farthest_beyond_it():
    """19.09 bar at the first speed beyond the table of 19 bar, 19.9 bar at the last one: one correction is enough."""
    with pytest.raises(tn.UsageError, match=r"(?s)19\.9.*19.*beyond-table"):
        interpolated([0.0, 19e5], np.zeros((2, 1), complex), np.array([18e5, 19.2e5, 19.9e5]))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            "engine.gas.motored: [1]",
            r":67:34: .*fixed-entry",
        ),
        ("engine.gaz.motored: [1]", r':67:34: .*did you mean "gas".*unknown-name'),
        ("crank.value: 1 kN*m", r":67:34: .*fixed-entry"),
    ],
)
def test_what_a_configuration_cannot_change_is_named(tmp_path, change, words):
    text = library_models()["bulk_carrier"].read_text(encoding="utf-8").replace("engine.misfire: [2]", change)
    (tmp_path / "ship.yaml").write_text(text)
    with pytest.raises(tn.ModelError, match=words):
        tn.load(tmp_path / "ship.yaml")
