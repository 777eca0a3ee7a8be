"""What a document rests on: hashes of all its input files, and what the checks warn of in a condition."""

import hashlib
from pathlib import Path

import pytest

import torsionnet as tn
from torsionnet.report.document_tree import Remark
from torsionnet.report.report import make_report

SET = Path(__file__).parents[1] / "machinery" / "generating_set"
MARINE = Path(__file__).parents[2] / "library" / "marine_medium_speed.yaml"


@pytest.fixture
def folder(tmp_path):
    for file in SET.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    return tmp_path


def title_fields(path):
    report = make_report(path, sections=["validity"], kind="approval", date=None)
    return [field for row in report.title_block.rows for field in row]


def test_every_trace_is_hashed_in_the_title_block(folder):
    fields = [text for label, text in title_fields(folder / "set.yaml") if label == "Input file"]
    names = ["comp.csv", "comp0.csv", "p0.csv", "p100.csv", "p50.csv"]
    digests = [hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in names]
    assert fields == [f"{name}, SHA-256 {digest}" for name, digest in zip(names, digests, strict=True)]


def test_more_pressure_in_a_trace_alone_changes_the_title_block(folder):
    before = title_fields(folder / "set.yaml")
    head, *lines = (folder / "p100.csv").read_text(encoding="utf-8").splitlines()
    pairs = [line.split(";") for line in lines]
    raised = [f"{angle};{1.04 * float(bar):.3f}" for angle, bar in pairs]
    (folder / "p100.csv").write_text("\n".join([head, *raised]), encoding="utf-8")
    after = title_fields(folder / "set.yaml")
    changed = [one[0] for one, other in zip(before, after, strict=True) if one != other]
    assert changed == ["Input file"]


def test_parts_of_other_files_are_hashed_in_a_report_on_a_rig(tmp_path):
    part = "torsionnet: 1\nparts: {wheel: {ports: [hub], elements: {disc: {type: inertia, node: hub, inertia: 2}}}}\n"
    (tmp_path / "wheels.yaml").write_text(part, encoding="utf-8")
    model = tmp_path / "rig.yaml"
    model.write_text(
        "torsionnet: 1\nname: rig\ninclude: [wheels.yaml]\nuse: {left: {part: wheel, at: {hub: a}}}\n"
        "elements: {shaft: {type: spring, nodes: [a, ground], stiffness: 10}}\n",
        encoding="utf-8",
    )
    facts = dict(make_report(model, sections=["schematic"], date=None).facts.rows)
    assert "".join(map(str, facts["Input files"])) == (
        f"wheels.yaml, SHA-256 {hashlib.sha256(part.encode()).hexdigest()}"
    )


@pytest.mark.parametrize(
    ("configurations", "where"),
    [
        ("pitch: {full: {}, zero: {load.power: 450 kW}}", " (in zero pitch)"),
        ("pitch: {zero: {load.power: 450 kW}}", ""),
    ],
)
def test_a_warning_of_the_checks_stands_in_the_document_with_its_condition(configurations, where):
    text = MARINE.read_text(encoding="utf-8")
    model = tn.loads(f"{text[: text.index('configurations:')]}configurations:\n  {configurations}\n")
    report = make_report(model, sections=["validity"], kind="approval", configurations=model.configurations, date=None)
    remarks = [block for block in report.sections[0].blocks if isinstance(block, Remark)]
    assert {one.kind for one in remarks} == {"warning"}
    texts = ["".join(map(str, one.text)) for one in remarks]
    (said,) = [text for text in texts if "15% of the torque of full ahead" in text]
    assert said.startswith("Archer's damping with ")
    assert said.endswith(f"give damping for this condition{where}.")
