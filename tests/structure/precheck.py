"""``python -m structure.precheck [COMMIT]``: ruff, rules of form and the types of what changed, beside each other.

Every fault is printed with what mends it; exit code 1 if there is any. Changed is what differs from COMMIT: without,
from where the branch left the one it is merged into, or from the last commit.
"""

from __future__ import annotations

import re
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
OF_RUFF = re.compile(r"(?P<place>\S+?:\d+):\d+: (?P<what>.*)")
OF_MYPY = re.compile(r"(?P<place>\S+?:\d+)(?::\d+)?: error: (?P<what>.*)")


def git(*words: str) -> str:
    """What git answers; nothing where it fails, as without a repository or a branch to merge into."""
    done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False, encoding="utf-8")
    return done.stdout.strip() if done.returncode == 0 else ""


def changed_modules(commit: str) -> list[str]:
    """Modules of the package that differ from a commit, and new ones."""
    names = git("diff", "--name-only", "--diff-filter=d", "--relative", commit, "--", "torsionnet/*.py").splitlines()
    names += git("ls-files", "--others", "--exclude-standard", "--", "torsionnet/*.py").splitlines()
    return sorted(names)


def remedied(lines: Iterable[str]) -> Iterator[str]:
    """Lines of ruff and mypy with what mends each; those of form have it."""
    for line in lines:
        if match := OF_MYPY.match(line):
            yield f"{match['place']}: {match['what']}; give it the right type (make types says all)"
        elif match := OF_RUFF.match(line):
            by_itself = "[*]" in match["what"] or match["what"].startswith("unformatted")
            yield f"{match['place']}: {match['what']}; {'make format' if by_itself else 'mend it by hand'}"
        elif not re.match(r"All checks passed|Found \d+ error|\[\*\] \d+ fixable|No fixes|\d+ files? |Success:", line):
            yield line


def main(commits: list[str]) -> int:
    began = time.monotonic()
    commit = commits[0] if commits else git("merge-base", "HEAD", "@{upstream}") or "HEAD"
    modules = changed_modules(commit)
    concise = ["--output-format", "concise", "."]
    calls = [["ruff", "check", *concise], ["ruff", "format", "--check", *concise], ["structure.form"]]
    calls += [["mypy", *modules]] if modules else []
    started = [
        subprocess.Popen(
            [sys.executable, "-m", *call], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        for call in calls
    ]
    for process in started:
        for line in remedied(process.communicate()[0].splitlines()):
            print(line, flush=True)
    failed = [
        " ".join(call[: 1 + (call[0] == "ruff")])
        for call, process in zip(calls, started, strict=True)
        if process.returncode
    ]
    what = f"{len(modules)} changed modules against {commit[:8]}" if modules else "no changed modules"
    print(f"precheck: {'failed: ' + ', '.join(failed) if failed else 'ok'}, {what}, {time.monotonic() - began:.0f} s")
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
