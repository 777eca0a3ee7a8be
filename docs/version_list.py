"""Write the page that leads to every published version of the documentation: ``python docs/version_list.py FOLDER``."""

import html
import sys
from pathlib import Path

PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>torsionnet: documentation by version</title>
<h1>torsionnet: documentation by version</h1>
<ul>
{rows}
</ul>
</html>
"""


def rank(name):
    """Key of a version's folder; the latest comes last, and names that are no versions before all of them."""
    return [int(part) if part.isdigit() else -1 for part in name.split(".")]


def version_list(folder):
    """HTML of the page: "stable" first, then the versions from the newest to the oldest."""
    names = {path.parent.name for path in Path(folder).glob("*/index.html")}
    newest_first = sorted(names - {"stable"}, key=rank, reverse=True)
    shown = [html.escape(name) for name in ["stable"] * ("stable" in names) + newest_first]
    return PAGE.format(rows="\n".join(f'<li><a href="{name}/index.html">{name}</a></li>' for name in shown))


if __name__ == "__main__":
    (Path(sys.argv[1]) / "index.html").write_text(version_list(sys.argv[1]), encoding="utf-8")
