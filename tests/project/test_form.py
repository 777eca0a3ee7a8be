"""Rules of form, which `make lint` applies to the checkout, notice what breaks them and let its neighbours pass."""

import importlib
import re
import subprocess
from pathlib import Path

import pytest
import structure.rules
from structure import form, precheck, public, words
from structure.measures import circles, doubled_classes
from structure.modules import Module, modules_below
from structure.rules import (
    MAX_LINES,
    Fault,
    aliases_of_anything,
    data_from_prose,
    evaluation,
    faults_of_theory,
    fragmentary_sentences,
    idle_dataclasses,
    import_circles,
    imports_of_tests,
    long_modules,
    names_twice,
    package_faults,
    plotting,
    printing,
    untyped_entries,
    upward_imports,
    upward_in_layer,
    without_layer,
)
from structure.sentences import first_sentence, is_fragment
from support.models import EVERY_ELEMENT

import torsionnet as tn
from torsionnet.base import deprecation

ROOT = Path(__file__).parents[2]


# Modules of a made-up package


def a_module(tmp_path, name, source):
    path = tmp_path / "torsionnet" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / "torsionnet" / "linear").mkdir(exist_ok=True)
    path.write_text(source, encoding="utf-8")
    return Module(path, tmp_path / "torsionnet")


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("model/gear.py", "from torsionnet.linear import modes"),
        ("model/gear.py", "from torsionnet.linear.modes.natural_modes import modes"),
        ("model/gear.py", "import torsionnet.linear.modes.natural_modes"),
        ("model/gear.py", "from torsionnet import linear"),
        ("model/gear.py", "from torsionnet import load"),
        ("model/gear.py", "from .. import linear"),
        ("model/gear.py", "from ..linear.modes import modes"),
        ("model/__init__.py", "from ..linear import modes"),
        ("model/gear.py", "def f():\n    from torsionnet.linear import modes"),
        ("model/gear.py", "try:\n    from torsionnet.linear import modes\nexcept ImportError:\n    pass"),
        ("base/units.py", "from ..model import Gear"),
        ("base/units.py", "from torsionnet.nowhere import x"),
        ("model/model.py", "class D:\n    def modes(self):\n        from torsionnet.linear import modes"),
        ("model/gear.py", "if TYPE_CHECKING:\n    from torsionnet.linear import Modes"),
        ("model/reader.py", "def f():\n    from torsionnet.linear import modes"),
        ("model/gear.py", "if TYPE_CHECKING:\n    pass\nelse:\n    from torsionnet.linear import modes"),
    ],
)
def test_upward_import_is_found(tmp_path, name, source):
    assert list(upward_imports(a_module(tmp_path, name, source))) != []


@pytest.mark.parametrize(
    ("name", "source"),
    [
        (
            "linear/modes/natural_modes.py",
            "from torsionnet.model.elements import Gear\nfrom . import time\nfrom ..base import SolveError",
        ),
        ("model/gear.py", "from .base import Element\nimport math\nfrom collections import abc"),
        ("drivetrain.py", "class D:\n    def modes(self):\n        from torsionnet.linear import modes"),
        ("io/tors.py", "from torsionnet.drivetrain import Drivetrain"),
        ("__init__.py", "from torsionnet.app.cli import main"),
    ],
)
def test_other_imports_are_allowed(tmp_path, name, source):
    assert list(upward_imports(a_module(tmp_path, name, source))) == []


@pytest.mark.parametrize(
    ("name", "source", "allowed"),
    [
        ("linear/modes/natural_modes.py", "from torsionnet.linear.batch.batched_responses import x", False),
        ("linear/modes/natural_modes.py", "def f():\n    from torsionnet.linear.responses.grid import x", False),
        ("linear/modes/natural_modes.py", "from torsionnet.linear.dynamic_stiffness.tape import x", True),
        ("linear/modes/natural_modes.py", "from torsionnet.linear.modes.eigen import x", True),
        ("linear/__init__.py", "from torsionnet.linear.batch.batched_responses import x", True),
        ("plot/bode_plot.py", "from torsionnet.plot.study.axes import x", False),
        ("plot/bode_plot.py", "from torsionnet.plot.schematics.drawing_plan import x", True),
        ("plot/schematics/drawing_plan.py", "from torsionnet.plot.bode_plot import x", False),
        ("model/element_base/laws.py", "from torsionnet.model.elements.gears import x", False),
        ("model/element_base/laws.py", "from torsionnet.model.checks.names import x", True),
    ],
)
def test_an_import_from_a_floor_above_is_found(tmp_path, name, source, allowed):
    assert (list(upward_in_layer(a_module(tmp_path, name, source))) == []) is allowed


@pytest.mark.parametrize(
    ("rule", "source"),
    [
        (printing, "print('x')"),
        (printing, "import click\nclick.echo('x')"),
        (printing, "def f():\n    from rich.table import Table"),
        (evaluation, "eval('x')"),
        (evaluation, "exec('x')"),
        (evaluation, "import sympy\nsympy.sympify('x')"),
        (evaluation, "from sympy.parsing.sympy_parser import parse_expr\nparse_expr('x')"),
        (evaluation, "import sympy\nsympy.S('x')"),
        (untyped_entries, "class A:\n    x: Any = entry(Value('x', '1'))"),
        (untyped_entries, "class A:\n    x: tuple[str, Any] | None = entry(PAIR, None)"),
        (aliases_of_anything, "Number: TypeAlias = Any"),
        (aliases_of_anything, "Value = Any | None"),
        (aliases_of_anything, "Value: TypeAlias = 'dict[str, str] | Any'"),
        (plotting, "def f():\n    import matplotlib.pyplot as plt"),
        (without_layer, "x = 1"),
        (fragmentary_sentences, 'def f():\n    """Of all laws."""'),
        (long_modules, "x = 1\n" * (MAX_LINES + 1)),
        (idle_dataclasses, "@dataclass(eq=False, repr=False)\nclass A(B):\n    kind: ClassVar[str] = 'a'"),
    ],
)
def test_forbidden_thing_is_found(tmp_path, rule, source):
    place = "nowhere/modes.py" if rule is without_layer else "linear/modes/natural_modes.py"
    (fault,) = rule(a_module(tmp_path, place, source))
    assert re.fullmatch(rf"torsionnet/{place}:\d+", fault.place)
    assert fault.remedy


@pytest.mark.parametrize(
    ("place", "rule", "source"),
    [
        ("plot/bode_plot.py", plotting, "import matplotlib.pyplot as plt"),
        ("linear/grid.py", plotting, "if TYPE_CHECKING:\n    from matplotlib.figure import Figure"),
        ("app/cli/app.py", printing, "print('x')"),
        ("app/text/fixes/names.py", data_from_prose, "written.text, fault.kind"),
        ("linear/grid.py", idle_dataclasses, "@dataclass(eq=False, repr=False)\nclass A(B):\n    x: int = 1"),
    ],
)
def test_its_allowed_neighbour_is_not(tmp_path, place, rule, source):
    assert list(rule(a_module(tmp_path, place, source))) == []


@pytest.mark.parametrize("source", ["'not used' in fault.message", "re.match('x', place.fault.text)"])
def test_a_quick_fix_that_reads_a_message_is_found(tmp_path, source):
    assert len(list(data_from_prose(a_module(tmp_path, "app/text/fixes/names.py", source)))) == 1


def test_class_names_twice_are_found_and_file_names_are_not(tmp_path):
    modules = [a_module(tmp_path, f"{folder}/grid.py", "class Grid:\n    pass\n") for folder in ("linear", "plot")]
    assert [fault.place for fault in names_twice(modules)] == ["torsionnet/linear/grid.py:1"]
    allowed = [a_module(tmp_path, f"{folder}/modes.py", "x = 1\n") for folder in ("linear", "plot")]
    assert list(names_twice(allowed)) == []


def test_all_rules_on_modules_are_applied(tmp_path):
    source = '"""Of all laws."""\nimport matplotlib\nprint(eval("1"))\n'
    modules = [a_module(tmp_path, f"{folder}/grid.py", source) for folder in ("linear", "model")]
    told = sorted(fault.what for fault in package_faults(modules) if "linear" in fault.place)
    assert [what.split()[0] for what in told] == ["calls", "calls", "imports", "the"]


def test_no_rule_on_a_module_is_left_out():
    """What takes one module and yields faults is applied to all of them."""
    rules = {
        name
        for name, rule in vars(structure.rules).items()
        if str(getattr(rule, "__annotations__", None)) == "{'module': 'Module', 'return': 'Iterator[Fault]'}"
    }
    assert rules == {rule.__name__ for rule in structure.rules.OF_A_MODULE}


def test_faults_of_the_theory_manual_are_found(tmp_path):
    theory = tmp_path / "docs" / "theory"
    theory.mkdir(parents=True)
    (theory / "index.md").write_text("```{toctree}\n:maxdepth: 1\n\nlaws\n```\n", encoding="utf-8")
    (theory / "laws.md").write_text(
        "\\tag{1.1}\n\\tag{1.3}\n`modes/eigen.py`, `linear/modes/`, `tests/linear/test_modes.py`, `linear/grid.py`\n",
        encoding="utf-8",
    )
    (theory.parent / "page.md").write_text("`linear/eigen.py`, `model/rig.py`, `rig.py`, `out/`\n", encoding="utf-8")
    modules = [a_module(tmp_path, "linear/modes/eigen.py", "")]
    assert [f"{fault.place} {fault.what}" for fault in faults_of_theory(theory.parent, modules)] == [
        "docs/theory/laws.md:2 equation 1.3 should be 1.2",
        f"{tmp_path.name}/docs/page.md:1 there is no linear/eigen.py",
        f"{tmp_path.name}/docs/page.md:1 there is no model/rig.py",
        "docs/theory/laws.md:3 there is no linear/grid.py",
    ]


def test_an_import_of_a_file_of_tests_is_found(tmp_path):
    path = tmp_path / "test_one.py"
    path.write_text(
        "from support.one import x\nfrom test_two import y\ndef f():\n    import test_three\n", encoding="utf-8"
    )
    told = [(fault.place.rpartition(":")[2], fault.what) for fault in imports_of_tests(path)]
    assert told == [("2", "imports test_two"), ("4", "imports test_three")]


def test_a_circle_is_found(tmp_path):
    package = tmp_path / "torsionnet"
    package.mkdir()
    (package / "one.py").write_text("def f():\n    from torsionnet.two import g\n", encoding="utf-8")
    (package / "two.py").write_text("if TYPE_CHECKING:\n    from torsionnet.one import f\n", encoding="utf-8")
    (package / "three.py").write_text("import torsionnet.one\nclass A: pass\nclass B: pass\n", encoding="utf-8")
    (package / "four.py").write_text('"""Text."""\n# a remark\nclass A:\n    x: Any = 1\n', encoding="utf-8")
    (package / "parts").mkdir()
    (package / "parts" / "__init__.py").write_text("from torsionnet.parts.first import x\n", encoding="utf-8")
    (package / "parts" / "first.py").write_text("from torsionnet.parts import second\n", encoding="utf-8")
    (package / "parts" / "second.py").write_text("", encoding="utf-8")
    found = [module for module in modules_below(package) if module.text]
    assert circles(found) == [["torsionnet.one", "torsionnet.two"], ["torsionnet.parts", "torsionnet.parts.first"]]
    assert [fault.place for fault in import_circles(found)] == ["torsionnet.one", "torsionnet.parts"]
    assert doubled_classes(found) == ["A"]
    assert {module.path.stem: module.code_lines for module in found} == {
        "one": 1,
        "two": 1,
        "three": 2,
        "four": 2,
        "__init__": 0,
        "first": 0,
    }
    assert [module.lines_with_any for module in found if module.path.stem == "four"] == [1]


# First sentences


@pytest.mark.parametrize(
    "sentence",
    [
        "Of all laws at omega in rad/s",
        "With names that no element has",
        "The same, but for another order of elimination",
        "W",
        "As it was given",
        "What runs in the drivetrain",
        "All that occur, in Hz",
        "Where its teeth mesh",
    ],
)
def test_fragments_are_found(sentence):
    assert is_fragment(sentence)


@pytest.mark.parametrize(
    "sentence",
    [
        "Torque of each law in N m, shape (n_f,)",
        "All inputs by name",
        "Whether the drivetrain turns freely",
        "Solve the equations of motion",
        "Lowest modes of a large system",
    ],
)
def test_sentences_pass(sentence):
    assert not is_fragment(sentence)


def test_first_sentence_ends_at_the_first_stop():
    assert first_sentence("Torque in N m on a\n    free node. More.\n\nRest.") == "Torque in N m on a free node"
    assert first_sentence("Order of an engine: half orders too.") == "Order of an engine"


# The public interface


def test_changes_of_signatures_are_told_with_what_to_do():
    stored, now = ["tn.f(a: int)", "tn.h()"], ["tn.f(a: int)", "tn.g(b: int)"]
    gone, new = public.changed_signatures(stored, now)
    assert (gone.place, gone.what) == ("tests/public_signatures.txt:2", "gone from the public interface: tn.h()")
    assert "`deprecated`" in gone.remedy
    assert new.what == "new in the public interface: tn.g(b: int)"
    assert new.remedy.startswith("make signatures")
    assert list(public.changed_signatures(stored, stored)) == []


def test_results_that_are_not_public_and_members_that_are_not_there_are_found():
    lines = ["tn.f(a: int) -> Inner", "tn.g() -> Outer", "tn.h() -> Self classmethod", "tn.k() -> FloatArray"]
    (fault,) = public.inner_results(lines, {"Outer"})
    assert fault.what == "tn.f returns Inner, which is not public"
    assert [fault.what for fault in public.missing_members({object: {"no"}, tn.Spring: {"kind", "no"}})] == [
        "Spring has no member no"
    ]


def test_names_without_a_task_and_results_without_a_call_are_found():
    (fault,) = public.unused_names(["torsionnet.load", "torsionnet.signals.frob"], {"torsionnet.load": ()})
    assert (fault.place, fault.what) == ("torsionnet/signals/__init__.py", "frob stands on no page and in no example")
    (fault,) = public.idle_results({"Modes": ["Drivetrain.modes"], "Frob": []})
    assert fault.what == "no public name returns Frob"


def test_a_page_uses_what_its_programs_and_its_words_name(monkeypatch):
    monkeypatch.syspath_prepend(str(public.DOCS))
    uses = importlib.import_module("public_uses")
    program = "import torsionnet as tn\nfrom torsionnet import plot as p\nfrom torsionnet.io import to_tors\nx.load(tn.units.convert)\np.bode(1)"
    assert uses.names_in_program(program, {}) >= {
        *("torsionnet.plot", "torsionnet.io.to_tors", "torsionnet.base.units.convert", "torsionnet.plot.bode")
    }
    assert "torsionnet.load" not in uses.names_in_program(program, {})
    text = (
        "Call `signals.decimate(x)` or `tn.load`; `estimate` alone and tn.loads are words.\n```sh\n`tn.plot.fit`\n```\n"
    )
    found = uses.names_on_page(text)
    assert found >= {"torsionnet.signals.decimate", "torsionnet.load"}
    assert not {name for name in found if "estimate" in name or "loads" in name or "fit" in name}


def test_fields_that_go_and_come_are_found():
    gone, new = public.changed_fields(["# Fields", "modes.a", "modes.b"], {"modes.b", "modes.c"})
    assert (gone.place, gone.what) == ("tests/output_fields.txt:2", "modes.a is gone")
    assert new.what == "modes.c is new in what --json prints"


def test_a_deprecated_name_that_is_overdue_is_found(monkeypatch):
    monkeypatch.setattr(deprecation, "PENDING", [deprecation.Deprecation("f", "1.1", "1.3", "use g")])
    assert list(public.overdue_names("1.2.9")) == []
    (fault,) = public.overdue_names("1.3.0")
    assert "f" in fault.what


PAGE = """\
Text
```python
import torsionnet as tn
tn.plot.bode(tn.plot._inner)
from torsionnet.linear import batch
```
```python
for name in tn.units.convert, tn.frob:
    from torsionnet.base.units import convert
```
"""


def test_uses_of_inner_names_are_found():
    packages = {"torsionnet", "torsionnet.plot"}
    assert [f"{fault.place} {fault.what}" for fault in public.inner_uses(PAGE, Path("docs/page.md"), packages)] == [
        "docs/page.md:5 torsionnet.linear is not public",
        "docs/page.md:4 torsionnet.plot._inner is not public",
        "docs/page.md:9 takes units from torsionnet.base.units",
        "docs/page.md:8 torsionnet.frob is not public",
    ]
    program = PAGE.split("```python\n")[1].partition("```")[0]
    assert [fault.place for fault in public.inner_uses(program, Path("a.py"), packages)] == ["a.py:3", "a.py:2"]


# Texts of reports


GERMAN = """\
language: de
texts:
  Modes: Formen
  " in {band}": in {band}
  Mods: Formen
"""


def test_missing_and_idle_words_are_found():
    faults = list(words.untranslated("de.yaml", GERMAN, ["Modes", " in {band}", "Speed"]))
    assert faults == [
        Fault("de.yaml:5", 'no words for "Speed" of a report', "add a line to this file: Speed: ..."),
        Fault(
            "de.yaml:4",
            '"in {band}" has not the spaces at its ends that " in {band}" has',
            "they join it to what is inserted before or behind",
        ),
        Fault("de.yaml:5", 'no report says "Mods"', "take the line away"),
    ]


def test_a_text_of_a_section_that_is_not_listed_is_found(tmp_path):
    source = '"""Modes."""\nx = "Speed of the shaft"\ny = f"Modes of {x}"\nz = "key"\n'
    modules = [a_module(tmp_path, f"report/{place}.py", source) for place in ("sections/modes", "other")]
    (fault,) = words.unlisted(modules, ["Modes of {name}"])
    assert fault.place == "torsionnet/report/sections/modes.py:2"
    assert "torsionnet/report/words/de.yaml" in fault.remedy


# The program


def test_faults_are_printed_and_fail(monkeypatch, capsys):
    monkeypatch.setattr(form, "form_faults", lambda: iter([Fault("a.py:1", "is wrong", "mend it")]))
    assert form.main() == 1
    assert capsys.readouterr().out == "a.py:1: is wrong; mend it\nform: 1 faults\n"
    monkeypatch.setattr(form, "form_faults", lambda: iter([]))
    assert form.main() == 0


def test_an_element_in_a_file_of_another_name_or_without_example_is_found(monkeypatch):
    monkeypatch.setattr(tn.Spring, "__module__", "torsionnet.model.elements.coil")
    monkeypatch.delitem(EVERY_ELEMENT, "spring")
    file, example = form.faults_of_elements()
    assert file.remedy == "rename the file to spring.py, or list spring in ELEMENT_TYPES under its file"
    assert example.remedy == 'add "spring": tn.Spring("e", ...)'


def test_precheck_says_what_mends_the_faults_of_ruff_and_mypy():
    lines = [
        "a.py:1:1: F401 [*] `os` imported but unused",
        "a.py:2:5: unformatted: File would be reformatted",
        "a.py:3:80: E501 Line too long (130 > 120)",
        "a.py:4:2: error: Missing return statement  [return]",
        "a.py:5: is wrong; mend it",
        "2 files would be reformatted, 7 files already formatted",
        "Found 1 error in 1 file (checked 1 source file)",
        "Success: no issues found in 1 source file",
    ]
    told = [line.rpartition("; ")[::2] for line in precheck.remedied(lines)]
    assert told == [
        ("a.py:1: F401 [*] `os` imported but unused", "make format"),
        ("a.py:2: unformatted: File would be reformatted", "make format"),
        ("a.py:3: E501 Line too long (130 > 120)", "mend it by hand"),
        ("a.py:4: Missing return statement  [return]", "give it the right type (make types says all)"),
        ("a.py:5: is wrong", "mend it"),
    ]


def test_types_are_asked_of_what_changed(tmp_path, monkeypatch):
    for number, command in enumerate((["init", "-q"], ["add", "-A"], [*AS_SOMEBODY, "commit", "-qm", "x"])):
        if number == 1:
            for name in ("old", "kept"):
                a_module(tmp_path, f"{name}.py", "x = 1\n")
        subprocess.run(["git", *command], cwd=tmp_path, check=True)
    a_module(tmp_path, "old.py", "x = 2\n")
    a_module(tmp_path, "linear/new.py", "x = 3\n")
    monkeypatch.setattr(precheck, "ROOT", tmp_path)
    assert sorted(precheck.changed_modules("HEAD")) == ["torsionnet/linear/new.py", "torsionnet/old.py"]
    assert precheck.git("merge-base", "HEAD", "@{upstream}") == "", "there is no branch to merge into"


AS_SOMEBODY = ("-c", "user.name=a", "-c", "user.email=a@example.org")
