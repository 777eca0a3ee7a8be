"""Quantities of studies against what the public methods say of every variant alone, and against closed forms."""

import itertools
import math
import threading
import warnings
from collections import Counter

import numpy as np
import pytest
from support.patience import PATIENCE
from support.study_blocks import (
    amt_rig,
    columns,
    dmf_rig,
    held_ship,
    misfiring_ship,
    ship_at_three_speeds,
    singly,
    spread,
    together,
    turbine_generator,
)

import torsionnet as tn
from torsionnet.base.equal_remarks import collected_warnings
from torsionnet.base.errors import ModelError, TorsionnetWarning
from torsionnet.study.quantities.peak import band_grid, largest
from torsionnet.study.quantities.quantity import QUANTITIES, VariantBlock


@pytest.fixture
def model(request: pytest.FixtureRequest) -> tn.Drivetrain:
    """Made when a test asks for it: to read models takes much of collecting."""
    return request.param()


def made(kind: str, **entries: object) -> object:
    return QUANTITIES[kind](**entries)


def one_mass(**parameters: float) -> tn.Drivetrain:
    elements = [
        tn.Inertia("mass", node="a", inertia="J"),
        tn.Spring("shaft", nodes=("a", "ground"), stiffness="k", damping="c"),
    ]
    return tn.Drivetrain("one mass", elements, parameters={"J": 2.0, "k": 8e4, "c": 40.0, **parameters})


def block_of(model: tn.Drivetrain, **values: list[float]) -> VariantBlock:
    return singly(model, {name: np.array(column, dtype=float) for name, column in values.items()})


PARTS = {
    "magnitude": np.abs,
    "phase": np.angle,
    "real": np.real,
    "imaginary": np.imag,
    "dB": lambda values: 20 * np.log10(np.abs(values)),
}


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("input", ["T_M", "T_T"])
def test_a_response_is_that_of_every_variant(part: str, input: str) -> None:
    values = spread(amt_rig(), ("k_1", "c_O"))
    quantity = made("response", output="theta_1", input=input, band="1..40 Hz", points=30, part=part)
    found = quantity.evaluate(singly(amt_rig(), values))
    f = np.geomspace(1, 40, 30)
    for row, own in zip(found, columns(values), strict=True):
        H = amt_rig().configured(**own).frequency_response("theta_1", input, f)
        assert row == pytest.approx(PARTS[part](H.values[:, 0, 0]), rel=1e-9)
    measure = quantity.measure(amt_rig())
    assert measure.over == "frequency"
    assert measure.points.tolist() == f.tolist()
    assert measure.unit == {"phase": "rad", "dB": "dB"}.get(part, "rad/(N*m)")


def test_a_variant_that_cannot_be_has_no_values_and_says_why() -> None:
    block = block_of(dmf_rig(), k_2=[400.0, -5.0])
    found = made("response", output="theta_1", input="T_T", at=5).evaluate(block)
    assert np.isfinite(found[0]).all()
    assert np.isnan(found[1]).all()
    ((text, count),) = block.remarks.items()
    assert count == 1
    assert "k_2" in text or "stiffness" in text


@pytest.mark.parametrize("zeta", [0.5, 0.1, 1e-2, 1e-3, 1e-4, 1e-5])
def test_a_peak_of_one_mass_is_that_of_the_closed_form(zeta: float) -> None:
    damping = 2 * zeta * math.sqrt(2 * 8e4)
    block = block_of(one_mass(), c=[damping, 1.1 * damping])
    shape = {"output": "a", "input": "a", "band": "1..200 Hz"}
    height, place = (made(kind, **shape).evaluate(block)[:, 0] for kind in ("peak", "peak_frequency"))
    for number, own in enumerate((zeta, 1.1 * zeta)):
        assert height[number] * 8e4 * 2 * own * math.sqrt(1 - own**2) == pytest.approx(1, rel=1e-9)
        assert place[number] == pytest.approx(100 / math.pi * math.sqrt(1 - 2 * own**2), rel=1e-7)


def test_a_peak_without_damping_is_infinite() -> None:
    assert (
        made("peak", output="a", input="a", band="1..200 Hz").evaluate(block_of(one_mass(), c=[0.0]))[0, 0] == math.inf
    )


def test_the_highest_of_two_peaks_is_found_though_the_grid_shows_the_other_higher() -> None:
    wide, narrow = 10.0, 20.0 * 1.005 * math.sqrt(1.01)

    def magnitude(f: np.ndarray) -> np.ndarray:
        parts = [amount / (1 - (f / own) ** 2 + 2j * zeta * f / own)
                 for own, zeta, amount in ((wide, 0.02, 1.0), (narrow, 1e-4, 0.1))]  # fmt: skip
        return np.atleast_2d(abs(sum(parts)))

    found = largest(magnitude, band_grid(1, 100))
    fine = np.linspace(narrow * (1 - 1e-3), narrow * (1 + 1e-3), 400_001)
    assert found.magnitude[0] == pytest.approx(magnitude(fine).max(), rel=1e-6)


@pytest.mark.parametrize(("count", "height", "zeta", "share"), [(20, 2.5, 5e-3, 0.5), (12, 17.5, 1e-3, 0.375)])
def test_a_narrow_peak_is_found_among_many_that_look_higher(
    count: int, height: float, zeta: float, share: float
) -> None:
    low, high = band_grid(1, 100)[21:23]
    own = low ** (1 - share) * high**share
    broad = [(place, 0.02, 0.04 * height) for place in np.geomspace(2, 90, count)]

    def magnitude(f: np.ndarray) -> np.ndarray:
        parts = [
            amount / (1 - (f / place) ** 2 + 2j * damping * f / place)
            for place, damping, amount in (*broad, (own, zeta, 2 * zeta * 1.15 * height))
        ]
        return np.atleast_2d(np.sqrt(sum(abs(part) ** 2 for part in parts)))

    found = largest(magnitude, band_grid(1, 100))
    assert found.frequency[0] == pytest.approx(own, rel=1e-4)
    assert found.magnitude[0] == pytest.approx(magnitude(np.linspace(own * 0.999, own * 1.001, 20_001)).max(), rel=1e-6)


def test_what_a_quantity_says_of_impossible_variants_does_not_count() -> None:
    block = together(dmf_rig(), {"k_2": np.array([400.0, -5.0])}, one=Ones())
    assert np.isnan(block.of("one")).tolist() == [[False], [True]]


class Ones:
    """1 of every variant."""

    def evaluate(self, block: VariantBlock) -> np.ndarray:
        return np.ones((len(block), 1))


def test_a_band_without_a_peak_has_its_largest_value_at_an_end() -> None:
    block = block_of(one_mass(), c=[40.0])
    shape = {"output": "a", "input": "a", "band": "100..200 Hz"}
    assert made("peak_frequency", **shape).evaluate(block)[0, 0] == 100
    expected = abs(1 / (8e4 - 2 * (200 * math.pi) ** 2 + 40j * 200 * math.pi))
    assert made("peak", **shape).evaluate(block)[0, 0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("mean", "of"), [("rms", lambda sizes: math.sqrt(np.mean(sizes**2))), ("arithmetic", np.mean)])
def test_the_mean_of_a_band_is_that_of_its_points(mean: str, of: object) -> None:
    values = spread(amt_rig(), ("k_1",), count=3)
    quantity = made("band_mean", output="theta_1", input="T_M", band="1..40 Hz", points=50, mean=mean)
    found = quantity.evaluate(singly(amt_rig(), values))[:, 0]
    for value, own in zip(found, columns(values), strict=True):
        H = amt_rig().configured(**own).frequency_response("theta_1", "T_M", np.linspace(1, 40, 50))
        assert value == pytest.approx(of(H.magnitude[:, 0, 0]), rel=1e-9)


FAULTS = [
    (dmf_rig, ("response", {"output": "theta_2", "input": "T_N", "at": 5}), {"output", "input"}),
    (dmf_rig, ("response", {"output": "theta_1", "input": "T_T", "at": 5, "excitation": "x"}), {"input"}),
    (dmf_rig, ("natural_frequency", {"mode": 5}), {"mode"}),
    (dmf_rig, ("natural_frequency", {"mode": 3, "which": "undamped"}), {"mode"}),
    (dmf_rig, ("damping_ratio", {"mode": 3}), {"mode"}),
    (dmf_rig, ("peak", {"output": "torque(dmv)", "input": "T_M", "band": "1..40 Hz"}), {"output"}),
]


@pytest.mark.parametrize(("model", "asked", "paths"), FAULTS, indirect=["model"])
def test_what_a_model_lacks_is_said_with_its_place(
    model: tn.Drivetrain, asked: tuple[str, dict[str, object]], paths: set[str]
) -> None:
    faults = list(made(asked[0], **asked[1]).model_faults(model, {}))
    assert {fault.path[0] for fault in faults} == paths
    assert all(fault.message for fault in faults)


@pytest.mark.parametrize(
    ("kind", "entries"),
    [
        ("response", {"output": "a", "input": "b"}),
        ("response", {"output": "a", "input": "b", "at": 5, "band": "1..2 Hz"}),
        ("response", {"output": "a", "input": "b", "at": 5, "points": 5}),
        ("response", {"output": "a", "input": "b", "band": "0..5 Hz", "spacing": "log"}),
        ("response", {"output": "a", "input": "b", "at": [5, 4]}),
        ("natural_frequency", {"mode": 1, "which": "undamped", "order": "tracked"}),
        ("natural_frequency", {"mode": 0}),
    ],
)
def test_entries_that_contradict_each_other_are_refused(kind: str, entries: dict[str, object]) -> None:
    with pytest.raises(ModelError):
        made(kind, **entries)


def test_what_fits_has_no_faults_and_is_written_back_as_it_was_read() -> None:
    for kind, entries in (
        ("response", {"output": "theta_1", "input": "T_T", "at": ["5 Hz", "6 Hz"], "part": "phase"}),
        ("response", {"output": "theta_1", "input": "T_T", "band": "1.0..40.0 Hz", "points": 7}),
        ("natural_frequency", {"mode": 2, "which": "undamped"}),
        ("peak", {"output": "theta_1", "input": "T_M", "band": "1..40 Hz"}),
    ):
        quantity, faults = QUANTITIES[kind].read(entries)
        assert not faults
        assert not list(quantity.model_faults(dmf_rig(), {}))
        again, _ = QUANTITIES[kind].read(quantity.to_data())
        assert again == quantity


def test_warnings_of_variants_are_counted_and_not_shown() -> None:
    found = Counter()
    with warnings.catch_warnings(record=True) as shown:
        warnings.simplefilter("always")
        with collected_warnings(found):
            for _ in range(2):
                warnings.warn("kept", TorsionnetWarning, stacklevel=1)
            warnings.warn("another's", DeprecationWarning, stacklevel=1)
        warnings.warn("afterwards", TorsionnetWarning, stacklevel=1)
    assert found == {"kept": 2}
    assert [str(one.message) for one in shown] == ["another's", "afterwards"]


def test_threads_collect_their_own_warnings() -> None:
    found = [Counter() for _ in range(4)]
    ready = threading.Barrier(4)

    def warn(number: int) -> None:
        with collected_warnings(found[number]):
            ready.wait(PATIENCE)
            for _ in range(50):
                warnings.warn(f"of {number}", TorsionnetWarning, stacklevel=1)
            ready.wait(PATIENCE)

    threads = [threading.Thread(target=warn, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [{f"of {number}": 50} for number in range(4)]


ASKED = [
    (
        amt_rig,
        ("k_1", "c_O", "I_1"),
        "response",
        {"output": "theta_1", "input": "T_T", "band": "1..40 Hz", "points": 30},
    ),
    (amt_rig, ("k_1", "c_O", "I_1"), "response", {"output": "T_T", "input": "T_M", "at": "0 Hz"}),
    (amt_rig, ("k_1", "c_O"), "peak", {"output": "theta_1", "input": "T_T", "band": "1..40 Hz"}),
    (amt_rig, ("k_1", "c_O"), "peak_frequency", {"output": "theta_1", "input": "T_M", "band": "1..40 Hz"}),
    (dmf_rig, ("k_1", "k_2", "I_1"), "peak", {"output": "theta_1", "input": "T_M", "band": "1..200 Hz"}),
    (dmf_rig, ("k_2",), "band_mean", {"output": "theta_1", "input": "T_M", "band": "1..40 Hz", "points": 50}),
    (ship_at_three_speeds, ("k_cpl", "psi_cpl"), "peak", {"output": "T_cpl", "input": "T_prop", "band": "2..60 Hz"}),
    (ship_at_three_speeds, ("k_cpl", "psi_cpl", "water"), "order_torque", {"output": "T_cpl"}),
    (
        ship_at_three_speeds,
        ("k_cpl", "c_dmp"),
        "order_torque",
        {"output": "stress(int_shaft)", "order": 3, "curve": True},
    ),
    (ship_at_three_speeds, ("k_cpl",), "order_torque", {"output": "T_crank", "size": "rms", "speeds": "500..800 rpm"}),
    (misfiring_ship, ("k_cpl",), "order_torque", {"output": "T_cpl", "excitations": ["engine"]}),
    (held_ship, ("k_cpl", "c_dmp"), "critical_speed_margin", {"orders": [3.0], "speeds": "600..650 rpm"}),
    (ship_at_three_speeds, ("k_cpl", "c_dmp"), "utilisation", {"limit": "tail"}),
    (amt_rig, ("k_1", "c_O"), "natural_frequency", {"mode": 1}),
    (ship_at_three_speeds, ("k_cpl", "water"), "natural_frequency", {"mode": 2, "which": "undamped"}),
    (ship_at_three_speeds, ("k_cpl", "water"), "damping_ratio", {"mode": 1, "order": "ascending"}),
    (dmf_rig, ("k_1", "k_2"), "transient_peak", {"output": "T_T", "input": "T_M", "torque": 10, "duration": 0.05}),
    (
        turbine_generator,
        ("K_4", "H_G"),
        "scenario_peak",
        {"scenario": "two_phases", "output": "T_LPB_G", "rate": "1 kHz"},
    ),
    (dmf_rig, ("k_1", "k_2"), "expression", {"of": "sqrt(static)/2"}),
]
OTHERS = {"static": made("response", output="theta_1", input="T_T", at=0)}


def test_every_kind_of_quantity_is_among_them() -> None:
    assert {kind for _, _, kind, _ in ASKED} == set(QUANTITIES)


@pytest.mark.few(2, 9)
@pytest.mark.parametrize(("model", "names", "kind", "entries"), ASKED, indirect=["model"])
def test_variants_solved_together_have_the_values_they_have_alone(
    model: tn.Drivetrain, names: tuple[str, ...], kind: str, entries: dict[str, object]
) -> None:
    values = spread(model, names, count=4)
    quantity = made(kind, **entries)
    assert not list(quantity.model_faults(model, OTHERS))
    found, alone = (quantity.evaluate(block(model, values, **OTHERS)) for block in (together, singly))
    assert found.shape == (4, len(quantity.measure(model).points))
    assert np.isfinite(found).all()
    rel = 1e-6 if kind == "peak_frequency" else 1e-9
    assert found == pytest.approx(alone, rel=rel, abs=1e-9 * np.abs(alone).max())


@pytest.mark.few(1, 9)
@pytest.mark.parametrize(("model", "names", "kind", "entries"), ASKED, indirect=["model"])
def test_values_do_not_depend_on_who_is_solved_along(
    model: tn.Drivetrain, names: tuple[str, ...], kind: str, entries: dict[str, object]
) -> None:
    values = spread(model, names, count=7)
    quantity = made(kind, **entries)
    whole = quantity.evaluate(together(model, values, **OTHERS))
    for cuts in ([0, 3, 7], [0, 1, 2, 3, 4, 5, 6, 7]):
        parts = [
            quantity.evaluate(together(model, {name: column[low:high] for name, column in values.items()}, **OTHERS))
            for low, high in itertools.pairwise(cuts)
        ]
        assert np.array_equal(np.concatenate(parts), whole)
