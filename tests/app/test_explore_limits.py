"""Texts that ask for too much: each is answered soon, with what is wrong with it, and tells nothing of other folders."""

import json
import os
import time

import pytest
from support.explore_texts import RIG, Page

from torsionnet.app.explore import api as text_requests
from torsionnet.app.explore import open_documents
from torsionnet.app.explore.document import MOST_FAULTS
from torsionnet.app.text import text_faults
from torsionnet.model.files.part_includes import MOST_INCLUDED

links = pytest.mark.skipif(os.name == "nt", reason="links need rights of their own on Windows")


@pytest.fixture
def page(tmp_path):
    path = tmp_path / "models" / "rig.yaml"
    path.parent.mkdir()
    path.write_text(RIG, encoding="utf-8")
    return Page(open_documents(str(path))[0])


def test_a_list_of_a_hundred_thousand_files_is_no_search(page):
    began = time.process_time()
    names = ",".join(f"a{k}.yaml" for k in range(100_000))
    (fault,) = [one for one in page.type(f"{RIG}include: [{names}]\n")["faults"] if one["severity"] == "error"]
    assert f" {MOST_INCLUDED} " in fault["message"]
    assert (fault["line"], fault["column"]) == (9, 1)
    assert time.process_time() - began < 20  # 2 s on a quiet machine, minutes where each is looked for


def test_as_many_files_as_may_be_are_read(page, tmp_path):
    names = [f"p{k}.yaml" for k in range(MOST_INCLUDED)]
    for name in names:
        (tmp_path / "models" / name).write_text("torsionnet: 1\nparts: {}\n", encoding="utf-8")
    assert page.type(f"{RIG}include: [{', '.join(names)}]\n")["sound"]


@links
def test_what_lies_behind_a_link_is_not_told(page, tmp_path):
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "secret.yaml").write_text("parts: {}\n", encoding="utf-8")
    (tmp_path / "models" / "link").symlink_to(outside)
    (tmp_path / "models" / "below").mkdir()
    (tmp_path / "models" / "below" / "public.yaml").write_text("parts: {}\n", encoding="utf-8")
    found = json.dumps(page.type(f"{RIG}include: [link/secert.yaml]\n"))
    assert "there is no file" in found
    assert "secret" not in found
    assert "public.yaml" in json.dumps(page.type(f"{RIG}include: [below/pubilc.yaml]\n", 2))


@links
@pytest.mark.parametrize("name", ["pipe.yaml", "zero.yaml", "circle.yaml", "large.yaml"])
def test_what_is_no_file_of_parts_is_not_read(page, tmp_path, name):
    folder = tmp_path / "models"
    os.mkfifo(folder / "pipe.yaml")
    (folder / "zero.yaml").symlink_to("/dev/zero")
    (folder / "circle.yaml").symlink_to(folder / "circle.yaml")
    with (folder / "large.yaml").open("wb") as stream:
        stream.truncate(1 << 30)
    text = f"{RIG}include: [{name}]\n"
    said = [one["message"] for one in page.type(text)["faults"] if one["severity"] == "error"]
    assert len(said) == 1
    assert "too large" in said[0] if name == "large.yaml" else "there is no file" in said[0]
    for question in ("complete", "hover", "definition", "references"):
        page.ask(question, text=text, at=text.index(name) + 2)


def test_services_leave_texts_alone_that_are_too_large(page, monkeypatch):
    monkeypatch.setattr(text_requests, "MOST_SERVED", len(RIG))
    asked = {"hover": {"at": 5}, "complete": {"at": 5}, "definition": {"at": 5}, "references": {"at": 5}, "format": {}}
    asked |= {"outline": {}, "rename": {"at": 5, "name": "x"}}
    for question, entries in asked.items():
        assert [str(len(RIG)) in said for said in page.ask(question, text=RIG + "\n", **entries)["refused"]] == [True]
    assert page.ask("outline", text=RIG)["items"]
    assert page.ask("paste", table="x" * (len(RIG) + 1)) == {"no_table": True}
    assert page.type(RIG + "\n")["sound"]


def test_the_rest_of_a_large_broken_text_is_not_examined(page, monkeypatch):
    broken = RIG.replace("inertia, node: brake", "inertai, node: brake") + "sensors: [\n"
    assert len(page.type(broken)["faults"]) == 2
    monkeypatch.setattr(text_faults, "MOST_RECOVERED", len(broken) - 1)
    assert len(page.type(broken, 2)["faults"]) == 1


@pytest.mark.slow
def test_of_many_faults_the_first_are_shown_and_mended(page):
    wrong = "".join(
        f"  e{k}: {{type: sprnig, nodes: [a, b], stiffness: 1 N*m/rad}}\n" for k in range(MOST_FAULTS + 200)
    )
    faults = page.type(f"torsionnet: 1\nelements:\n{wrong}")["faults"]
    assert len(faults) == MOST_FAULTS + 1
    assert faults[-1]["message"].endswith("more faults are not shown")
    assert [bool(one["fixes"]) for one in faults[1:4]] == [True] * 3
    assert not any(one["fixes"] for one in faults[text_faults.MOST_MENDED :])
