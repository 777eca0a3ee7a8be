"""Writing of a report as PDF: its HTML page, printed by a browser."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from torsionnet.base.atomic import write_bytes
from torsionnet.base.errors import MissingExtraError, SolveError
from torsionnet.report.document_tree import Report
from torsionnet.report.writers.html import html_page

BROWSER_TIMEOUT = 120
"""Seconds that the browser may take to print a report."""
IDLE_SERVICES = (
    "--disable-extensions",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-default-apps",
    "--disable-breakpad",
    "--disable-crash-reporter",
    "--disable-software-rasterizer",
    "--disable-features=Translate,OptimizationHints,MediaRouter",
    "--metrics-recording-only",
    "--no-default-browser-check",
)
"""Options that switch off what a browser starts for browsing: printing one page then takes a fifth less of the
processor."""
_DATE = re.compile(rb"/(CreationDate|ModDate) \(D:\d{14}")
_FIXED = b"20000101000000"


BROWSER_ENV = "TORSIONNET_BROWSER"
"""Environment variable that names the browser's program file."""
BROWSER_COMMANDS = (
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
"""Names of browser commands that are looked for on the search path."""
MAC_BROWSERS = (
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    "/Applications/Microsoft Edge.app/Contents/MacOS/Microsoft Edge",
)
"""Paths of browsers' program files on Macs."""
WINDOWS_BROWSERS = (
    r"Google\Chrome\Application\chrome.exe",
    r"Chromium\Application\chrome.exe",
    r"Microsoft\Edge\Application\msedge.exe",
)
"""Paths of browsers' program files below the program folders of Windows."""
WINDOWS_FOLDER_VARIABLES = ("PROGRAMFILES", "PROGRAMFILES(X86)", "LOCALAPPDATA")
"""Environment variables that name the program folders of Windows."""


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Print the page of a report into a PDF file and return its path."""
    browser = find_browser()
    with tempfile.TemporaryDirectory(prefix="torsionnet-") as folder:
        page, printed = Path(folder, "report.html"), Path(folder, "report.pdf")
        page.write_text(html_page(report, folds=False), encoding="utf-8")
        _print(browser, page, printed)
        write_bytes(path, undated(printed.read_bytes()))
    return (path,)


def _print(browser: str, page: Path, printed: Path) -> None:
    command = [
        browser,
        "--headless",
        "--disable-gpu",
        "--no-first-run",
        *IDLE_SERVICES,
        f"--user-data-dir={page.parent / 'profile'}",
        "--no-pdf-header-footer",
        f"--print-to-pdf={printed}",
        *(["--no-sandbox"] if _is_root() else []),
        page.as_uri(),
    ]
    try:
        done = subprocess.run(command, capture_output=True, timeout=BROWSER_TIMEOUT, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise _failed(browser, str(error)) from None
    if not printed.is_file() or not printed.stat().st_size:
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        raise _failed(browser, lines[-1] if lines else f"exit code {done.returncode}")


def _is_root() -> bool:
    """Whether the program runs as root, as in containers, where Chromium's sandbox refuses to run."""
    return hasattr(os, "geteuid") and os.geteuid() == 0


def _failed(browser: str, reason: str) -> SolveError:
    return SolveError(
        f"{browser} did not print the report: {reason}; write -o report.html and print that", kind="failed-program"
    )


def undated(data: bytes) -> bytes:
    """Bytes of a pdf file without the time of its printing, as many as before.

    >>> undated(b"/CreationDate (D:20250331120000+00'00')")
    b"/CreationDate (D:20000101000000+00'00')"
    """
    return _DATE.sub(lambda match: b"/" + match[1] + b" (D:" + _FIXED, data)


def find_browser() -> str:
    """Path of the browser's program file.

    Raises
    ------
    MissingExtraError
        There is none.
    """
    given = os.environ.get(BROWSER_ENV)
    if given:
        program = shutil.which(given) or (given if Path(given).is_file() else None)
        if program is None:
            raise MissingExtraError(
                f'{BROWSER_ENV} names "{given}", which is no program; name the program file of Chromium, Chrome or Edge'
            )
        return program
    for path in _candidates():
        program = shutil.which(path)
        if program:
            return program
    raise MissingExtraError(
        "a PDF is printed by a browser, and there is neither Chromium nor Chrome nor Edge: install one, name its "
        f"program in the environment variable {BROWSER_ENV}, or write -o report.html and print that from any browser"
    )


def _candidates() -> Iterator[str]:
    yield from BROWSER_COMMANDS
    if sys.platform == "darwin":
        yield from MAC_BROWSERS
    for folder in WINDOWS_FOLDER_VARIABLES:
        base = os.environ.get(folder)
        if base:
            yield from (str(Path(base) / program) for program in WINDOWS_BROWSERS)
