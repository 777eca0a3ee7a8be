"""Reports in German: every text is translated, names of the model stay, a template's words go before."""

import re

import pytest
import yaml
from support.command_line import run
from support.written_models import FAN

import torsionnet as tn
from torsionnet.report import make_report
from torsionnet.report.plan import LANGUAGES
from torsionnet.report.template_reading import words_of
from torsionnet.report.wording import Words, replaceable_texts
from torsionnet.report.writers.html import html_page

TEXTS = [text for texts in replaceable_texts().values() for text in texts]
OTHERS = [language for language in LANGUAGES if language != "en"]


@pytest.mark.parametrize("language", OTHERS)
class TestWords:
    def test_the_file_is_read_without_faults(self, language):
        words, faults = Words.read({"language": language, "texts": dict(words_of(language).texts)})
        assert words is not None
        assert faults == []


def test_page_in_german():
    page = html_page(make_report(tn.loads(FAN), language="de", date=None))
    assert "<html lang=de>" in page
    assert "Eigenformen" in page
    assert "Natural freq" not in page
    assert "shaft" in page, "names of elements are the model's"


def test_words_of_a_template_go_before(tmp_path):
    (tmp_path / "words.yaml").write_text(yaml.safe_dump({"texts": {"Validity": "Geltung"}}), encoding="utf-8")
    page = html_page(make_report(tn.loads(FAN), language="de", template=tmp_path, date=None))
    assert "Geltung" in page
    assert "<html lang=de>" in page
    assert "Eigenformen" in page


def test_command_and_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "fan.yaml").write_text(FAN + "report: {language: de}\n", encoding="utf-8")
    run("report", "fan.yaml", "-o", "de.md")
    run("report", "fan.yaml", "-o", "en.md", "--language", "en")
    assert re.search("^## .*Elemente$", (tmp_path / "de.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert re.search("^## .*Elements$", (tmp_path / "en.md").read_text(encoding="utf-8"), re.MULTILINE)
    with pytest.raises(tn.UsageError, match="unknown-word"):
        make_report(tn.loads(FAN), language="fr")
