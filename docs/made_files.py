"""Generated files, each made anew where something it was made from has changed.

``python docs/made_files.py`` (``make generate``) writes them, those named (``elements.md``), with ``--all`` also those
that are current; ``--check`` writes nothing and names the files in the repository that are not current, exit code 1.

Nobody lists what a file is made from: the modules of the checkout that are imported, the files that are read and the
folders that are listed while it is made are observed. They stand in .cache/made_files.json with their digest, which
covers the versions of the installed packages, too.
"""

from __future__ import annotations

import argparse
import gc
import json
import os
import re
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from hashlib import blake2b
from multiprocessing import get_context
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
RECORD = ROOT / ".cache" / "made_files.json"
IN_REPOSITORY = (
    *("elements.md", "units.md", "damping.md", "traps.md", "bench.md", "file_entries.md", "study_file.md", "report.md"),
    *("report_texts.md", "layers.md", "house.svg", "stubs", "schemas"),
)
"""Names of what is read without a build, for which ``generate.write`` has pages and other writers."""
FOR_PAGES = (
    *("verification.md", "tutorial pictures", "bench_numbers.md", "cases.md", "paper.md", "symbol pictures"),
    *("element_index.md", "reference_index.md", "faults.md", "words.md", "reference", "sign pictures", "law pictures"),
)
"""Names of what only a build of the documentation needs, the dearest first."""
OF_A_PROCESS = ("torsionnet", "library", "docs/*.py", "tests/structure", "tests/support")
"""What counts as an input where another process was started, of which nothing is observed."""
MADE_FOLDERS = ("docs/_build", "docs/gallery", "docs/generated", "docs/reference", "out")
SEARCHES = re.compile(r"frozen importlib|importlib.metadata")
"""Files of Python whose lists of folders are searches for modules and packages, which the modules found tell better."""
STARTS = {"subprocess.Popen", "os.fork", "os.posix_spawn", "os.exec", "os.system"}


@dataclass
class Observed:
    """Files read and folders listed below the checkout, relative to it, and whether other processes were started."""

    paths: set[str] = field(default_factory=set)
    started: bool = False

    def note(self, event: str, given: tuple[Any, ...]) -> None:
        """Note an event that Python tells to its audit hooks."""
        if event == "open":
            reads = isinstance(given[2], int) and not given[2] & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)
            self._add(given[0], reads=reads)
        elif event in ("os.listdir", "os.scandir"):
            asks = sys._getframe(1).f_code.co_filename  # noqa: SLF001 - nothing else tells who lists a folder
            self._add(given[0], reads=not SEARCHES.search(asks))
        elif event in STARTS:
            self.started = True

    def _add(self, path: object, *, reads: bool) -> None:
        if reads and isinstance(path, str | os.PathLike) and (name := below_checkout(os.fspath(path))):
            self.paths.add(name)

    def all_paths(self) -> list[str]:
        """Sorted paths, those of the imported modules included."""
        return sorted(self.paths | imported() | (files_below(OF_A_PROCESS) if self.started else set()))


OBSERVED = Observed()


def below_checkout(path: str | bytes) -> str:
    """Path relative to the checkout; empty elsewhere, of hidden folders, of what Python compiled and what is made."""
    try:
        name = Path(os.path.abspath(os.fsdecode(path))).relative_to(ROOT).as_posix()  # noqa: PTH100 - also as bytes
    except ValueError:
        return ""
    is_made = name.startswith(MADE_FOLDERS) or name.endswith((".pyi", ".schema.json"))
    return "" if is_made or name.startswith(".") or "__pycache__" in name else name


def imported() -> set[str]:
    """Files of the modules of the checkout that have been imported."""
    files = (getattr(module, "__file__", None) for module in [*sys.modules.values()])
    return {name for file in files if file and (name := below_checkout(file))}


def files_below(patterns: Iterable[str]) -> set[str]:
    """Files that patterns name, or that lie in folders that they name, and these folders."""
    paths = (path for pattern in patterns for path in ROOT.glob(pattern if "*" in pattern else f"{pattern}/**/*"))
    return {name for path in paths if (name := below_checkout(str(path)))}


# What is current


@cache
def digest(name: str) -> str:
    """Digest of a file's contents or of a folder's list of names, by its path below the checkout; empty if missing."""
    path = ROOT / name
    if path.is_dir():
        names = sorted(one.name for one in path.iterdir() if one.name != "__pycache__")
        return blake2b("\n".join(names).encode(), digest_size=12).hexdigest()
    return blake2b(path.read_bytes(), digest_size=12).hexdigest() if path.exists() else ""


@cache
def installed() -> str:
    """Version of Python with names and versions of the installed packages."""
    names = {path.name for folder in sys.path if folder for path in Path(folder).glob("*.dist-info")}
    return f"{sys.version} {' '.join(sorted(names))}"


def digest_of_all(names: Sequence[str], began: float | None = None) -> str:
    """Digest of files, folders and installed packages; empty if any was edited since a time, perhaps after its use."""
    if began and any((ROOT / name).stat().st_mtime > began for name in names if digest(name)):
        return ""
    text = "\n".join([installed(), *(f"{name} {digest(name)}" for name in names)])
    return blake2b(text.encode(), digest_size=12).hexdigest()


def recorded() -> dict[str, Any]:
    try:
        return dict(json.loads(RECORD.read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return {}


def is_current(known: dict[str, Any] | None) -> bool:
    """Whether what something was made from is as it was, and its files are in their place as they were made."""
    return (
        known is not None
        and all(digest(name) == made for name, made in known["made"].items())
        and digest_of_all(known["from"]) == known["digest"]
    )


# Making


def made(names: list[str], folder: Path) -> Iterator[tuple[str, list[str]]]:
    """Names of what was written below a folder, each into one of its own, with the paths that it was made from."""
    sys.addaudithook(OBSERVED.note)
    sys.path[:0] = [str(ROOT), str(ROOT / "docs")]
    os.environ["MPLBACKEND"] = "Agg"
    import generate  # noqa: F401 - imported once, for all processes

    gc.freeze()
    gc.set_threshold(100_000)
    tasks = [(name, folder / str(number)) for number, name in enumerate(names)]
    if sys.platform != "linux" or len(tasks) == 1:
        yield from map(_made, tasks)
        return
    with get_context("fork").Pool(min(os.cpu_count() or 1, len(tasks)), maxtasksperchild=1) as pool:
        yield from pool.imap_unordered(_made, tasks, chunksize=1)


def _made(task: tuple[str, Path]) -> tuple[str, list[str]]:
    import generate

    name, folder = task
    OBSERVED.started = False
    generate.write(name, folder)
    return name, OBSERVED.all_paths()


def bring_up_to_date(names: Iterable[str], *, keep: bool = True, write: bool = True) -> Iterator[str]:
    """Make what is not current, keep it unless only a look was wanted, and yield the paths of files that differ."""
    known = recorded()
    stale = [name for name in sorted(names, key=_place) if not (keep and is_current(known.get(name)))]
    if not stale:
        return
    began = time.time()
    with tempfile.TemporaryDirectory() as scratch:
        for name, inputs in made(stale, Path(scratch)):
            folder = Path(scratch) / str(stale.index(name))
            files = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}
            before = known.get(name, {"made": {}})["made"]
            known[name] = {"from": inputs, "digest": digest_of_all(inputs, began), "made": {}}
            for place, path in files.items():
                text = path.read_bytes()
                known[name]["made"][place] = blake2b(text, digest_size=12).hexdigest()
                if known[name]["made"][place] == digest(place):
                    continue
                yield place
                if write:
                    (ROOT / place).parent.mkdir(parents=True, exist_ok=True)
                    (ROOT / place).write_bytes(text)
            for place in [*before] if write else []:
                if place not in files:
                    (ROOT / place).unlink(missing_ok=True)
    RECORD.parent.mkdir(exist_ok=True)
    RECORD.write_text(json.dumps(known), encoding="utf-8")


def _place(name: str) -> int:
    return [*FOR_PAGES, *IN_REPOSITORY].index(name)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description="Generated files, made anew where their inputs have changed.")
    parser.add_argument("names", nargs="*", choices=[[], *IN_REPOSITORY, *FOR_PAGES], metavar="NAME")
    parser.add_argument("--all", action="store_true", help="also those that are current")
    parser.add_argument("--check", action="store_true", help="only name those of the repository that are not current")
    given = parser.parse_args(arguments)
    names = given.names or (IN_REPOSITORY if given.check else [*FOR_PAGES, *IN_REPOSITORY])
    differ = list(bring_up_to_date(names, keep=not given.all, write=not given.check))
    for place in sorted(differ):
        sys.stdout.write(f"{place}\n" if given.check else f"wrote: {place}\n")
    return int(given.check and bool(differ))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
