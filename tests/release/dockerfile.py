"""The steps of a Dockerfile, run without a container: each stage in a fresh environment, its folders in a scratch folder.

Of the language of Dockerfiles it knows what the Dockerfile here needs, and refuses the rest. Steps that need a container (users) are named, not run.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

NEEDS_A_CONTAINER = ("useradd", "groupadd", "apt-get", "chown")
CARRIED_OUT = ("COPY", "RUN", "WORKDIR")
SETTINGS_OF_THE_IMAGE = ("LABEL", "ENV", "USER", "ENTRYPOINT", "CMD")  # what a step run here does not depend on


@dataclass(frozen=True)
class Stage:
    """A stage of a Dockerfile: its image, and its instructions as (word, rest of the line)."""

    image: str
    name: str
    steps: list[tuple[str, str]] = field(default_factory=list)


def stages(text: str) -> list[Stage]:
    """Stages of a Dockerfile in their order, with continued lines joined and comments left out."""
    joined = re.sub(r"\\\n\s*", "", re.sub(r"^#.*\n", "", text, flags=re.MULTILINE))
    found: list[Stage] = []
    for line in filter(str.strip, joined.splitlines()):
        word, rest = line.split(maxsplit=1)
        if word == "FROM":
            image, _, name = rest.partition(" AS ")
            found.append(Stage(image, name))
        elif word in (*CARRIED_OUT, *SETTINGS_OF_THE_IMAGE):
            found[-1].steps.append((word, rest))
        else:
            raise ValueError(f"Dockerfile: {line}: teach tests/release/dockerfile.py the word {word}")
    return found


def let_in(dockerignore: str) -> list[str]:
    """Names at the top of the checkout that a .dockerignore of the form "* and then exceptions" lets into the image."""
    lines = [line for line in dockerignore.splitlines() if line and not line.startswith("#")]
    if lines[0] != "*" or not all(line.startswith("!") for line in lines[1:]):
        raise ValueError(".dockerignore: write * first, and then !NAME for everything that the image needs")
    return [line[1:] for line in lines[1:]]


@dataclass(frozen=True)
class Build:
    """A build in a scratch folder: image paths like /wheels become folders there, and ``python`` that of a fresh environment."""

    root: Path
    scratch: Path
    not_run: list[str] = field(default_factory=list)

    def run(self) -> Path:
        """Python of the last stage, after all its steps."""
        environment = self.scratch
        for number, stage in enumerate(stages((self.root / "Dockerfile").read_text(encoding="utf-8"))):
            environment = self.scratch / f"environment_{number}"
            subprocess.run([sys.executable, "-m", "venv", environment], check=True)
            self._stage(stage, environment)
        return environment / "bin" / "python"

    def _stage(self, stage: Stage, environment: Path) -> None:
        folder = self.scratch
        for word, rest in stage.steps:
            if word == "WORKDIR":
                folder = self.place(rest)
                folder.mkdir(parents=True, exist_ok=True)
            elif word == "COPY" and not rest.startswith("--from="):
                self._copy(folder)
            elif word == "RUN" and rest.split()[0] in NEEDS_A_CONTAINER:
                self.not_run.append(f"Dockerfile: RUN {rest}")
            elif word == "RUN":
                print(f"RUN {rest}", flush=True)
                self._step(rest, folder, environment)

    def place(self, path: str) -> Path:
        """Folder in the scratch folder that stands for an absolute path of the image."""
        return self.scratch / "image" / path.strip().lstrip("/")

    def _copy(self, folder: Path) -> None:
        for name in let_in((self.root / ".dockerignore").read_text(encoding="utf-8")):
            source = self.root / name
            if source.is_dir():
                shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy2(source, folder / name)

    def _step(self, line: str, folder: Path, environment: Path) -> None:
        line = re.sub(r"(?<=\s)/\w+(?:/\w+)*", lambda found: f'"{self.place(found[0])}"', line)
        path = f"{environment / 'bin'}{os.pathsep}{os.environ['PATH']}"
        settings = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "VIRTUAL_ENV")}
        subprocess.run(["sh", "-c", line], check=True, cwd=folder, env=settings | {"PATH": path})
