"""Messages on values with another unit or sign than their entry wants, and on changes of nested entries."""

import numpy as np
import pytest
from support.faults import raised_faults

import torsionnet as tn
from torsionnet.base.entries.spec import EntryError
from torsionnet.machinery.excitations.harmonic_torque import PropellerCondition
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


@pytest.mark.parametrize("frequency", ["0 Hz", "f_0"])
def test_a_spring_that_cannot_be_calculated_is_told_beside_engines_on_other_shafts(frequency):
    """The ratio between the shafts needs the laws of the spring, of which the fault stands at its entry."""
    car = library_models()["front_wheel_drive_car"]
    text = car.read_text(encoding="utf-8").replace("{zeta: 0.02, at: 300 Hz}", f"{{zeta: 0.02, at: {frequency}}}", 1)
    text = text.replace("parameters:", "parameters:\n  f_0: 0 Hz", 1)
    line, column = next((n, row.index(frequency)) for n, row in enumerate(text.splitlines()) if "zeta: 0.02" in row)
    faults = raised_faults(lambda: tn.loads(text, folder=car.parent))
    assert [(one.kind, one.position.line, one.position.column) for one in faults] == [
        ("out-of-range", line + 1, column + 1)
    ]
