"""The browser that prints: Chromium, Chrome or Edge, wherever it is installed."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

from torsionnet.core.errors import MissingExtraError

VARIABLE = "TORSIONNET_BROWSER"
COMMANDS = (
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
    "microsoft-edge",
    "microsoft-edge-stable",
    "msedge",
    "brave-browser",
)
MAC = (
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    "/Applications/Microsoft Edge.app/Contents/MacOS/Microsoft Edge",
)
WINDOWS = (
    r"Google\Chrome\Application\chrome.exe",
    r"Chromium\Application\chrome.exe",
    r"Microsoft\Edge\Application\msedge.exe",
)
FOLDERS = ("PROGRAMFILES", "PROGRAMFILES(X86)", "LOCALAPPDATA")


def find_browser() -> str:
    """Path of the program.

    Raises
    ------
    MissingExtraError
        There is none.
    """
    given = os.environ.get(VARIABLE)
    if given:
        found = shutil.which(given) or (given if Path(given).is_file() else None)
        if found is None:
            raise MissingExtraError(
                f'{VARIABLE} names "{given}", which is no program; name the program file of Chromium, Chrome or Edge'
            )
        return found
    for path in _candidates():
        found = shutil.which(path)
        if found:
            return found
    raise MissingExtraError(
        "a PDF is printed by a browser, and there is neither Chromium nor Chrome nor Edge: install one, name its "
        f"program in the environment variable {VARIABLE}, or write -o report.html and print that from any browser"
    )


def _candidates() -> Iterator[str]:
    yield from COMMANDS
    if sys.platform == "darwin":
        yield from MAC
    for folder in FOLDERS:
        base = os.environ.get(folder)
        if base:
            yield from (str(Path(base) / program) for program in WINDOWS)
