"""What a notebook shows of results: tables in place of dumps, and a picture where one exists."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
from support.ship_plant import SHIP
from support.written_models import TWO_DISCS

import torsionnet as tn
from torsionnet.base import packages
from torsionnet.base.table import Table
from torsionnet.linear.sensitivity import mode_sensitivities
from torsionnet.study import answer_study

LONGEST_NAME = 200
"""Characters of what a result is called in a list or a traceback."""


@pytest.fixture(scope="module")
def results():
    ship = tn.loads(SHIP)
    rig = tn.loads(TWO_DISCS).configured("soft")
    bench = tn.load_bench("dmf_bench")
    study = tn.study.define(
        tn.load("dmf_rig"),
        vary={"k_2": {"type": "normal", "deviation": "5 %"}},
        sampling={"count": 30},
        quantities={"f_1": {"type": "natural_frequency", "mode": 1}},
        limits={"f_1": {"below": 7.2}},
        answers={"share": {"type": "yield"}},
    )
    crank = "torque(" + next(name for name, one in ship.elements.items() if one.kind == "shaft") + ")"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return {
            "orders": ship.order_response(crank),
            "critical speeds": ship.critical_speeds(),
            "limits": ship.check_limits(),
            "modes": ship.modes(),
            "holzer": ship.holzer_table(1),
            "response": rig.frequency_response("phi", "T", np.linspace(1, 25, 500)),
            "sensitivities": mode_sensitivities(tn.load("dmf_rig")),
            "bench": bench,
            "study": study,
            "answers": answer_study(study),
        }


DRAWN = {"orders", "critical speeds", "limits", "response", "sensitivities", "answers"}


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "name",
    [
        "orders",
        "critical speeds",
        "limits",
        "modes",
        "holzer",
        "response",
        "sensitivities",
        "bench",
        "study",
        "answers",
    ],
)
def test_table_and_picture(results, name):
    shown = results[name]._repr_html_()
    assert "<table>" in shown
    assert "object at 0x" not in shown
    assert ("<img src=" in shown) == (name in DRAWN)
    assert len(repr(results[name])) < LONGEST_NAME
    assert "object at 0x" not in repr(results[name])


def test_long_tables_are_thinned_out():
    table = Table("t", (), tuple(() for _ in range(100)), ("note",))
    short = packages.thinned(table)
    assert len(short.rows) <= packages.MOST_ROWS
    assert short.notes == ("note", f"{len(short.rows)} of 100 lines")
    assert packages.thinned(short) is short


def test_what_cannot_be_drawn_has_its_table(results, monkeypatch):
    def fails(*_):
        raise tn.UsageError("nothing to draw")

    monkeypatch.setattr(tn.plot, "limit_check", fails)
    assert "<img" not in results["limits"]._repr_html_()


@pytest.fixture(scope="module")
def page_outputs(tmp_path_factory):
    """What each cell shows, by media type, run by a kernel in a folder of its own."""
    import jupytext
    from nbclient import NotebookClient

    page = jupytext.read(Path(__file__).parents[2] / "docs" / "how_to" / "notebooks.md")
    folder = tmp_path_factory.mktemp("notebook")
    NotebookClient(page, kernel_name="python3", resources={"metadata": {"path": str(folder)}}).execute()
    assert (folder / "gears.png").stat().st_size > 10_000
    cells = [cell for cell in page.cells if cell.cell_type == "code"]
    assert not [said for cell in cells for said in cell.outputs if said.output_type == "stream"]
    return [cell.outputs[0].data if cell.outputs else {} for cell in cells]


def test_modes_of_the_page_are_a_table(page_outputs):
    assert "<table>" in page_outputs[0]["text/html"]


def test_a_transfer_function_is_a_formula(page_outputs):
    assert r"\frac" in page_outputs[1]["text/latex"]


def test_a_figure_shows_itself(page_outputs):
    assert len(page_outputs[2]["image/png"]) > 10_000
    assert page_outputs[3] == {}
