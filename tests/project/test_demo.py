"""The demo: numbers beside the paper's, and the files it promises."""

import contextlib
import csv
import io
import re

import figures
import identification
import pytest
import rigs
import run_all

from torsionnet.bench import load_bench

FIGURES = [
    "fig_02_time_histories.png",
    "fig_03_spectrogram_torque.png",
    "fig_04_spectrogram_angle.png",
    "fig_05_dmf_estimate.png",
    "fig_06_amt_estimates.png",
    "fig_07_amt_coherence.png",
    "fig_11_dmf_test_and_model.png",
    "fig_12_amt_II_test_and_model.png",
    "fit_amt.png",
    "fit_dmf.png",
]
SLUGS = ["dmf", "amt_II", "amt_III", "amt_IV", "amt_V", "amt_V_c_O_360"]


def printed(main, folder):
    """(what it printed, its folder)."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        main(folder)
    return text.getvalue(), folder


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    """The whole demo, for the night; by day .ci/run makes it, and tests look at its parts."""
    folder = tmp_path_factory.mktemp("demo") / "out"
    return printed(lambda folder: run_all.main([str(folder)]), folder)


@pytest.fixture(scope="module")
def models(tmp_path_factory):
    """What it says of the models, without tests of them."""
    return printed(rigs.show, tmp_path_factory.mktemp("models"))


def row(text, case, quantity):
    """Cells of a row of the comparison: model, test, deviation."""
    line = next(line for line in text.splitlines() if re.match(rf"{re.escape(case)}  +{quantity}  ", line))
    return re.split(r"  +", line)[3:]


@pytest.mark.nightly
def test_writes_the_figures_schematics_and_curves(shown):
    text, folder = shown
    names = {path.name for path in folder.iterdir()}
    assert names == {
        "dmf_theta1_TM_and_TT.png",
        "amt_gears.png",
        "dmf_schematic.svg",
        "amt_schematic.svg",
        "amt_report.html",
        "dmf_report.html",
        *(f"{slug}_theta_1_{against}.csv" for slug in SLUGS for against in ("T_T", "T_M")),
        *FIGURES,
    }
    assert all(str(folder / name) in text for name in names)
    for name in ("dmf_theta1_TM_and_TT.png", "amt_gears.png", *FIGURES):
        data = (folder / name).read_bytes()
        assert data.startswith(b"\x89PNG")
        assert len(data) > 20_000
    assert "<svg" in (folder / "dmf_schematic.svg").read_text(encoding="utf-8")


def test_prints_modes_of_every_gear(models):
    text, _ = models
    for title in ("DMF test rig", *(f"AMT test rig ({gear})" for gear in ("II", "III", "IV", "V", "V_c_O_360"))):
        assert f"{title}\nmode " in text
    for frequency in ("7.10526", "80.9834", "3.4091", "4.56396", "5.34326", "5.912", "6.2678"):
        assert re.search(rf"^ +1 +{re.escape(frequency)} |^ +2 +{re.escape(frequency)} ", text, flags=re.MULTILINE)


@pytest.mark.parametrize(
    ("case", "quantity", "cells"),
    [  # model as in the project's own table of the paper's equations; test as the paper says
        ("DMF", "peak frequency", ("8.116", "8", "+1.5 %")),
        ("DMF", "peak phase", ("-72.6", "-64", "-8.6 deg")),
        ("DMF", "DC gain", ("0.1289", "-")),
        ("AMT II", "peak frequency", ("3.691", "4", "-7.7 %")),
        ("AMT II", "damping ratio", ("0.229278", "0.22", "+4.2 %")),
        ("AMT II", "DC gain", ("0.4197", "0.44", "-4.6 %")),
        ("AMT III", "damping ratio", ("0.224239", "0.22", "+1.9 %")),
        ("AMT IV", "damping ratio", ("0.221185", "0.22", "+0.5 %")),
        ("AMT V", "peak frequency", ("6.747", "7", "-3.6 %")),
        ("AMT V", "DC gain", ("0.1741", "0.16", "+8.8 %")),
        ("AMT V, c_O = 360", "peak frequency", ("6.979", "7", "-0.3 %")),
        ("AMT V, c_O = 360", "damping ratio", ("0.276870", "0.27", "+2.5 %")),
    ],
)
def test_compares_with_the_paper(models, case, quantity, cells):
    model, *rest = row(models[0], case, quantity)
    assert float(model) == pytest.approx(float(cells[0]), rel=2e-4, abs=6 * 10 ** -len(cells[0].split(".")[-1]) / 10)
    assert tuple(rest) == cells[1:]


def test_every_figure_of_the_paper_is_compared(models):
    for case, quantity in rigs.PAPER:
        assert row(models[0], case, quantity)[1] != "-"


@pytest.mark.parametrize(
    ("case", "frequency", "damping"),
    [
        ("DMF", 8.755, 0.257),
        ("AMT II", 3.945, 0.245),
        ("AMT III", 5.396, 0.250),
        ("AMT IV", 6.430, 0.251),
        ("AMT V", 7.199, 0.248),
        ("AMT V, c_O = 360", 7.809, 0.308),
    ],
)
def test_shows_the_poles_of_the_cut_rigs(models, case, frequency, damping):
    table = models[0].split("cut at the torque meter")[1]
    cells = re.split(r"  +", next(line for line in table.splitlines() if line.startswith(f"{case}  ")))
    assert [float(cell) for cell in cells[1:3]] == pytest.approx([frequency, damping], abs=6e-4)


def test_says_where_the_test_differs(models):
    text = " ".join(models[0].split())
    assert "Where the test differs from the model, and why" in text
    assert "losses that do not depend on frequency" in text


def test_curves_are_in_degrees_over_the_papers_range(models):
    lines = (models[1] / "amt_II_theta_1_T_T.csv").read_text(encoding="utf-8").splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    frequencies = [float(entry["frequency [Hz]"]) for entry in rows]
    assert (frequencies[0], frequencies[-1]) == pytest.approx((0.3, 40))
    assert max(float(entry["|theta_1/T_T| [deg/(N*m)]"]) for entry in rows) == pytest.approx(0.8661, abs=1e-3)


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("case", "limit", "peak"),
    [("DMF", 10.5, 8.0), ("AMT II", 8.2, 3.7), ("AMT III", 8.9, 5.0), ("AMT IV", 9.6, 6.0), ("AMT V", 10.0, 6.7)],
)
def test_virtual_bench_agrees_with_the_model_where_the_encoder_resolves_it(shown, case, limit, peak):
    text, _ = shown
    lines = text[text.index("Virtual bench against model") :].splitlines()
    line = next(line for line in lines if re.match(rf"{case}  +\d[\d.]+  +\d[\d.]*  +\d", line))
    usable, found, decibels, degrees = map(float, re.split(r"  +", line)[1:])
    assert usable == pytest.approx(limit, abs=0.3)
    assert found == pytest.approx(peak, abs=0.5)
    assert decibels < 0.6
    assert degrees < 6


@pytest.mark.nightly
def test_identification_finds_the_true_values(shown):
    text, _ = shown
    for name, true in (("c_2", 4), ("c_O", 170), ("c_B", 1.5)):
        line = next(line for line in text.splitlines() if re.match(rf" *{name}  +\d.* (yes|no)$", line))
        assert float(line.split()[1]) == pytest.approx(true, rel=0.01)
    assert "c_O and c_B cannot be told apart in II alone" in text


def test_models_bring_their_schematics_and_curves(models):
    text, folder = models
    names = {path.name for path in folder.iterdir()}
    assert names >= {"dmf_theta1_TM_and_TT.png", "amt_gears.png", "dmf_schematic.svg", "amt_schematic.svg"}
    assert names >= {f"{slug}_theta_1_{against}.csv" for slug in SLUGS for against in ("T_T", "T_M")}
    assert all(str(folder / name) in text for name in names)


@pytest.mark.slow
def test_one_test_agrees_with_its_model():
    """The flywheel's alone: usable up to, peak, decibels, degrees."""
    done = figures.run(load_bench("dmf_bench"), "DMF")
    (cells,) = figures.agreements([done]).rows
    assert cells[1:3] == (pytest.approx(10.5, abs=0.3), pytest.approx(8.0, abs=0.5))
    assert cells[3] < 0.6
    assert abs(cells[4]) < 6


@pytest.mark.slow
def test_drag_of_the_flywheel_is_found():
    fit = identification.flywheel()
    assert fit.values["c_2"] == pytest.approx(4, rel=0.01)
