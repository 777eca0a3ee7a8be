"""Small files of every binary format, and files of the kind that hostile or broken programs write."""

import random
import zlib
from struct import pack

import numpy as np

from torsionnet.signals import Recording, Signal, write_recording

COUNT = 200
CHILD_ENDINGS = (".h5", ".mat", ".tdms", ".parquet", ".uff")
EXTRAS = {".tdms": "nptdms", ".uff": "pyuff", ".h5": "h5py", ".parquet": "pyarrow", ".mat": "scipy", ".npz": "numpy"}


def record(count=COUNT):
    """Two channels of known values."""
    torque = np.random.default_rng(1).normal(size=count)
    return Recording((Signal("T_T", "torque", torque), Signal("phi", "angle", 0.5 * np.arange(count))), 1000.0)


def written(folder, ending, count=COUNT):
    path = folder / f"record{ending}"
    write_recording(record(count), path)
    return path


def matlab_73(path):
    """As MATLAB writes it, with a compressed variable."""
    import h5py

    with h5py.File(path, "w", userblock_size=512) as file:
        file["x"] = np.arange(COUNT)[None]
        file["x"].attrs["MATLAB_class"] = np.bytes_("double")
        file.create_dataset("y", data=np.arange(COUNT)[None] / 3, compression="gzip", chunks=(1, 64))
        file.create_dataset("time", data=np.arange(COUNT)[None] / 1000)
    return path


def damaged(raw, seed):
    """Some bytes changed, mostly at the beginning where the structure is, or the end cut off."""
    chance = random.Random(seed)
    damaged_bytes = bytearray(raw)
    for _ in range(chance.randint(1, 6)):
        where = len(damaged_bytes) if chance.random() < 0.5 else min(len(damaged_bytes), 2000)
        damaged_bytes[chance.randrange(where)] = chance.choice([chance.randrange(256), 0, 1, 127, 128, 255])
    return bytes(damaged_bytes[: chance.randrange(len(damaged_bytes))] if chance.random() < 0.15 else damaged_bytes)


def mat_variable(name, dimensions, kind=6, length=None):
    """A variable of a MAT v5 file, uncompressed, that holds 8 bytes of values whatever its dimensions say."""
    sizes = pack(f"<{len(dimensions)}i", *dimensions)
    sizes += b"\0" * (-len(sizes) % 8)
    word = name.encode() + b"\0" * (-len(name) % 8)
    parts = pack("<4I", 6, 8, kind, 0) + pack("<2I", 5, 4 * len(dimensions)) + sizes + pack("<2I", 1, len(name)) + word
    parts += pack("<2Id", 9, 8, 1.0)
    return pack("<2I", 14, len(parts) if length is None else length) + parts


def mat_file(path, *variables, compressed=False):
    """A MAT v5 file of such variables."""
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    packed = [zlib.compress(one) for one in variables] if compressed else []
    path.write_bytes(head + b"".join([pack("<2I", 15, len(one)) + one for one in packed] or variables))
    return path
