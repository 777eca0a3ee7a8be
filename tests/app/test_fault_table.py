"""The table of faults: each example has its fault and no other, the mended one none; explain, and links in editors."""

import pytest
from support.command_line import run
from support.faults import example_faults, faults_of

from torsionnet.app.text.text_faults import GROUPS, fault_kind, fault_kinds, fault_link

KINDS = fault_kinds()


@pytest.fixture
def in_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.mark.usefixtures("in_empty_folder")
@pytest.mark.parametrize("name", KINDS)
def test_an_example_has_its_fault_alone_and_the_mended_one_has_none(name):
    kind = KINDS[name]
    found = example_faults(kind, mended=False)
    assert {one for one, _ in found} == {name}
    assert found[0][1] == kind.says
    assert example_faults(kind, mended=True) == []


@pytest.mark.parametrize("name", KINDS)
def test_a_kind_has_two_or_three_words_and_a_sentence(name):
    kind = KINDS[name]
    assert all(word.isalpha() and word.islower() for word in name.split("-"))
    assert 2 <= len(name.split("-")) <= 3
    assert kind.means.endswith(".")
    assert all(old in kind.text for old in kind.mended)


def test_the_groups_are_files_with_kinds():
    assert {kind.group for kind in KINDS.values()} <= set(GROUPS)


def test_explain_shows_meaning_example_message_and_mending():
    text = run("explain", "[wrong-unit]").stdout
    assert text.startswith("wrong-unit: A unit is known, but measures something else.")
    assert "inertia: 2 kg*m}" in text
    assert "inertia: 2 kg*m^2}" in text
    assert "[wrong-unit]" in text


def test_explain_without_a_name_lists_all_kinds_by_group():
    lines = run("explain").stdout.splitlines()
    assert [line.split()[0] for line in lines if line.startswith("  ")] == list(KINDS)
    assert [line for line in lines if line and not line.startswith(" ")] == [
        title for group, title in GROUPS.items() if any(kind.group == group for kind in KINDS.values())
    ]


def test_explain_names_near_kinds():
    told = run("explain", "unknown-nodes", code=2).stderr
    assert "unknown-node" in told.partition("did you mean")[2]
    assert faults_of(lambda: fault_kind("wrong")) == [("unknown-name", ())]


def test_links_lead_to_the_section_of_a_kind():
    assert fault_link("wrong-unit").endswith("faults.html#wrong-unit")
