"""Layers of the package and the floors in them, which `make lint` enforces and the documentation shows."""

from __future__ import annotations

from typing import NamedTuple


class Layer(NamedTuple):
    """Packages and modules of one layer, by their first names below ``torsionnet``."""

    names: tuple[str, ...]
    knows: str


LAYERS = (  # top to bottom
    Layer(
        ("app", "__main__"),
        "commands, the page for a browser and its server, the server of editors; nothing else prints",
    ),
    Layer(("report",), "the document on a model: what it says, and how HTML, LaTeX, Markdown and PDF write it"),
    Layer(("plot",), "pictures; nothing else imports matplotlib"),
    Layer(("study",), "many variants of a model: tolerances, maps, optima"),
    Layer(("bench",), "virtual tests run on a model, and campaigns of rotating tests with many records"),
    Layer(("identification",), "parameters from tests"),
    Layer(("io",), "files of other programs"),
    Layer(
        ("drivetrain", "extend"),
        "drivetrains out of model files; `Drivetrain`, a model that can be asked for its responses, modes and equations; what element types of others need",
    ),
    Layer(("motion",), "laws that are not linear: operating points, scenarios, motion over time"),
    Layer(("machinery",), "engines, orders, critical speeds, limits, dampers"),
    Layer(("modal",), "modes of frequency responses; no drivetrains"),
    Layer(("signals",), "records and estimates, and their files; wheels, orders of a test; no drivetrains"),
    Layer(("symbolic",), "transfer functions and equations in symbols"),
    Layer(("linear",), "rows, elimination, responses, modes, sensitivities, variants, with their results"),
    Layer(
        ("model",),
        "one model as its author wrote it, as data: `Model`; elements, checks, model files",
    ),
    Layer(("base",), "errors, units, expressions, typed entries, tables, files; nothing of the above"),
)
CORE = ("base", "model", "linear", "symbolic")
FLOORS = {  # bottom to top: the folders of a layer, "" its files that are in none
    "app": ("text", "language_server", "explore", "cli"),
    "plot": ("drawing", "schematics", "", "study"),
    "identification": ("residuals", ""),
    "study": ("space", "quantities", "reductions", "answers", "design", "", "run"),
    "symbolic": ("algebra", ""),
    "linear": ("", "assembly", "dynamic_stiffness", "modes", "responses", "sensitivity", "batch"),
    "model": ("element_base", "motion_laws", "elements"),
}
HEIGHT = {name: -depth for depth, layer in enumerate(LAYERS) for name in layer.names}
TOP = 1  # torsionnet/__init__.py offers names from every layer


def height(name: str) -> int:
    """Number of the layer of a package or module, counted from the bottom, by its first name below ``torsionnet``."""
    return HEIGHT[name] if name else TOP
