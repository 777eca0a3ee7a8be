"""The examples of the README run."""

import re
import shlex
import shutil
from pathlib import Path

import pytest
from support import campaigns

import torsionnet as tn
from torsionnet.app.cli import main

FILES = Path(__file__).parents[2] / "examples" / "files"
README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def block(language: str) -> str:
    return blocks(language)[0]


def test_yaml_example_is_a_model():
    model = tn.loads(block("yaml"))
    assert [fault for fault in model.check() if fault.severity != "note"] == []
    # Free-free: J_1 and J_2/tau^2 on k_1.
    mass = 1 / (1 / 0.078 + 4.14**2 / 2.6)
    assert model.modes().undamped_natural_frequencies[-1] == pytest.approx(
        (13300 / mass) ** 0.5 / 6.283185307, rel=1e-9
    )
    assert block("yaml").count("\n") <= 12


def test_python_example_runs(capsys):
    code = block("python")
    exec(compile(code, "README.md", "exec"), {})
    printed = capsys.readouterr().out
    assert "natural      damped" in printed  # headings of the table of modes are broken between words
    assert "Matrix" in printed
    assert len([line for line in code.splitlines() if line and not line.startswith("import")]) <= 10


def test_fault_shown_in_the_readme_is_the_one_reported():
    broken = block("yaml").replace("stiffness: k_1", "stiffness: k1")
    with pytest.raises(tn.ModelError) as caught:
        tn.loads(broken, file="model.yaml")
    shown = blocks("text")[1].rstrip("\n")
    assert shown in str(caught.value)


def test_yaml_blocks_are_the_example_files_and_pass_check():
    for text, name in zip(blocks("yaml"), ["model.yaml", "plant.yaml", "car.yaml"], strict=True):
        assert text == (FILES / name).read_text(encoding="utf-8")
        assert not [fault for fault in tn.load(FILES / name).check() if fault.severity != "note"]


def test_result_shown_in_the_readme_is_the_one_printed(capsys, monkeypatch):
    monkeypatch.chdir(FILES)
    assert main(["modes", "model.yaml"]) == 0
    assert blocks("text")[0] in capsys.readouterr().out


def test_files_named_in_the_readme_exist():
    root = FILES.parents[1]
    for link in re.findall(r"\]\(([^)#]+)\)|src=\"([^\"]+)\"", README):
        target = "".join(link)
        assert target.startswith("https://") or (root / target).exists(), target


DEAR = ("marine_", "torsionnet fit drag.yaml", "torsionnet report two_stroke_ship")
"""Commands for the night: test_rotating_campaign runs two, test_tutorials such a fit, test_docs the same report."""


@pytest.mark.slow
def test_commands_of_the_readme_work_one_after_the_other(tmp_path, monkeypatch, capsys):
    for file in FILES.iterdir():
        shutil.copy(file, tmp_path)
    monkeypatch.chdir(tmp_path)
    lines = [line.partition("#")[0].strip() for text in blocks("sh") for line in text.splitlines()]
    lines += re.findall(r"^`(torsionnet [^`]*)`$", README, re.MULTILINE)
    for line in lines:
        if not campaigns.many and any(dear in line for dear in DEAR):
            continue
        if line.startswith("torsionnet ") and " explore " not in line:  # a page is served until it is stopped
            assert main(shlex.split(line)[1:]) == 0, (line, capsys.readouterr())


@pytest.mark.slow
def test_number_of_library_models():
    words = {6: "six", 7: "seven", 8: "eight", 9: "Nine", 10: "Ten", 11: "Eleven", 12: "Twelve"}
    own = sum(tn.load(name).source.startswith("own data") for name in tn.library_models())
    published = words[len(tn.library_models()) - 3 - own]  # without the rigs of the paper, and their flywheel by itself
    assert f"{published} published drivetrains of other fields and {words[own]} running plants" in README


def test_symbolic_forms_are_those_that_come_out():
    for name in ("dmf_rig", "amt_rig"):
        response = tn.load(name).symbolic().transfer_function("theta_1", "T_T")
        assert f"`{response.mechanical}`" in README
    dmf = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T").polynomial
    assert f"`{dmf.named}`" in README
    assert all(f"`{name} = {value}`" in README for name, value in dmf.where.items())
    amt = tn.load("amt_rig").symbolic().transfer_function("theta_1", "T_T").polynomial
    assert len(amt.denominator) == 5


def test_element_of_the_contributing_guide_is_the_one_in_the_package():
    root = Path(__file__).parents[2]
    shown = re.search(r"```python\n(.*?)```", (root / "CONTRIBUTING.md").read_text(encoding="utf-8"), re.DOTALL)[1]
    source = (root / "torsionnet" / "model" / "elements" / "dampers.py").read_text(encoding="utf-8")
    assert shown in source
