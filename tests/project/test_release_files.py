"""What a release carries beside the package says the same as pyproject.toml, and refuses to go out with an address that leads nowhere."""

import json
import re
import tomllib
from pathlib import Path

import pytest
import yaml
from release.codemeta import codemeta
from release.dockerfile import NEEDS_A_CONTAINER, let_in, stages
from release.project import PLACEHOLDER, all_lower_bounds, lower_bounds, project, unpublishable
from release.recipe import conda_requirements, rendered

import torsionnet as tn

ROOT = Path(__file__).parents[2]
ABOUT = project()


def text_of(name):
    return (ROOT / name).read_text(encoding="utf-8")


CITATION = yaml.safe_load(text_of("CITATION.cff"))
RECIPE = yaml.safe_load(text_of("recipe/recipe.yaml"))


def test_one_version_everywhere():
    newest_entry = re.search(r"^## \[(.+?)\]", text_of("CHANGELOG.md"), re.MULTILINE)[1]
    said = {
        "pyproject.toml": ABOUT["version"],
        "CITATION.cff": CITATION["version"],
        "codemeta.json": json.loads(text_of("codemeta.json"))["version"],
        "recipe.yaml": RECIPE["context"]["version"],
        "CHANGELOG.md": newest_entry,
    }
    assert said == dict.fromkeys(said, tn.__version__)


def test_every_extra_is_in_all_with_its_bounds():
    extras = dict(ABOUT["optional-dependencies"])
    assert sorted(extras.pop("all")) == sorted(line for lines in extras.values() for line in lines)


def test_readme_of_the_index_has_no_link_into_a_checkout():
    links = re.findall(r"""(?:\]\(|src=")([^)"]+)""", ABOUT["readme"]["text"])
    assert f"{ABOUT['urls']['Repository']}/raw/v{tn.__version__}/docs/images/report.png" in links
    assert all(link.startswith("https://") for link in links)
    inside = [path for link in links for path in re.findall(r"/(?:raw|blob)/v[\d.]+/(.+)", link)]
    assert len(inside) >= 10
    assert all((ROOT / path).exists() for path in inside)


def test_codemeta_is_current():
    assert text_of("codemeta.json") == codemeta(ABOUT)


def test_citation_says_what_pyproject_says():
    urls = ABOUT["urls"]
    assert (CITATION["title"], CITATION["abstract"].strip()) == (ABOUT["name"], ABOUT["description"])
    assert (CITATION["license"], CITATION["keywords"]) == (ABOUT["license"], ABOUT["keywords"])
    assert (CITATION["url"], CITATION["repository-code"]) == (urls["Homepage"], urls["Repository"])
    assert [author["name"] for author in CITATION["authors"]] == [author["name"] for author in ABOUT["authors"]]


def test_recipe_says_what_pyproject_says():
    about, urls = RECIPE["about"], ABOUT["urls"]
    assert RECIPE["requirements"]["run"] == conda_requirements(ABOUT)
    build = tomllib.loads(text_of("pyproject.toml"))["build-system"]["requires"]
    assert RECIPE["requirements"]["host"] == [
        f"python {ABOUT['requires-python']}", "pip", *(line.replace("==", " ==") for line in build),
    ]  # fmt: skip
    assert (about["license"], about["license_file"], about["summary"].strip()) == (
        ABOUT["license"], ABOUT["license-files"], ABOUT["description"],
    )  # fmt: skip
    addresses = (about["homepage"], about["repository"], about["documentation"])
    assert addresses == (urls["Homepage"], urls["Repository"], urls["Documentation"])
    assert RECIPE["build"]["python"]["entry_points"] == [f"{name} = {what}" for name, what in ABOUT["scripts"].items()]


def test_rattler_build_renders_the_recipe():
    pytest.importorskip("rattler_build", reason="py-rattler-build is in the group release")
    recipe = rendered()
    assert recipe["package"] == {"name": ABOUT["name"], "version": ABOUT["version"]}
    assert recipe["requirements"]["run"] == conda_requirements(ABOUT)


def test_an_address_that_leads_nowhere_or_another_tag_is_not_published():
    there = {**ABOUT, "urls": {"Homepage": "https://torsionnet.org", "Issues": "https://host.example.org/issues"}}
    assert unpublishable(there, f"v{ABOUT['version']}") == []
    (reason,) = unpublishable({**there, "urls": {"Homepage": "https://torsionnet.example"}})
    assert "Homepage" in reason
    (reason,) = unpublishable(there, "v0.9")
    assert f"tag v{ABOUT['version']}" in reason


def test_every_placeholder_is_an_address_of_pyproject():
    known = {ABOUT["urls"]["Homepage"], *ABOUT["urls"].values()}
    for name in ("CITATION.cff", "codemeta.json", "recipe/recipe.yaml", "Dockerfile"):
        assert set(PLACEHOLDER.findall(text_of(name))) <= known, name


def test_versions_of_python_are_those_tested():
    tail = "Programming Language :: Python :: 3."
    classified = {
        line.removeprefix("Programming Language :: Python :: ") for line in ABOUT["classifiers"] if tail in line
    }
    workflow = yaml.safe_load(text_of(".github/workflows/tests.yml"))
    assert set(workflow["jobs"]["versions"]["strategy"]["matrix"]["python"]) == classified
    assert ABOUT["requires-python"] == f">={min(classified, key=lambda version: int(version.split('.')[1]))}"


def test_constraints_of_the_oldest_packages_are_the_lower_bounds():
    lines = [line for line in text_of("tests/oldest.txt").splitlines() if line and not line.startswith("#")]
    pinned = dict(line.split("==") for line in lines)
    bounds = all_lower_bounds(ABOUT)
    assert {name: pinned.get(name) for name in bounds} == bounds


def test_a_bound_of_another_form_is_refused():
    assert lower_bounds(["numpy>=2.0"]) == {"numpy": "2.0"}
    with pytest.raises(ValueError, match=r"numpy<3 should be NAME>=VERSION"):
        lower_bounds(["numpy<3"])


def test_the_image_runs_as_a_user_and_gets_only_what_the_wheel_needs():
    *_, last = stages(text_of("Dockerfile"))
    steps = dict(last.steps)
    assert steps["USER"] not in ("root", "0")
    assert steps["ENTRYPOINT"] == '["torsionnet"]'
    assert all("slim" in stage.image for stage in stages(text_of("Dockerfile")))
    assert all((ROOT / name).exists() for name in let_in(text_of(".dockerignore")))


def test_most_steps_of_the_image_are_run_without_a_container():
    steps = [rest for stage in stages(text_of("Dockerfile")) for word, rest in stage.steps if word == "RUN"]
    left_out = [rest for rest in steps if rest.split()[0] in NEEDS_A_CONTAINER]
    assert (len(left_out), len(steps)) == (1, 5)
    with pytest.raises(ValueError, match="the word HEALTHCHECK"):
        stages("FROM python:3.13-slim\nHEALTHCHECK NONE\n")


def test_published_documentation_lists_its_versions_newest_first(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    from version_list import version_list

    for name in ("1.2.0", "1.10.0", "stable", "1.9.3"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "index.html").touch()
    (tmp_path / "unfinished").mkdir()
    assert re.findall(r">([\w.]+)</a>", version_list(tmp_path)) == ["stable", "1.10.0", "1.9.3", "1.2.0"]
