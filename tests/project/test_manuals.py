"""Theory and verification manual: every case has its entry, deviations are told, and both are printed as PDF."""

import importlib
import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from support.forced_plants import NAMES
from validation.build import case_names, read_case

import torsionnet as tn

DOCS = Path(__file__).parents[2] / "docs"
PRINT = DOCS / "manuals" / "print_manuals.py"
THEORY_PAGES = range(15, 26)


@pytest.fixture(scope="module")
def verification():
    sys.path.insert(0, str(DOCS))
    yield importlib.import_module("verification_pages")
    sys.path.remove(str(DOCS))


class TestVerification:
    def test_every_case_of_the_tests_has_words_and_no_words_are_left(self, verification):
        assert set(verification.texts()) == {*case_names(), *NAMES}
        assert all(
            {"title", "shows"} <= set(words) <= {"title", "shows", "why"} for words in verification.texts().values()
        )

    def test_a_published_value_stands_beside_what_is_calculated(self, verification):
        """Gunter and Chen print 177.7 per minute."""
        lines = verification.lines_of(read_case("gunter_chen_8_1_marine_steam_turbine"))
        assert lines[0].cells[:3] == ["$f_{2}$ [1/min]", "print", "177.7"]
        assert lines[0].found == pytest.approx(177.71, abs=0.005)
        assert verification.all_hold(lines)

    def test_a_deviation_beyond_what_is_allowed_is_told(self, verification):
        lines = verification.lines_of(read_case("ot_two_mass"))
        wrong = [replace(lines[0], reference=180.0), *lines[1:]]
        text = verification._summary({"ot_two_mass": wrong})
        assert "| DIFFERS |" in text
        assert "1 of them differ" in text
        assert "| agrees |" in verification._summary({"ot_two_mass": lines})

    def test_entry_has_source_model_values_and_explanation(self, verification):
        case = read_case("friswell_9_9_drillstring_5el")
        text = verification._entry("friswell_9_9_drillstring_5el", case, verification.lines_of(case))
        for part in (
            "* Source: openTorsion",
            "| n0 | 200 | 0 |",
            "| n0 | n1 | spring |",
            "1.9417",
            "continuum $f_{2}$",
        ):
            assert part in text
        assert "**Where values differ.** Five elements are few" in text

    def test_many_values_end_in_one_row_with_the_largest_deviation(self, verification):
        table = verification.lines_table(verification.lines_of(read_case("uniform_chain_50_free_free")))
        assert sum(line.startswith("|") for line in table.splitlines()) == 2 + verification.MOST_LINES + 1
        assert "41 more [Hz]; worst $f_{" in table

    @pytest.mark.nightly
    def test_nothing_differs(self, verification):
        page = verification.verification_page()
        assert "DIFFERS" not in page
        assert page.count("\n### ") >= len(case_names()) + len(NAMES)
        assert "none of them differ" in page


class TestPrinting:
    def test_without_latex_it_says_what_to_install(self, tmp_path):
        done = subprocess.run(
            [sys.executable, str(PRINT), str(tmp_path)],
            env=os.environ | {"PATH": str(tmp_path)},
            check=False,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 3
        assert "pdflatex was not found" in done.stderr
        assert "texlive-latex-extra" in done.stderr

    @pytest.mark.nightly
    @pytest.mark.skipif(not all(map(shutil.which, ("pdflatex", "pdftotext"))), reason="pdflatex is not installed")
    def test_both_are_built_without_a_warning_and_carry_the_version(self, tmp_path):
        pytest.importorskip("sphinx", reason="Sphinx is in the group docs; make manuals builds them, too")
        done = subprocess.run(
            [sys.executable, str(PRINT), str(tmp_path)],
            env=os.environ | {"SOURCE_DATE_EPOCH": "1790000000", "PYTHONPATH": str(DOCS.parent)},
            check=False, capture_output=True, text=True,
        )  # fmt: skip
        assert (done.returncode, done.stderr) == (0, "")
        for name in ("torsionnet-theory", "torsionnet-verification"):
            text = subprocess.run(
                ["pdftotext", "-layout", tmp_path / f"{name}.pdf", "-"], check=False, capture_output=True, text=True
            ).stdout
            pages = text.split("\f")[:-1]
            assert re.search(rf"version {re.escape(tn.__version__)}\b", pages[0])
            assert all(f"version {tn.__version__}, 2026-09-21" in page for page in pages)
            assert name != "torsionnet-theory" or len(pages) in THEORY_PAGES


class TestFormulas:
    def test_number_of_an_equation_stands_beside_it(self):
        sys.path.insert(0, str(DOCS))
        try:
            mathml = importlib.import_module("mathml")
        finally:
            sys.path.remove(str(DOCS))
        assert mathml.without_number(r"a = b . \tag{3.2}") == ("a = b .", "3.2")
        assert mathml.without_number("a = b") == ("a = b", "")
