"""The conda recipe, rendered as rattler-build does it, without a channel: nothing is looked up or solved."""

from __future__ import annotations

from typing import Any

from release.project import ROOT

CONDA_NAMES = {"matplotlib": "matplotlib-base"}  # conda-forge's matplotlib brings a graphical user interface along


def rendered(path: Any = ROOT / "recipe" / "recipe.yaml") -> dict[str, Any]:
    """Recipe of the only package that the file describes, with its variables filled in."""
    from rattler_build import Stage0Recipe

    (variant,) = Stage0Recipe.from_file(path).render()
    return variant.recipe.to_dict()


def conda_requirements(about: dict[str, Any]) -> list[str]:
    """Requirements of the package as a recipe writes them: lower-case names of conda-forge, a space before the bound."""
    from release.project import lower_bounds

    bounds = {name.lower(): version for name, version in lower_bounds(about["dependencies"]).items()}
    return [f"python {about['requires-python']}"] + [
        f"{CONDA_NAMES.get(name, name)} >={version}" for name, version in bounds.items()
    ]
