"""The title block of a report: its entries in a model file, and its fields on the document in every format."""

import contextlib
import re

import pytest
from support.command_line import run

import torsionnet as tn
from torsionnet.report import make_report
from torsionnet.report.plan.title_block import Revision, TitleBlock
from torsionnet.report.writers.html import html_page
from torsionnet.report.writers.latex import LatexWriter
from torsionnet.report.writers.markdown import MarkdownWriter

MODEL = """torsionnet: 1
name: two discs
elements:
  a: {type: inertia, node: a, inertia: 1}
  s: {type: spring, nodes: [a, b], stiffness: 100, damping: 0.1}
  b: {type: inertia, node: b, inertia: 2}
"""
BLOCK = """report:
  kind: approval
  sections: [validity]
  author: Author
  title_block:
    hull: 4711
    yard:
    rules: IACS UR M68
    revisions:
      - {revision: 0, date: 2025-03-30, description: first issue}
      - {revision: A, date: "2025-03-31", prepared: P. Name}
"""
LABELS = (
    "Project", "Document number", "Hull or plant", "Revision", "Owner", "Date", "Yard", "Class society", "Rules", "Edition",
    "Engine", "Rating", "Model", "Calculated with", "Model file",
)  # fmt: skip


def faults(section):
    with pytest.raises(tn.ModelError) as caught:
        tn.loads(MODEL + section, "m.yaml")
    return str(caught.value)


def report(section=BLOCK, **options):
    return make_report(tn.loads(MODEL + section), **{"date": "2025-04-01", **options})


class TestEntries:
    def test_is_read_and_written(self):
        rig = tn.loads(MODEL + BLOCK)
        block = rig.definition.report.title_block
        assert (block.hull, block.yard, block.rules, block.revision) == ("4711", "", "IACS UR M68", "A")
        assert block.revisions[0] == Revision(revision="0", date="2025-03-30", description="first issue")
        assert tn.loads(rig.to_yaml()).definition.report == rig.definition.report

    def test_every_fault_at_once_with_its_place(self):
        text = faults(
            "report:\n  title_block:\n    shipyard: x\n    yards: x\n    rating: 3.5\n    hull: H\n    revisions:\n"
            "      - {revision: A, date: 31.3.2025}\n      - {rev: B, date: 2025-02-30}\n"
        )
        for place, kind in (
            ("10:5", "unknown-entry"),
            ("9:5", "unknown-entry"),
            ("11:13", "wrong-form"),
            ("14:29", "wrong-form"),
            ("15:10", "unknown-entry"),
            ("15:24", "wrong-form"),
        ):
            assert re.search(rf"m\.yaml:{place}: error: .*{kind}", text), (place, text)

    def test_true_is_written_as_in_the_file(self):
        text = faults("report:\n  title_block: {hull: true}\n")
        assert 'put it in quotes, as in "true"' in text

    def test_hull_and_plant_share_a_field(self):
        assert "m.yaml:8:33: error: " in faults("report:\n  title_block: {hull: x, plant: y}\n")

    def test_schema_takes_what_is_read(self):
        jsonschema = pytest.importorskip("jsonschema")
        schema = {**TitleBlock.schema(), "$defs": TitleBlock.definitions()}
        validator = jsonschema.Draft202012Validator(schema)
        data = {"hull": 4711, "yard": None, "revisions": [{"revision": 0, "date": "2025-03-31"}]}
        assert list(validator.iter_errors(data)) == []
        assert list(validator.iter_errors({"yards": "x"})) != []

    def test_call_replaces_entries_or_all(self):
        joined = report(title_block={"owner": "Owner", "rules": "Other"}).title_block
        fields = dict(field for row in joined.rows for field in row)
        assert (fields["Hull"], fields["Owner"], fields["Rules"], fields["Revision"]) == ("4711", "Owner", "Other", "A")
        alone = report(title_block=TitleBlock(plant="P")).title_block
        fields = dict(field for row in alone.rows for field in row)
        assert (fields["Plant"], fields["Rules"], fields["Revision"]) == ("P", "", "")
        with pytest.raises(tn.ModelError, match=r'yards: .*"yard".*unknown-entry'):
            report(title_block={"yards": "x"})


class TestDocument:
    def test_document_for_approval_has_every_field_blank_or_not(self):
        block = report("report: {kind: approval, sections: [validity]}\n").title_block
        fields = dict(field for row in block.rows for field in row)
        assert tuple(fields) == LABELS
        known = {label for label, text in fields.items() if text}
        assert known == {"Date", "Model", "Calculated with", "Model file"}
        assert block.revisions == (("",) * 6,)
        assert block.signatures == (("Prepared", ""), ("Checked", ""), ("Approved", ""))

    def test_what_the_model_knows_joins_it_and_is_said_once(self):
        made = report()
        fields = dict(field for row in made.title_block.rows for field in row)
        assert (fields["Model"], fields["Date"]) == ("two discs", "2025-04-01")
        assert fields["Calculated with"] == f"torsionnet {tn.__version__}"
        assert re.fullmatch(r"described in Python, SHA-256 [0-9a-f]{64}", fields["Model file"])
        assert made.facts.rows == ()
        assert made.title_block.signatures[0] == ("Prepared", "Author")

    def test_report_on_a_rig_has_one_only_if_given(self):
        assert report("report: {sections: [validity]}\n").title_block is None
        given = report("report: {kind: rig, sections: [validity], title_block: {owner: X}}\n")
        assert given.title_block is not None
        assert "titleblock" not in html_page(report("report: {sections: [validity]}\n")).partition("</style>")[2]

    def test_html_has_blank_cells_and_lines_to_sign(self):
        text = html_page(report())
        assert "<th scope=row>Hull</th><td>4711</td>" in text
        assert "<th scope=row>Owner</th><td></td>" in text
        assert "<tr><td>A</td><td>2025-03-31</td><td></td><td>P. Name</td><td></td><td></td></tr>" in text
        for done, name in (("Prepared", "Author"), ("Checked", ""), ("Approved", "")):
            assert f"<tr><th scope=row>{done}</th><td>{name}</td><td></td><td></td></tr>" in text

    def test_latex(self):
        text = LatexWriter(report(), "f").page()
        assert "Hull & 4711 & Revision & A \\\\\\hline" in re.sub(r"\s+", " ", text).replace(
            "\\\\ \\hline", "\\\\\\hline"
        )
        assert "A & 2025-03-31 &  & P. Name &  &  \\\\\\hline" in text
        for done, name in (("Prepared", "Author"), ("Checked", ""), ("Approved", "")):
            assert f"{done} & {name} & & \\\\\\hline" in text

    def test_markdown(self):
        lines = MarkdownWriter(report(), "f").page().splitlines()
        assert "| Hull | 4711 | Revision | A |" in lines
        assert "| Owner |  | Date | 2025-04-01 |" in lines
        assert "| A | 2025-03-31 |  | P. Name |  |  |" in lines
        assert "| Checked |  | | |" in lines

    def test_texts_are_escaped(self):
        evil = "<b>50 % & $x_1$</b>"
        made = report(title_block={"owner": evil})
        assert "<td>&lt;b&gt;50 % &amp; $x_1$&lt;/b&gt;</td>" in html_page(made)
        assert r"\textless{}b\textgreater{}50 \% \& \$x\_1\$" in LatexWriter(made, "f").page()
        assert r"| \<b\>50 % \& \$x\_1\$\</b\> |" in MarkdownWriter(made, "f").page()

    def test_words_replace_labels_and_not_what_is_filled_in(self, tmp_path):
        (tmp_path / "words.yaml").write_text(
            "texts: {Owner: Eigner, Checked: Geprüft, Name: Wer, Hull: Schiff}\n", encoding="utf-8"
        )
        block = report(template=tmp_path, title_block={"owner": "Owner", "checked": "Name"}).title_block
        fields = dict(field for row in block.rows for field in row)
        assert (fields["Eigner"], fields["Schiff"]) == ("Owner", "4711")
        assert block.signatures[1] == ("Geprüft", "Name")
        assert block.signature_heads[1] == "Wer"

    def test_page_of_a_template_can_show_it(self, tmp_path):
        (tmp_path / "page.html").write_text("{% block title %}<hr>{{ title_block }}{% endblock %}", encoding="utf-8")
        text = html_page(report(template=tmp_path))
        assert re.search(r"<hr>\s*<div class=titleblock>", text)


def test_progress_names_each_section_once():
    told = []
    make_report("dmf_rig", sections=["modes", "validity"], progress=lambda *one: told.append(one), date=None)
    assert told == [("modes", 0, 2), ("validity", 1, 2)]


def test_command_shows_section_after_section(monkeypatch, tmp_path):
    """A bar on a terminal; none of it elsewhere."""
    told = []

    @contextlib.contextmanager
    def stages():
        yield lambda stage, done, total, words="": told.append((stage, done, total, words))

    monkeypatch.chdir(tmp_path)
    words = ("report", "dmf_rig", "--section", "modes", "--section", "validity", "-o", "r.md")
    quiet = run(*words)
    assert quiet.stderr == "wrote: r.md\n"
    monkeypatch.setattr("torsionnet.app.cli.terminal.stages", stages)
    run(*words)
    assert told == [
        ("reading", 0, None, "reading the model"),
        ("sections", 0, 2, "section modes"),
        ("sections", 1, 2, "section validity"),
        ("writing", 0, None, "writing r.md"),
    ]
