# Written by `make generate`.
from torsionnet.bench.bench import Bench as Bench
from torsionnet.bench.loading_bench import load_bench as load_bench
from torsionnet.entry_classes import Acquisition as Acquisition
from torsionnet.entry_classes import Encoder as Encoder
from torsionnet.entry_classes import Plan as Plan
from torsionnet.entry_classes import RunUp as RunUp
from torsionnet.entry_classes import ToothedWheel as ToothedWheel
from torsionnet.entry_classes import Transducer as Transducer

__all__ = [
    "Acquisition",
    "Bench",
    "Encoder",
    "Plan",
    "RunUp",
    "ToothedWheel",
    "Transducer",
    "load_bench",
]
