"""The files of the page, by the only paths under which they are served."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

STATIC = Path(__file__).parent / "static"
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}
INDEX = "index.html"


@dataclass(frozen=True)
class Page:
    """Content and its media type."""

    content: bytes
    media_type: str


@cache
def pages() -> dict[str, Page]:
    """Every file by its path, the first page also by the empty one. A path that is not in the table is nowhere.

    >>> sorted(path for path in pages() if path.endswith((".html", ".css")))
    ['index.html', 'style.css', 'vendor/uPlot.min.css']
    """
    files = [path for path in sorted(STATIC.rglob("*")) if path.suffix in TYPES]
    found = {path.relative_to(STATIC).as_posix(): Page(path.read_bytes(), TYPES[path.suffix]) for path in files}
    return found | {"": found[INDEX]}
