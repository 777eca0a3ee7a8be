"""Draw docs/images/tutorial_*_report.png: the top of the reports with which the tutorials end, in headless Chromium.

``python docs/tutorial_report_pictures.py`` needs an installed Chromium, Chrome or Edge.
"""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

import tutorial_steps

from torsionnet.report.writers.pdf import find_browser

SIZE = "900,1000"
"""Width and height of the window in pixels: the width that the page has on A4 about, and what a reader sees first."""
OPTIONS = ("--headless", "--no-sandbox", "--hide-scrollbars", "--disable-gpu", f"--window-size={SIZE}")


def dated(text: str) -> str:
    """Command with the report as HTML of a fixed date, so that the picture stays the same."""
    return tutorial_steps.as_html(text).replace("torsionnet report", "torsionnet report --date 2025-03-31")


def draw(page: Path, folder: Path) -> None:
    """Run a tutorial in a folder with its report as HTML, and draw the top of the report."""
    for done in tutorial_steps.run(page, folder, changed=dated):
        if done.code not in (0, 1, 6):
            raise RuntimeError(f"{done.typed.line}\n{done.text}")
    (report,) = folder.glob("*.html")
    picture = tutorial_steps.DOCS / "images" / f"{page.stem}_report.png"
    subprocess.run([find_browser(), *OPTIONS, f"--screenshot={picture}", report.as_uri()], check=True)


if __name__ == "__main__":
    for path in tutorial_steps.TUTORIALS:
        with tempfile.TemporaryDirectory() as name:
            draw(path, Path(name))
