"""Let pyright and ``mypy --strict`` look at the package as its users have it; ends with exit code 1 where they should not.

Examples, the programs of every page and of a user (``rig.py``) have no fault; in ``mistakes.py`` each line that ends in
``# wrong`` has one for both of them, and no other line. Of the types of all public symbols COMPLETE or more are known.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).parent
COMPLETE = 0.95
MARK = "# wrong"
INSIDE = {"architecture"}
"""Pages whose Python is a piece of the package."""

Fault = tuple[str, int, str]
"""File name, line, message."""


def main() -> int:
    with tempfile.TemporaryDirectory() as folder:
        pages = programs_of_pages(Path(folder))
        right = [*pages, *sorted((ROOT / "examples").glob("*.py")), HERE / "rig.py"]
        wrong = HERE / "mistakes.py"
        marked = {number for number, line in enumerate(wrong.read_text("utf-8").splitlines(), 1) if MARK in line}
        bad = False
        for name, check in (("mypy --strict", mypy), ("pyright", pyright)):
            faults = check([*right, wrong])
            unwanted = [fault for fault in faults if fault[0] != wrong.name]
            found = {line for file, line, _ in faults if file == wrong.name}
            for file, line, message in unwanted:
                print(f"{name}: {file}:{line}: {message}")
            for line in sorted(marked ^ found):
                print(
                    f"{name}: {wrong.name}:{line} {'is wrong and passes' if line in marked else 'is right and fails'}"
                )
            print(
                f"{name}: {len(right)} programs, {len(unwanted)} faults; {len(marked & found)} of {len(marked)} mistakes found"
            )
            bad |= bool(unwanted or marked ^ found)
    share = completeness()
    print(
        f"pyright --verifytypes: {100 * share:.2f} % of the types of public symbols are known, {100 * COMPLETE:g} % wanted"
    )
    return int(bad or share < COMPLETE)


def programs_of_pages(folder: Path) -> list[Path]:
    """The Python of each page as one program."""
    found = []
    for page in (
        ROOT / "README.md",
        *sorted((ROOT / "docs").glob("*.md")),
        *sorted((ROOT / "docs/how_to").glob("*.md")),
    ):
        blocks = re.findall(r"^```python\n(.*?)^```", page.read_text("utf-8"), re.MULTILINE | re.DOTALL)
        if blocks and page.stem not in INSIDE:
            found.append(folder / f"page_{page.stem}.py")
            found[-1].write_text("\n".join(blocks), encoding="utf-8")
    return found


def mypy(files: Iterable[Path]) -> list[Fault]:
    """What mypy finds as a user calls it, without the settings of this repository."""
    options = ["--strict", "--config-file=", "--no-error-summary", "--hide-error-context", "--scripts-are-modules"]
    text = said([sys.executable, "-m", "mypy", *options, *map(str, files)], MYPYPATH="").stdout
    found = re.findall(r"^(.+?):(\d+): error: (.*)$", text, re.MULTILINE)
    if not found and text.strip():
        raise SystemExit(text)
    ours = [fault for fault in found if not fault[2].endswith("[import-untyped]")]  # of other packages
    return [(Path(file).name, int(line), message) for file, line, message in ours]


def pyright(files: Iterable[Path]) -> list[Fault]:
    """What pyright finds with its standard rules."""
    files = list(files)
    with tempfile.TemporaryDirectory() as folder:
        settings = Path(folder) / "pyrightconfig.json"
        settings.write_text(json.dumps({"typeCheckingMode": "standard", "include": [*map(str, files)]}), "utf-8")
        done = said([PYRIGHT, "--project", str(settings), "--pythonpath", sys.executable, "--outputjson"])
    found = json.loads(done.stdout)["generalDiagnostics"]
    return [
        (Path(one["file"]).name, one["range"]["start"]["line"] + 1, one["message"])
        for one in found
        if one["severity"] == "error"
    ]


def completeness() -> float:
    done = said(
        [PYRIGHT, "--verifytypes", "torsionnet", "--ignoreexternal", "--outputjson", "--pythonpath", sys.executable]
    )
    return float(json.loads(done.stdout)["typeCompleteness"]["completenessScore"])


PYRIGHT = str(Path(sys.executable).with_name("basedpyright"))


def said(command: list[str], **environment: str) -> subprocess.CompletedProcess[str]:
    """What a program prints; it finds this checkout as an installed package."""
    with tempfile.TemporaryDirectory() as elsewhere:
        return subprocess.run(
            command, cwd=elsewhere, env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
            capture_output=True, text=True, check=False,
        )  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
