"""Layers of the package and the floors in them, which `make lint` enforces and the documentation shows."""

from __future__ import annotations

from typing import NamedTuple


class Layer(NamedTuple):
    """Packages and modules of one layer, by their first names below ``torsionnet``."""

    names: tuple[str, ...]
    knows: str


LAYERS = (  # top to bottom
    Layer(("demo", "cli", "__main__"), "the terminal; nothing else prints"),
    Layer(
        ("explore", "language_server"),
        "the page for a browser, its server, and what they ask of one model; the server of editors",
    ),
    Layer(("report",), "the document on a model: what it says, and how HTML, LaTeX, Markdown and PDF write it"),
    Layer(("plot",), "pictures; nothing else imports matplotlib"),
    Layer(("campaign",), "rotating tests with many records: orders, repeatability and fits from one file"),
    Layer(
        ("bench", "identification", "study"),
        "virtual tests run on a model; parameters from tests; many variants of a model",
    ),
    Layer(("io",), "files of records, of responses and of other programs"),
    Layer(
        ("loading", "drivetrain"),
        "drivetrains out of model files; `Drivetrain`, a model that can be asked for its responses, modes and equations",
    ),
    Layer(("text",), "services on texts of model files while they are written; no numbers of results"),
    Layer(("symbolic",), "transfer functions and equations in symbols"),
    Layer(("solve",), "frequency responses, modes, motion over time, and their derivatives"),
    Layer(("assembly",), "coordinates, rows and their coefficients: `AssembledModel`"),
    Layer(
        ("model",),
        "one model as its author wrote it, as data: `Model`; elements, checks, model files, descriptions of benches, "
        "reports and fits",
    ),
    Layer(("modal",), "modes of frequency responses; no drivetrains"),
    Layer(("signals",), "arrays over time; no drivetrains, no files"),
    Layer(("response",), "results: responses, modes, recordings, tables"),
    Layer(("core",), "errors, units, expressions, typed entries, files written as a whole; nothing of the above"),
)
FLOORS = {  # bottom to top: the folders of a layer, "" its files that are in none
    "cli": ("", "commands"),
    "plot": ("drawing", "schematic", "", "study"),
    "identification": ("residuals", ""),
    "study": ("space", "quantities", "reductions", "answers", "design", "", "run"),
    "symbolic": ("algebra", ""),
    "solve": ("dynamic_stiffness", "modes", "responses", "sensitivity", "batch", "running", "motion", "design"),
    "model": ("element_base", "motion_laws", "elements"),
}
HEIGHT = {name: -depth for depth, layer in enumerate(LAYERS) for name in layer.names}
TOP = 1  # torsionnet/__init__.py offers names from every layer


def height(name: str) -> int:
    """Number of the layer of a package or module, counted from the bottom, by its first name below ``torsionnet``."""
    return HEIGHT[name] if name else TOP
