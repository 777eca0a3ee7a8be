"""``torsionnet new``: files to start from, which are sound as they are and say what to put where."""

import os
import re
from pathlib import Path

import pytest
from support import campaigns
from support.command_line import process, run

import torsionnet as tn
from torsionnet.app.cli.commands.model_files import KINDS, starting_model

FOLDER = Path(tn.__file__).parent / "app" / "cli" / "starting_models"
VERDICTS = {"ship": "barred range", "genset": "pass", "train": "pass", "turbine": "pass"}


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def written(request, tmp_path):
    run("new", request.param, "plant")
    return tmp_path / "plant.yaml"


def each_kind(kinds=KINDS):
    return pytest.mark.parametrize("written", kinds, indirect=True)


# The files


def test_each_kind_has_its_file_and_each_file_its_kind():
    assert sorted(path.name for path in FOLDER.iterdir()) == sorted(f"{kind}.yaml" for kind in KINDS)


@pytest.mark.parametrize("kind", KINDS)
def test_files_are_short_and_say_what_to_put_there(kind):
    lines = (FOLDER / f"{kind}.yaml").read_text(encoding="utf-8").splitlines()
    assert 60 <= len(lines) <= 110
    assert 20 <= sum(line.lstrip().startswith("#") for line in lines) <= 40
    assert max(map(len, lines)) <= 120
    assert "FIGURES ARE EXAMPLES" in "\n".join(lines[:2])
    assert lines.count("name: NAME") == 1


@pytest.mark.parametrize("kind", KINDS)
def test_every_section_has_a_comment(kind):
    lines = (FOLDER / f"{kind}.yaml").read_text(encoding="utf-8").splitlines()
    sections = [number for number, line in enumerate(lines) if re.match(r"[a-z_]+:", line)]
    bare = [lines[number] for number in sections if not lines[number - 1].startswith("#")]
    plain = ("torsionnet:", "name:", "source:", "sensors:")
    assert [line for line in bare if not line.startswith(plain)] == []


@each_kind()
def test_check_has_nothing_against_it(written):
    shown = run("check", written)
    assert "plant.yaml: no errors" in shown.stdout
    assert "warning" not in shown.stdout + shown.stderr


@each_kind()
def test_only_that_it_turns_freely_is_noted(written):
    notes = [fault.text for fault in tn.load(written).check() if fault.severity != "error"]
    assert all(text.startswith("the drivetrain can turn freely") for text in notes)


@each_kind()
def test_modes(written):
    model = tn.load(written)
    assert model.name == "plant"
    for name in model.configurations:
        frequencies = model.configured(name).modes().natural_frequencies
        assert frequencies[-1] > 20
    assert run("modes", written, "-c", "all").stdout


@pytest.mark.parametrize(("kind", "verdict"), VERDICTS.items())
def test_limits_are_judged_in_all_configurations(kind, verdict):
    """Exit code 0: nothing fails, and nothing was left out."""
    run("new", kind, "plant")
    *_, last = run("limits", "plant.yaml", "-c", "all").stdout.splitlines()
    assert last.startswith(f"plant: {verdict}: ")


def test_the_rig_has_no_limits():
    assert "limits:" not in starting_model("rig", "plant")


def test_the_ship_has_to_pass_its_first_critical_speed_quickly():
    """Order 6 meets the one-node mode; what M68 bars lies below 0.8 of rated speed with all cylinders firing."""
    run("new", "ship", "plant")
    ship = tn.load("plant.yaml").configured("normal")
    first = ship.modes().natural_frequencies[ship.modes().natural_frequencies > 1][0]
    (span,) = ship.check_limits().barred
    low, high = (float(number) for number in re.findall(r"[\d.]+", str(span))[:2])
    assert low < 60 * first / 6 < high < 0.8 * 105


@pytest.mark.slow
@each_kind(campaigns.by_day(KINDS, "rig"))
def test_report(written):
    run("report", written, "-o", "plant.html")
    assert "<h1" in Path("plant.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_rig_tests_itself():
    run("new", "rig", "plant")
    run("bench", "plant.yaml", "-o", "test.npz")
    shown = run("compare", "test.npz", "plant.yaml", "--input", "T_T", "--output", "theta_1").stdout
    assert float(re.search(r"^FRAC +- +([\d.]+)", shown, re.MULTILINE)[1]) > 0.99


# Names and paths

ODD = [
    "Saga: #1",
    "no",
    "12",
    "1e3",
    "null",
    "'",
    '"',
    "\\",
    "{x}",
    "[",
    "& *",
    "%",
    "~",
    "a -b",
    "Ærø ⚓",
    "a\nb",
    "a\tb",
    "NAME",
]


@pytest.mark.parametrize("name", ODD)
def test_a_name_is_a_text_whatever_is_in_it(name):
    assert tn.loads(run("new", "rig", name, "-o", "-").stdout).name == name


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_but_the_name_differs_from_the_file_of_the_package(kind):
    stored = (FOLDER / f"{kind}.yaml").read_text(encoding="utf-8")
    text = starting_model(kind, "a: b")
    assert [line for line in text.splitlines() if line not in stored.splitlines()] == ['name: "a: b"']
    assert starting_model(kind, "NAME") == stored


@pytest.mark.parametrize(
    ("given", "file", "name"),
    [
        ("sagafjord", "sagafjord.yaml", "sagafjord"),
        ("sagafjord.yaml", "sagafjord.yaml", "sagafjord"),
        ("sagafjord.YML", "sagafjord.YML", "sagafjord"),
        ("ships/sagafjord", "ships/sagafjord.yaml", "sagafjord"),
        ("./ships/../rev. 1.2", "rev. 1.2.yaml", "rev. 1.2"),
        ("on", "on.yaml", "on"),
    ],
)
def test_where_it_is_written(given, file, name):
    Path("ships").mkdir()
    shown = run("new", "rig", given)
    assert shown.stdout == ""
    assert shown.stderr.startswith("wrote: ")
    assert tn.load(file).name == name


def test_a_name_with_slashes_goes_with_a_file_named_apart():
    run("new", "ship", "M/S Sagafjord", "-o", "ship.yaml")
    assert tn.load("ship.yaml").name == "M/S Sagafjord"
    assert "[missing-file]" in run("new", "ship", "M/S Sagafjord", code=2).stderr
    assert "end in .yaml" in run("new", "ship", "x", "-o", "ship.txt", code=2).stderr


@pytest.mark.parametrize("name", ["", " ", "\t", ".", "..", ".yaml", "folder/", "-"])
def test_no_name(name):
    Path("folder").mkdir()
    assert "[invalid-name]" in run("new", "ship", name, code=2).stderr
    assert [path.name for path in Path().iterdir()] == ["folder"]


@pytest.mark.parametrize("more", [(), ("-o", "sagafjord.yaml")])
def test_a_file_that_exists_is_never_overwritten(more):
    Path("sagafjord.yaml").write_text("mine", encoding="utf-8")
    assert "exists already" in run("new", "ship", "sagafjord", *more, code=2).stderr
    assert Path("sagafjord.yaml").read_text(encoding="utf-8") == "mine"


@pytest.mark.skipif(os.name == "nt", reason="links need a privilege there")
def test_a_link_to_nowhere_is_not_followed():
    Path("sagafjord.yaml").symlink_to("elsewhere.yaml")
    run("new", "ship", "sagafjord", code=2)
    assert not Path("elsewhere.yaml").exists()


def test_unknown_kind():
    assert 'did you mean "ship"?' in run("new", "shp", "sagafjord", code=2).stderr
    assert f"there are {', '.join(KINDS)}" in run("new", "bicycle", "x", code=2).stderr
    assert not list(Path().iterdir())


def test_help_names_every_kind():
    text = run("new", "--help").stdout
    assert all(re.search(rf"^    {kind} +\w", text, re.MULTILINE) for kind in KINDS)


def test_printed_text_goes_through_a_pipe(tmp_path):
    printed = process("new", "turbine", "hill", "-o", "-", directory=tmp_path)
    assert (printed.returncode, printed.stderr) == (0, "")
    read = process("check", "-", directory=tmp_path, input=printed.stdout)
    assert read.returncode == 0, read.stderr
