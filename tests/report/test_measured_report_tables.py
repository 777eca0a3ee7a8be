"""Tables of a report on measured orders and half ranges, against two masses on a spring by hand, and in German."""

import re

import numpy as np
import pytest
from support.measured_pump import PLANT, torque, tracked
from support.report_blocks import blocks, of, rows

import torsionnet as tn
from torsionnet.io.tracked_order_tables import write_tracked_orders
from torsionnet.report import make_report
from torsionnet.report.document_tree import TableBlock
from torsionnet.report.writers.markdown import MarkdownWriter

SPEEDS = np.arange(310.0, 890.0, 5.0)
FACTOR = 0.9
LIMIT = 60.0
MODEL = PLANT.replace("value: 100", f"value: {LIMIT:g}") + "report: {measure: [T], kind: approval}\n"


def report_on(values, folder, language="en"):
    write_tracked_orders([tracked_slowly(values)], folder / "tracked.csv")
    sections = ["limits", "measurement_plan"]
    file = f"T={folder / 'tracked.csv'}"
    return make_report(tn.loads(MODEL), sections=sections, measured=[file], date=None, language=language)


def tracked_slowly(values):
    """Tracked orders and half ranges at steady points, minutes apart."""
    found = tracked(SPEEDS, values)
    return type(found)(**{**vars(found), "times": found.times * 1000})


def columns(report, words):
    """Columns of the table with these words in its caption, by heading, as texts."""
    (found,) = [one for one in of(TableBlock, blocks(report, "measurement_plan")) if words in str(one.caption)]
    return dict(zip([str(one.text) for one in found.columns], zip(*rows(found), strict=True), strict=True))


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    return report_on(FACTOR * torque(SPEEDS), tmp_path_factory.mktemp("report"))


def test_half_ranges_beside_limits(report):
    found = columns(report, "Measured half ranges beside limits")
    largest = np.abs(torque(SPEEDS)).max()
    for name, true in (
        ("Measured", FACTOR * largest), ("Calculated", largest), ("Deviation", 100 * (FACTOR - 1)),
        ("Utilisation", 100 * FACTOR * largest / LIMIT),
    ):  # fmt: skip
        assert float(found[name][0]) == pytest.approx(true, rel=2e-3), name
    assert found["Verdict"] == ("only in barred range",)
    (said,) = found["Explanation"]
    at = SPEEDS[np.abs(torque(SPEEDS)).argmax()]
    assert said.startswith(
        f"measured at most {100 * FACTOR * largest / LIMIT:.3g} % of the limit, at {at:.4g} rpm; above it from"
    )
    assert said.endswith(", which is barred")


def test_differences_over_speed(report):
    found = columns(report, "Measured beside calculated orders over speed")
    away = np.abs((FACTOR - 1) * torque(SPEEDS))
    assert float(found["RMS difference"][0]) == pytest.approx(100 * (1 - FACTOR), rel=5e-3)
    assert float(found["Phase at peak"][0]) == pytest.approx(0, abs=0.11)
    assert float(found["In half widths"][0]) == pytest.approx(np.sqrt(np.mean((away / 0.5) ** 2)), rel=5e-3)
    peaks = columns(report, "Measured and calculated peaks")
    assert peaks["Verdict"] == ("constant factor",)


def test_german_sentences(tmp_path):
    report = report_on(FACTOR * torque(SPEEDS), tmp_path, "de")
    found = columns(report, "Gemessene halbe Schwingbreiten neben den Grenzen")
    assert found["Urteil"] == ("nur im Sperrbereich",)
    (said,) = found["Erklärung"]
    assert said.startswith("gemessen höchstens ")
    assert said.endswith(", was gesperrt ist")
    peaks = columns(report, "Gemessene und gerechnete Spitzen")
    assert peaks["Urteil"] == ("fester Faktor",)
    words_of_figures = re.compile(r"!\[.*?\]\(.*?\)")  # for those who cannot see them: not replaced
    section = words_of_figures.sub("", MarkdownWriter(report, ".").page().partition("Messplan")[2])
    for english in ("measured", "the limit", "half width", "Half range", "amplitudes", "orders of"):
        assert english not in section, english
    kept = columns(report_on(0.01 * torque(SPEEDS), tmp_path, "de"), "neben den Grenzen")
    assert kept["Urteil"] == ("hält die Grenze ein",)
