"""The command line as tests call it: in this process, and in one of its own."""

import os
import subprocess
import sys
from pathlib import Path

from click.testing import CliRunner

import torsionnet as tn
from support.patience import PATIENCE
from torsionnet.app.cli.app import app


def runner():
    try:
        return CliRunner(mix_stderr=False)  # click before 8.2
    except TypeError:
        return CliRunner()


def run(*arguments, code=0):
    result = runner().invoke(app, [str(argument) for argument in arguments])
    assert result.exit_code == code, result.output
    return result


def process(*arguments, directory, **options):
    """A command in a process of its own, as users have it."""
    environment = {**os.environ, "PYTHONPATH": str(Path(tn.__file__).parents[1]), **options.pop("env", {})}
    command = [sys.executable, "-m", "torsionnet", *map(str, arguments)]
    return subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
        cwd=directory,
        env=environment,
        **options,
    )
