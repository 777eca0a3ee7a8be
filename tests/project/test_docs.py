"""The documentation is true: generated tables are complete, snippets load, programs run."""

import ast
import importlib
import json
import os
import re
import runpy
import shlex
import sys
from pathlib import Path

import pytest
from structure.floors import LAYERS
from support import campaigns

import torsionnet as tn
from torsionnet.app.cli import main
from torsionnet.base.entries.declared import files_beside
from torsionnet.base.units import _BASE
from torsionnet.model.damping import MEASURES
from torsionnet.model.elements import ELEMENT_TYPES, make_element
from torsionnet.model.files.located_yaml import compose
from torsionnet.study.answers.answer import ANSWERS
from torsionnet.study.quantities.quantity import QUANTITIES
from torsionnet.study.space.variations.variation import VARIATIONS

os.environ["MPLBACKEND"] = "Agg"
DOCS = Path(__file__).parents[2] / "docs"
EXAMPLES = sorted((DOCS.parent / "examples").glob("plot_*.py"))
OWN = [
    "index",
    "concepts",
    "sign_conventions",
    "model_file",
    "study_file",
    "get_started",
    "test_bench",
    "validation",
    "laws_of_motion",
]
PAGES = [DOCS / f"{name}.md" for name in OWN] + sorted((DOCS / "how_to").glob("*.md"))
PRINTED = ["characterise_a_flywheel", "fit_speed", "trust_a_fit"]
"""Pages whose blocks of text are what their programs print."""
LONG = {
    "booms_on_the_way_down",
    "compressor",
    "damper_design",
    "dmf_over_mean_torque",
    "marine",
    "studies",
    "identify_parameters",
    "identify_modes",
    "limits",
    "report",
    "trust_a_fit",
    "from_test_to_response",
}
"""Pages whose programs have long records, reports or sweeps: they run where slow tests do, as do all commands and examples."""
DEAR = {
    "booms_on_the_way_down",
    "campaign",
    "compressor",
    "dmf_over_mean_torque",
    "identify_parameters",
    "marine",
    "trust_a_fit",
}
DEAR |= {"plot_damping_choice", "plot_fit_gears", "plot_study_damper", "plot_study_yield"}
"""Pages and examples of most of the seconds: they run at night, their commands on short files in tests of these."""
DEAR_COMMANDS = {
    "torsionnet orders genset.yaml --output T_cpl",
    "torsionnet report two_stroke_ship -o ship.pdf",
}
"""They run at night, too: the modes of that plant run by day, and the same report with what was measured."""
IN_ORDER = {"ticks_to_misfire"}
"""Pages whose programs and commands need each other's files; tests of their own run them in the order of the page."""
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
SHOWN = re.compile(r"generated/(\w+\.svg)")
FILE_NAME = re.compile(r"# (\w+\.(?:yaml|csv))\n")


def blocks(page, *languages):
    return [text for language, text in FENCE.findall(page.read_text(encoding="utf-8")) if language in languages]


@pytest.fixture(scope="module")
def generate():
    sys.path.insert(0, str(DOCS))
    yield importlib.import_module("generate")
    sys.path.remove(str(DOCS))


@pytest.fixture(scope="module")
def pictures(generate, tmp_path_factory):
    """The folder with all pictures."""
    folder = tmp_path_factory.mktemp("pictures")
    generate.sign_pictures(folder)
    generate.symbol_pictures(folder)
    generate.law_pictures(folder)
    return folder


@pytest.fixture
def workplace(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


class TestGeneratedPages:
    @pytest.mark.slow
    def test_elements_page_has_every_type_and_every_entry(self, generate):
        whole = generate.elements_page()
        for kind, cls in ELEMENT_TYPES.items():
            section = generate.element_section(kind, cls)
            assert section.startswith(f"## {kind}\n")
            assert section in whole
            assert cls.sign in section
            for declared in cls.declared():
                if declared.name not in generate.COMMON:
                    assert f"| `{declared.name}` |" in section
                    assert generate.prose(declared.metadata["spec"].description) in section
            assert all(f"`{port}`" in section for port in generate.sample(cls, full=True).ports)
        page = (DOCS / "elements.md").read_text(encoding="utf-8")
        assert all(f"`{name}`" in page for name in generate.COMMON)

    @pytest.mark.parametrize("kind", ELEMENT_TYPES)
    def test_minimal_line_of_every_type_makes_that_element(self, generate, kind):
        text = re.search(r"```yaml\n(.*?)```", generate.element_section(kind, ELEMENT_TYPES[kind]), re.DOTALL)[1]
        ((name, entry),) = compose(text, "line").data["elements"].items()
        with files_beside(Path(__file__).parents[1] / "sheets"):
            assert type(make_element(entry.pop("type"), name, entry)) is ELEMENT_TYPES[kind]

    def test_laws_in_symbols(self, generate):
        gear = generate.laws(tn.Gear)
        assert r"\gamma = 0" in gear
        assert r"\left(\tau - 1\right) \theta_\mathrm{housing}" in gear
        assert r"\frac{2}{z - 1} \theta_\mathrm{sun}" in generate.laws(tn.Planetary)

    def test_every_unit_and_every_measure_of_damping_is_listed(self, generate):
        units, damping = generate.units_page(), generate.damping_page()
        assert all(f"| `{name}` |" in units for name in _BASE)
        assert all(f"| `{name}` |" in damping for name in MEASURES)

    @pytest.mark.nightly
    @pytest.mark.usefixtures("generate")
    def test_arrows_of_the_house_lead_to_all_that_is_imported_and_to_nothing_twice(self):
        import networkx

        house = importlib.import_module("house_picture")
        level = {name: depth for depth, layer in enumerate(LAYERS) for name in layer.names}
        imported = {(level[a], level[b]) for a, b in house._imports() if level[a] != level[b]}
        wanted = networkx.transitive_reduction(networkx.DiGraph(imported))
        assert set(house.arrows()) == set(wanted.edges)
        assert {(3, 5), (0, 1)} <= set(house.arrows()) < imported
        ends = [(one.first, one.last) for one in house.lanes()]
        assert sorted(ends) == sorted((a, b) for a, b in wanted.edges if b > a + 1)

    def test_traps_are_refused_with_a_message(self, generate):
        assert generate.traps_page().count("\n") == len(generate.TRAPS) + 2
        tn.loads(generate.TRAP_MODEL.format(**generate.SOUND))

    def test_deviations_from_the_paper_are_those_the_page_explains(self, generate):
        page = generate.paper_page()
        assert "| DMF | peak phase | -64 deg | -72.618 deg | -8.6 deg |" in page
        assert "| AMT II | DC gain | 0.44 deg/(N*m) | 0.41971 deg/(N*m) | -4.6 % |" in page
        assert "| AMT V | DC gain | 0.16 deg/(N*m) | 0.17406 deg/(N*m) | +8.8 % |" in page

    @pytest.mark.slow
    def test_published_values_are_met(self, generate):
        rows = re.findall(r"\| ([+-]\d\.\de[+-]\d\d) \|$", generate.cases_page(), re.MULTILINE)
        assert len(rows) >= 25
        assert max(abs(float(row)) for row in rows) < 5e-4

    @pytest.mark.slow
    def test_pictures_are_those_the_pages_show(self, pictures):
        made = {path.name for path in pictures.iterdir()}
        pages = ("sign_conventions.md", "laws_of_motion.md", "generated/elements.md")
        shown = [name for page in pages for name in SHOWN.findall((DOCS / page).read_text(encoding="utf-8"))]
        assert made == set(shown)
        assert all("<svg" in (pictures / name).read_text(encoding="utf-8") for name in made)

    def test_torques_of_a_planetary_set_are_those_of_the_picture(self):
        sun, ring, carrier = "sun", "ring", "carrier"
        rig = tn.Drivetrain(
            "torques",
            [
                tn.Planetary("set", sun=sun, ring=ring, carrier=carrier, ratio=2.5),
                tn.Inertia("J", node=sun, inertia=1),
                tn.Spring("r", nodes=(ring, "ground"), stiffness=100),
                tn.Spring("c", nodes=(carrier, "ground"), stiffness=300),
            ],
            inputs={"T": {"torque": sun}},
            sensors={f"at_{port}": {"torque": "set", "at": port} for port in (sun, ring, carrier)},
        )
        read = rig.frequency_response(["at_sun", "at_ring", "at_carrier"], "T", [0]).values.ravel()
        assert read == pytest.approx([1, -2.5, 3.5], rel=1e-12)

    @pytest.mark.slow
    def test_pictures_are_the_same_each_time(self, generate, pictures, tmp_path):
        generate.sign_pictures(tmp_path)
        generate.symbol_pictures(tmp_path)
        generate.law_pictures(tmp_path)
        first, second = ({path.name: path.read_bytes() for path in one.iterdir()} for one in (pictures, tmp_path))
        assert first == second


def test_the_architecture_names_what_there_is():
    """Every name in type of a program on the page is a file, folder, class, function or constant of the package."""
    package = DOCS.parent / "torsionnet"
    code = "\n".join(path.read_text(encoding="utf-8") for path in package.rglob("*.py"))
    code += (DOCS / "public_names.py").read_text(encoding="utf-8")
    known = {path.stem for path in package.rglob("*")} | set(re.findall(r"\b(?:class|def) (\w+)", code))
    known |= {"CHANGELOG", "CONTRIBUTING", "Figure", *re.findall(r"^([A-Z_]+)\b.* = ", code, re.MULTILINE)}
    page = (DOCS / "architecture.md").read_text(encoding="utf-8")
    page = re.sub(r"```python.*?```", "", page, flags=re.DOTALL)
    told = re.findall(r"(?<!})`([A-Za-z_]\w*(?:\.\w+)?)`", page)
    strange = [name for name in told if not set(name.removesuffix(".md").split(".")) <= known]
    assert strange == ["T_M", "T_T", "NAME_command"]  # a torque, a reading, a pattern
    assert len(told) > 40
    assert len(page.split()) <= 2500


def is_whole(text):
    return "torsionnet: 1" in text and "elements:" in text


WHOLE = [(page.stem, text) for page in PAGES for text in blocks(page, "yaml") if is_whole(text)]


@pytest.mark.parametrize(("page", "text"), WHOLE, ids=lambda value: value[:12])
def test_whole_models_load_without_a_warning(page, text, tmp_path):
    for other, block in WHOLE:
        named = FILE_NAME.match(block)
        if other == page and named:
            (tmp_path / named[1]).write_text(block, encoding="utf-8")  # a model may include others of its page
    assert [str(fault) for fault in tn.loads(text, page, tmp_path).check() if fault.severity != "note"] == []


PARTS = [text for text in blocks(DOCS / "model_file.md", "yaml") if not is_whole(text)]


@pytest.mark.parametrize("text", PARTS, ids=lambda text: text.partition(":")[0])
def test_snippets_of_the_model_file_page_fit_into_its_first_model(text):
    base = compose(blocks(DOCS / "model_file.md", "yaml")[0], "base").data
    for section, entries in compose(text, "snippet").data.items():
        base[section] = {**base.get(section, {}), **entries}
    model = tn.loads(json.dumps(base))
    for name in model.configurations:
        assert model.configured(name).configuration == name


def test_file_on_the_page_of_studies_is_one(tmp_path):
    (text,) = blocks(DOCS / "study_file.md", "yaml")
    (tmp_path / "study.yaml").write_text(text, encoding="utf-8")
    study = tn.load_study(tmp_path / "study.yaml")
    assert study.count == 600
    assert not study.findings


def test_page_of_the_study_file_has_every_type(generate):
    page = generate.study_file_page()
    for register in (VARIATIONS, QUANTITIES, ANSWERS):
        for kind, cls in register.items():
            section = page.partition(f"### {kind}\n")[2].partition("\n##")[0]
            assert all(f"| `{name}` |" in section for name, _ in cls.specs()), kind


def test_axes_of_the_model_file_page_combine():
    base = compose(blocks(DOCS / "model_file.md", "yaml")[0], "base").data
    snippet = next(text for text in PARTS if "configurations:" in text)
    for section, entries in compose(snippet, "snippet").data.items():
        base[section] = {**base.get(section, {}), **entries}
    page = (DOCS / "model_file.md").read_text(encoding="utf-8")
    assert all(f"`{name}`" in page for name in tn.loads(json.dumps(base)).configurations)


def each(paths):
    """Parametrise over pages or examples."""
    mark = {path.stem: [pytest.mark.slow] for path in paths if path.stem in LONG}
    mark |= {path.stem: [pytest.mark.nightly] for path in paths if path.stem in DEAR}
    cases = [pytest.param(path, marks=mark.get(path.stem, ()), id=path.stem) for path in paths]
    return pytest.mark.parametrize("path", cases)


def lay_out(page, folder):
    """Models and tables that a page gives a file name."""
    for text in [*blocks(page, "yaml"), *blocks(page, "csv")]:
        name = FILE_NAME.match(text)
        if name:
            (folder / name[1]).write_text(text, encoding="utf-8")


@pytest.mark.few(1)
@each([path for path in PAGES if blocks(path, "python") and path.stem not in IN_ORDER])
def test_programs_on_pages_run(path, workplace, capsys):
    lay_out(path, workplace)
    names, printed = {}, ""
    found = FENCE.findall(path.read_text(encoding="utf-8"))
    for (language, text), (following, _) in zip(found, [*found[1:], ("", "")], strict=True):
        if language == "python":
            exec(compile(text, path.name, "exec"), names)
        elif language == "sh" and following == "text" and path.stem in PRINTED:
            assert [main(shlex.split(line)[1:]) for line in command_lines(text)] == [0]
        printed += capsys.readouterr().out
    assert "Traceback" not in printed
    if path.stem in PRINTED:
        assert words("".join(blocks(path, "text"))) == words(printed)


@pytest.mark.parametrize(
    "path", [*(path for path in PAGES if path.stem in LONG), *EXAMPLES], ids=lambda path: path.stem
)
def test_long_programs_use_names_that_there_are(path):
    """A quick look at what runs only with slow tests: every name of torsionnet in it exists."""
    text = "\n".join(blocks(path, "python")) if path.suffix == ".md" else path.read_text(encoding="utf-8")
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom):
            assert all(hasattr(importlib.import_module(node.module), name.name) for name in node.names)
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "tn":
            assert hasattr(tn, node.attr)


def words(text):
    """What is left without numbers, whose last digits are a matter of the machine, and without rules and spaces."""
    return re.sub(r"-?\d[\d.]*(e[-+]?\d+)?|inf|[-\s]+", " ", text).split()


def commands(page, *, shown_with_output=True):
    """Command lines of a page; those of a page of PRINTED whose output follows run with its programs."""
    found = FENCE.findall(page.read_text(encoding="utf-8"))
    following = [*(language for language, _ in found[1:]), ""]
    texts = [
        text
        for (language, text), then in zip(found, following, strict=False)
        if language == "sh" and (shown_with_output or then != "text")
    ]
    return [line for text in texts for line in command_lines(text)]


def command_lines(text):
    lines = [line.partition("#")[0].strip() for line in text.replace("\\\n", " ").splitlines()]
    return [line for line in lines if line.startswith("torsionnet ")]


OWN_RECORDS = {"angle_from_pulses", "calibrate_wheel", "damping_from_run_up", "fit_orders", "track_orders"}
"""Pages whose commands read records that readers bring; the page on campaigns has the same commands with its own."""


@pytest.mark.slow
@each([path for path in PAGES if commands(path) and path.stem not in OWN_RECORDS | IN_ORDER])
def test_commands_on_pages_work_one_after_the_other(path, workplace, capsys):
    lay_out(path, workplace)
    for line in commands(path, shown_with_output=path.stem not in PRINTED):
        if line in DEAR_COMMANDS and not campaigns.many:
            continue
        code = main(shlex.split(line)[1:])
        incomplete = 6 if " limits " in line else 0  # pages may examine some of the configurations of a model
        assert code in (0, incomplete), (line, capsys.readouterr())


@pytest.mark.parametrize("path", [path for path in PAGES if commands(path)], ids=lambda path: path.stem)
def test_commands_have_options_that_there_are(path, capsys):
    """A quick look here, too."""
    for line in commands(path):
        _, command, *rest = shlex.split(line)
        assert main([command, "--help"]) == 0
        known = re.findall(r"(?<![\w-])--?[a-z][\w-]*", capsys.readouterr().out)
        assert {word for word in rest if re.match("--?[a-z]", word)} <= set(known)


def test_message_on_the_page_about_bad_input_is_the_real_one():
    page = DOCS / "how_to" / "bad_input.md"
    text = re.search(r'text = """(.*?)"""', blocks(page, "python")[0], re.DOTALL)[1]
    with pytest.raises(tn.ModelError) as caught:
        tn.loads(text, "model.yaml")
    assert str(caught.value) == blocks(page, "text")[0].rstrip("\n")


def test_broken_links_are_found(tmp_path):
    links = runpy.run_path(str(DOCS / "check_links.py"))
    (tmp_path / "sub").mkdir()
    (tmp_path / "a.html").write_text(
        '<a id="top" href="sub/b.html#here">b</a><a href="#top">t</a><img src="https://x/y.png">'
    )
    (tmp_path / "sub" / "b.html").write_text('<p id="there"></p><a href="../c.html">c</a><a href="https://x">x</a>')
    assert list(links["broken_links"](tmp_path)) == [
        "a.html: sub/b.html#here names a place that is not there",
        "a.html: https://x/y.png is loaded from elsewhere",
        "sub/b.html: there is no ../c.html",
    ]


@pytest.mark.usefixtures("generate")
def test_what_options_take_and_their_defaults_are_promised():
    import public_names

    stored = public_names.SIGNATURES.read_text(encoding="utf-8").splitlines()
    assert public_names.option_lines() == [line for line in stored if line.startswith("torsionnet ")]


@pytest.mark.usefixtures("generate")
def test_every_public_name_has_a_page_and_a_line_in_the_index(tmp_path):
    import public_names
    import reference_pages

    index = reference_pages.reference_index()
    reference_pages.write_reference(tmp_path)
    for page, one in reference_pages.page_names().items():
        assert f"(reference/{page}.md)" in index
        assert f'<span id="{one.name}"></span>' in index, "old links lead to it"
        assert f":: {one.name}\n" in (tmp_path / f"{page}.md").read_text(encoding="utf-8")
        if one.is_class or callable(one.value):
            assert one.summary, one.name
    assert len(list(tmp_path.iterdir())) == len(public_names.public_names())
    assert max(path.stat().st_size for path in tmp_path.iterdir()) < 20_000
    names = {path.name.casefold() for path in tmp_path.iterdir()}
    assert len(names) == len(list(tmp_path.iterdir())), "on Windows and macOS Recording and recording are one file"


def test_the_page_of_elements_begins_with_all_types(generate):
    assert "generated/element_index.md" in (DOCS / "elements.md").read_text(encoding="utf-8")
    named = re.findall(r"\[(\w+)\]\(#(\w+)\)", generate.element_index())
    assert sorted(named) == sorted((kind, kind) for kind in ELEMENT_TYPES)


def test_there_is_a_gallery():
    assert len(EXAMPLES) >= 6


@pytest.mark.few(0, 6)
@each(EXAMPLES)
def test_example_draws(path, workplace, capsys):
    """By day some: to build the pages runs all of them."""
    import matplotlib as mpl
    import matplotlib.pyplot as plt
    from matplotlib.figure import Figure

    with mpl.rc_context():
        names = runpy.run_path(str(path))
        figures = [value for value in names.values() if isinstance(value, Figure)]
        assert figures
        for number, figure in enumerate(figures):
            figure.savefig(workplace / f"{number}.png")
    plt.close("all")
    capsys.readouterr()
