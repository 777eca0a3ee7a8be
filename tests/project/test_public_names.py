"""What a program may use by name: the same when it runs, in ``dir()``, for ``import *`` and for type checkers."""

import ast
import importlib
import inspect
import pkgutil
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.packages import TABLES
from torsionnet.model.elements import Element, element_classes

ROOT = Path(__file__).parents[2]
MISTAKES = Path(__file__).parents[1] / "user_types" / "mistakes.py"
PACKAGES = [
    *(
        tn.bench,
        tn.extend,
        tn.identification,
        tn.io,
        tn.modal,
        tn.plot,
        tn.report,
        tn.machinery,
        tn.motion,
        tn.sensitivity,
        tn.signals,
    ),
    tn.study,
]
OFFERED_MODULES = {*(package.__name__ for package in PACKAGES), "torsionnet.base.units"}
named = pytest.mark.parametrize("package", [tn, *PACKAGES], ids=lambda package: package.__name__)


def stub_of(package):
    return ast.parse(Path(package.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))


@named
def test_type_checkers_see_the_names_that_there_are(package):
    """The stub, read by itself: every import ``as`` its name, and ``__all__``."""
    said = {}
    for node in stub_of(package).body:
        if isinstance(node, ast.ImportFrom):
            said |= {alias.asname: (node.module, alias.name) for alias in node.names if alias.asname == alias.name}
    (listed,) = (ast.literal_eval(node.value) for node in stub_of(package).body if isinstance(node, ast.Assign))
    assert sorted(said) == sorted(listed) == sorted(package.__all__)
    for name, (module, inside) in said.items():
        if module == "torsionnet.model.elements.element_types":
            found = element_classes()[inside]
        else:
            stubbed = module == "torsionnet.entry_classes"
            home = importlib.import_module(behind_the_stub()[f"_{inside}"] if stubbed else module)
            found = getattr(home, inside) if hasattr(home, inside) else importlib.import_module(f"{module}.{inside}")
        assert getattr(package, name) is found


def behind_the_stub():
    """Of every class in ``entry_classes.pyi`` the module that it inherits from, by the name it has there."""
    tree = ast.parse((Path(tn.__file__).parent / "entry_classes.pyi").read_text(encoding="utf-8"))
    imports = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    return {alias.asname: node.module for node in imports for alias in node.names if alias.asname}


@named
def test_dir_and_star_have_public_names_only(package):
    assert dir(package) == sorted(package.__all__)
    names = {}
    exec(f"from {package.__name__} import *", names)
    names.pop("__builtins__")
    assert sorted(names) == dir(package)
    modules = [value for value in names.values() if isinstance(value, ModuleType)]
    assert {one.__name__ for one in modules} == (OFFERED_MODULES if package is tn else set())


def test_names_of_units():
    assert dir(tn.units) == sorted(tn.units.__all__)
    assert "convert" in dir(tn.units)


@pytest.mark.parametrize("package", PACKAGES, ids=lambda package: package.__name__)
def test_a_module_never_takes_the_place_of_a_name(package):
    """Importing ``torsionnet.plot.bode`` binds the module to ``plot.bode``, unless that was imported before."""
    names = [*package.__all__]
    for module in pkgutil.iter_modules(getattr(package, "__path__", ()), f"{package.__name__}."):
        importlib.import_module(module.name)
    assert not [name for name in names if isinstance(getattr(package, name), ModuleType)]


@pytest.mark.slow
def test_no_public_name_is_that_of_a_module_beside_it():
    """Whoever imported the module plot.bode would find it in the place of the function plot.bode."""
    for package in (name for name in TABLES["torsionnet"].values() if ":" not in name):
        module = importlib.import_module(package)
        files = {one.name for one in pkgutil.iter_modules(getattr(module, "__path__", ()))}
        assert files.isdisjoint(name for name, place in TABLES.get(package, {}).items() if ":" in place), package


@named
def test_no_other_names_are_invented(package):
    with pytest.raises(AttributeError, match=f"{package.__name__}.*nothing_there"):
        getattr(package, "nothing_there")  # noqa: B009


def test_names_that_there_were_before_the_first_version_are_gone():
    for name in ("document", "interchange"):
        assert not hasattr(tn, name)
    assert not hasattr(tn.report, "bode")


def test_records_are_read_by_either_name():
    for name in ("iter_blocks", "read_recording", "write_recording"):
        assert getattr(tn.signals, name) is getattr(tn.io, name)


# Signatures of element types


def initialisers():
    tree = ast.parse(
        (Path(tn.__file__).parent / "model" / "elements" / "element_types.pyi").read_text(encoding="utf-8")
    )
    for declared in tree.body:
        if isinstance(declared, ast.ClassDef):
            yield declared.name, [one for one in declared.body if isinstance(one, ast.FunctionDef)]


def test_every_element_type_has_a_signature():
    assert {name for name, _ in initialisers()} == set(element_classes())


@pytest.mark.parametrize(("name", "found"), [*initialisers()], ids=lambda one: one if isinstance(one, str) else "")
def test_signatures_are_those_of_the_program(name, found):
    """Names, order, what is required and what is by name only, from the stub as a text."""
    arguments = found[0].args
    required = len(arguments.args) - len(arguments.defaults)
    said = [(one.arg, "either", place < required) for place, one in enumerate(arguments.args)][1:]
    said += [
        (one.arg, "name", default is None)
        for one, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
    ]
    there = inspect.signature(getattr(tn, name)).parameters.values()
    kinds = {inspect.Parameter.POSITIONAL_OR_KEYWORD: "either", inspect.Parameter.KEYWORD_ONLY: "name"}
    assert said == [(one.name, kinds[one.kind], one.default is one.empty) for one in there]
    annotations = [ast.unparse(one.annotation) for one in (*arguments.args[1:], *arguments.kwonlyargs)]
    assert not {"object", "Any"} & {*annotations}


def test_what_a_kind_of_value_accepts_is_told():
    clearance = dict(initialisers())["Clearance"]
    told = {one.arg: ast.unparse(one.annotation) for one in clearance[0].args.args[1:]}
    assert (told["name"], told["nodes"], told["stiffness"]) == ("str", "TwoNames", "Scalar")
    spring = dict(initialisers())["Spring"]  # its stages may stand in place of the stiffness
    for form in spring:
        told = {one.arg: ast.unparse(one.annotation) for one in form.args.args[1:]}
        assert (told["nodes"], told["stiffness"]) == ("TwoNames", "Scalar | None")
    clutch = dict(initialisers())["Clutch"][0].args.args
    assert [ast.unparse(one.annotation) for one in clutch if one.arg == "state"] == [
        "Literal['closed', 'open', 'slipping']"
    ]


def test_the_program_of_a_user_is_right(tmp_path):
    """``make types`` lets type checkers look at it; what they pass has to run."""
    table = tmp_path / "couplings.csv"
    table.write_text("size,stiffness [N*m/rad],loss_factor\nA350,5e4,0.1\n", encoding="utf-8")
    from user_types import rig

    elements = rig.others(table)
    assert elements["maker"].stiffness.value == 50_000
    shaft = rig.driveline(3000, [0.2, 0.3])
    own = np.sqrt(3000 * (1 / 0.078 + (207 / 50) ** 2 / 0.5)) / (2 * np.pi)
    assert rig.first_frequency(shaft) == pytest.approx(0, abs=1e-9)
    assert shaft.modes().natural_frequencies[1] == pytest.approx(own, rel=1e-9)


def test_mistakes_fail_when_they_run():
    lines = MISTAKES.read_text(encoding="utf-8").splitlines()
    found = [line for line in lines if "# wrong" in line and not line.startswith("from")]
    assert len(found) > 20
    for line in lines:
        if "# wrong" in line:
            with pytest.raises((tn.TorsionnetError, TypeError, AttributeError, ImportError)):
                exec(line, {"tn": tn})


def test_elements_of_users_need_no_signature():
    """Whoever writes a kind of value of his own says nothing of it to type checkers."""
    from torsionnet.base.entries.spec import Spec

    assert Spec("anything").accepted == "object"
    assert issubclass(tn.Spring, Element)
