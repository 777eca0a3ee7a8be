"""What sphinx-gallery does not know of examples: figures that belong to no pyplot window, and what they depend on."""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

from made_files import OBSERVED, ROOT, digest_of_all
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


# An example is run again where its script has changed, as sphinx-gallery does, or anything that it was made from

RECORD = ROOT / ".cache" / "gallery.json"


def forget_stale() -> None:
    """Let examples run again whose modules, files or packages have changed since they ran."""
    sys.addaudithook(OBSERVED.note)
    known = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    for ran in (ROOT / "docs" / "gallery").glob("*.py.md5"):
        one = known.get(ran.name.partition(".")[0])
        if one is None or digest_of_all(one["from"]) != one["digest"]:
            ran.unlink()


def observe(_conf: Any, script: str | None, when: str) -> None:
    """Record what an example was made from; modules that those before it imported count as well."""
    if script is None:
        return
    if when == "before":
        OBSERVED.paths.clear()
        OBSERVED.started, OBSERVED.began = False, time.time()
        return
    known = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    names = OBSERVED.all_paths()
    known[Path(script).stem] = {"from": names, "digest": digest_of_all(names, OBSERVED.began)}
    RECORD.parent.mkdir(exist_ok=True)
    RECORD.write_text(json.dumps(known), encoding="utf-8")
