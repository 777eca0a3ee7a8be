"""python -m phases.nightly [PART ...]: parts of the night, all without a name; each that is green is noted in .ci/nightly.txt.

``status`` prints where each part was last green and what changed since that it looks at; ``status COMMIT`` what changed since a
commit. ``reached`` runs the parts that have something to look at.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import date
from fnmatch import fnmatch

from phases.__main__ import SET_UP, TOOLS
from phases.running import ROOT, Run, Step, make

GREEN = ROOT / ".ci" / "nightly.txt"
LIMIT = 3000.0
"""Processor seconds of a part on the quiet machine: 25 minutes of two cores."""
TODAY = date.today().toordinal()  # noqa: DTZ011

NUMBERS = tuple(
    f"torsionnet/{room}/*"
    for room in (
        "bench", "identification", "linear", "machinery", "modal", "motion", "signals", "study", "symbolic",
    )
)  # fmt: skip
READERS = (
    "torsionnet/io/*",
    "torsionnet/signals/*",
    "torsionnet/model/*",
    "torsionnet/base/*",
    "torsionnet/drivetrain.py",
    "library/*",
)
ADAPTERS = tuple(
    f"torsionnet/{room}/*" for room in ("app/language_server", "io", "plot", "signals", "report", "study", "symbolic")
)


@dataclass(frozen=True)
class Part:
    """What runs, and the files that it looks at; patterns in which a star stands for slashes, too."""

    steps: tuple[Step, ...]
    reached_by: tuple[str, ...]


PARTS = {
    # With the lowest kernel numpy works without its vector code, too.
    "kernels": Part(
        (
            ((make("test-kernel", 1250, "MARKED=not nightly", name="next kernel"),),),
            ((make("test-kernel", 450, "KERNEL=lowest", name="lowest kernel"),),),
        ),
        (*NUMBERS, "torsionnet/base/*", "tests/support/kernel*", "tests/project/test_kernels.py"),
    ),
    "packages": Part(
        (((make("test-oldest", 600),),), ((make("test-newest", 600),),)),
        ("pyproject.toml", "tests/oldest.txt", *ADAPTERS),
    ),
    "mutation": Part(
        (((make("reach", 1700, "MARKED=not nightly"),),), ((make("mutation", 1300, "ARGS=-n 60 --seed commit"),),)),
        ("torsionnet/*.py", "tests/*test_*.py", "tests/support/*", "tests/mutation/*", "tests/reach/*"),
    ),
    # Each keeps one core busy for 20 minutes.
    "fuzz": Part(
        (tuple((make("fuzz", 1200, f"ARGS=--seed {TODAY}-{lane}", "SECONDS=1200", name=f"fuzz {lane}"),) for lane in "ab"),),
        (*READERS, "torsionnet/study/*", "torsionnet/bench/*", "tests/fuzz/*"),
    ),
    "campaigns": Part(
        (
            ((make("test-campaigns", 2500),),),
            ((make("compare", 250, f"ARGS=--seed {TODAY}"),), (make("compare-parts", 250, f"ARGS=--seed {TODAY}"),)),
        ),
        (*NUMBERS, "torsionnet/app/text/*", "torsionnet/model/*", "torsionnet/base/*", "tests/*test_*.py", "tests/support/*"),
    ),
    "release": Part(
        (((make("bench-short", 300),), (make("manuals", 100), make("release-files", 200))),),
        ("docs/*", "paper/*", "recipe/*", "benchmarks/*", "tests/release/*", "CITATION.cff", "codemeta.json", "Dockerfile", ".github/*", "pyproject.toml"),
    ),
}  # fmt: skip


def run(name: str) -> int:
    """Exit code of a part, noted where it is green and all that it ran is committed."""
    commit, is_clean = _git("rev-parse", "--short=12", "HEAD"), not _changed_since("HEAD")
    code = Run(f"{name} of the night", LIMIT).carry_out([[[TOOLS], [SET_UP]], *PARTS[name].steps])
    if code == 0 and is_clean:
        noted = _noted() | {name: f"{commit} {_git('show', '-s', '--format=%cs', commit)}"}
        GREEN.write_text("".join(f"{part} {noted[part]}\n" for part in PARTS if part in noted), encoding="utf-8")
        print(f"{name}: green at {commit}, noted in {GREEN.relative_to(ROOT)}, which is to be committed")
    elif code == 0:
        print(f"{name}: green, but not noted: there are changes that are not committed")
    return code


def reached(name: str, since: str) -> list[str]:
    """Files which a part looks at and that changed since a commit, with those not committed."""
    patterns = PARTS[name].reached_by
    return [file for file in _changed_since(since) if any(fnmatch(file, pattern) for pattern in patterns)]


def status(since: str | None) -> dict[str, list[str]]:
    """Print one line for each part; the files that changed since it was green, for those that have such files."""
    noted, to_run = _noted(), {}
    for name in PARTS:
        green = noted.get(name)
        if since is None and green is None:
            line, to_run[name] = "never green", []
        else:
            line = f"green at {green}" if green else "never green"
            if files := reached(name, since or str(green).split()[0]):
                to_run[name] = files
                more = f" and {len(files) - 3} more" if len(files) > 3 else ""
                line += f"; since {since or 'then'} {', '.join(files[:3])}{more}"
        print(f"{name:10s} {'to run' if name in to_run else '      '}  {line}")
    return to_run


def _noted() -> dict[str, str]:
    lines = GREEN.read_text(encoding="utf-8").splitlines() if GREEN.exists() else []
    noted = {part: rest for part, _, rest in (line.partition(" ") for line in lines)}
    # A commit that was rewritten since says nothing.
    return {
        part: rest
        for part, rest in noted.items()
        if _git("rev-parse", "-q", "--verify", f"{rest.split()[0]}^{{commit}}")
    }


def _changed_since(commit: str) -> list[str]:
    listed = (
        _git("diff", "--name-only", commit).splitlines() + _git("ls-files", "-o", "--exclude-standard").splitlines()
    )
    return [file for file in listed if ROOT / file != GREEN]


def _git(*words: str) -> str:
    return subprocess.run(("git", *words), cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False).stdout.strip()


def main(words: list[str]) -> int:
    if words[:1] == ["status"]:
        status(words[1] if words[1:] else None)
        return 0
    if words[:1] == ["reached"]:
        words = list(status(words[1] if words[1:] else None)) or sys.exit(0)
    if unknown := set(words) - set(PARTS):
        sys.exit(f"no part {', '.join(sorted(unknown))}; there are: {', '.join(PARTS)}, or status, or reached")
    return _worst(run(name) for name in words or PARTS)


def _worst(codes: Iterable[int]) -> int:
    """One part that fails keeps no other from running."""
    return max(codes)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
