"""Work for the workers of a cluster, which they import: chunks of noise that take a while."""

import os
import signal
import time
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from torsionnet.base.atomic import write_bytes


def noise(number):
    return np.random.default_rng(number).normal(size=1000).tobytes()


@dataclass(frozen=True)
class NoiseWork:
    """Writes one file a chunk, as the work of a study does, and tells its checksum."""

    folder: str
    seconds: float = 0.05

    def file(self, number):
        return Path(self.folder) / f"chunk_{number:05d}"

    def __call__(self, number):
        time.sleep(self.seconds)
        write_bytes(self.file(number), noise(number))
        return zlib.crc32(noise(number))

    def missing(self, count):
        return [number for number in range(count) if not self.file(number).exists()]


@dataclass(frozen=True)
class FailingWork:
    """Fails as a worker may."""

    folder: Path
    error: Exception

    def __call__(self, _):
        raise self.error


@dataclass(frozen=True)
class DeadlyWork:
    """Ends its process, as a system does that has no memory left."""

    folder: Path

    def __call__(self, _):
        os.kill(os.getpid(), signal.SIGKILL)


class Prepared:
    """Counts what a process has done with it."""

    def __init__(self, folder):
        self.folder, self.done = folder, 0

    def __call__(self, _):
        self.done += 1
        return os.getpid(), self.done
