"""``--digits``: every table on the screen, and nothing else."""

import json
import re
from pathlib import Path

import pytest
from support.command_line import run

import torsionnet as tn
from torsionnet.app.cli.app import COMMANDS, app
from torsionnet.base import number_text
from torsionnet.base.table import Column, Table

SCREEN = 120


def words_of(name):
    return {word for parameter in app.get_command(None, name).params for word in parameter.opts}


def test_every_command_with_numbers_in_tables_has_it():
    having = {name for name in COMMANDS if "--digits" in words_of(name)}
    assert having == {name for name in COMMANDS if "--json" in words_of(name)} - {"library", "check", "equations"}


@pytest.mark.parametrize("digits", [2, 3, 9])
def test_modes(digits):
    shown = run("modes", "dmf_rig", "--digits", digits).stdout
    for mode in json.loads(run("modes", "dmf_rig", "--json").stdout)[0]["modes"]:
        assert re.search(rf"\s{re.escape(format(mode['natural_frequency_Hz'], f'.{digits}g'))}\s", shown)


def test_matrices():
    shown = run("show", "dmf_rig", "--matrices", "--digits", 2).stdout
    cells = [abs(value) for value in tn.load("dmf_rig").assembly.system.K.ravel() if value]
    assert {f"{value:.2g}" for value in cells} <= {word.strip("-") for word in shown.split()}


def test_texts_with_numbers_in_them(tmp_path):
    (tmp_path / "m.yaml").write_text(
        "torsionnet: 1\nelements: {s: {type: spring, nodes: [a, ground], stiffness: 1.23456789 kN*m/rad}}"
    )
    assert "1.23456789 kN*m/rad = 1234.57 N*m/rad" in run("show", tmp_path / "m.yaml").stdout
    assert "1.23456789 kN*m/rad = 1234.5679 N*m/rad" in run("show", tmp_path / "m.yaml", "--digits", 8).stdout


def test_shares_are_no_longer_cut_and_tables_stay_on_the_screen():
    arguments = ("modes", "six_cylinder_diesel", "--energies", "--shapes")
    assert not re.search(r"\d\.\d{3}\b", run(*arguments).stdout.partition("energy shares")[2])
    exact = run(*arguments, "--digits", 9).stdout
    assert re.search(r"\d\.\d{6}\b", exact.partition("energy shares")[2])
    assert max(map(len, exact.splitlines())) <= SCREEN


def test_files_keep_all_digits(tmp_path):
    files = [tmp_path / "few.csv", tmp_path / "all.csv"]
    arguments = ("frf", "dmf_rig", "--output", "theta_1", "--input", "T_T", "--points", 5, "--csv")
    run(*arguments, files[0], "--digits", 2)
    run(*arguments, files[1])
    assert files[0].read_text() == files[1].read_text()


def test_is_refused_where_it_would_do_nothing():
    refused = run("modes", "dmf_rig", "--json", "--digits", 3, code=2)
    assert "--digits" in refused.stderr
    assert not refused.stdout


def test_a_table_with_other_digits():
    table = Table("", (Column("x", digits=4, decimals=1), Column("y")), ((12.3456, ("k = ", 2 / 3)),))
    assert table.cells() == [["12.3", "k = 0.666667"]]
    assert table.with_digits(3).cells() == [["12.3", "k = 0.667"]]
    assert table.with_digits(5).cells() == [["12.346", "k = 0.66667"]]
    assert table.to_csv().splitlines()[-1] == "12.3456,k = 0.666667"


def test_the_page_for_a_browser_has_the_same_limits():
    script = (Path(tn.__file__).parent / "app" / "explore" / "static" / "numbers.js").read_text(encoding="utf-8")
    largest, smallest = re.search(r"size >= (\S+) \|\| size < (\S+) \?", script).groups()
    assert (float(smallest), float(largest)) == (number_text.SMALLEST_PLAIN, number_text.LARGEST_PLAIN)
    assert f'"{number_text.MISSING_TYPESET}"' in script
