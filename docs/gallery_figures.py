"""Scraper with which sphinx-gallery finds figures that belong to no pyplot window, as torsionnet.plot returns them."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst


def scrape(_: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save every new figure among the variables of an example, and return the reStructuredText that shows them."""
    import matplotlib.pyplot as plt

    for number in plt.get_fignums():
        plt.figure(number).is_in_gallery = True
    found = [value for value in block_vars["example_globals"].values() if isinstance(value, Figure)]
    paths = []
    for figure in found:
        if getattr(figure, "is_in_gallery", False):
            continue
        path = next(block_vars["image_path_iterator"])
        figure.savefig(path, dpi=150)
        figure.is_in_gallery = True
        paths.append(path)
    return figure_rst(paths, gallery_conf["src_dir"])


def _get_sg_image_scraper() -> Any:
    return scrape
