"""What a notebook shows of results: tables in place of dumps, and a picture where one exists."""

from __future__ import annotations

import warnings

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
