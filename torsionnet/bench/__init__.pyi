# Written by `make generate`.
from torsionnet.bench.bench import Bench as Bench
from torsionnet.bench.exciter_torque import ExciterOutput as ExciterOutput
from torsionnet.bench.loading_bench import load_bench as load_bench
from torsionnet.entry_classes import Acquisition as Acquisition
from torsionnet.entry_classes import Encoder as Encoder
from torsionnet.entry_classes import Exciter as Exciter
from torsionnet.entry_classes import Plan as Plan
from torsionnet.entry_classes import Transducer as Transducer

__all__ = [
    "Acquisition",
    "Bench",
    "Encoder",
    "Exciter",
    "ExciterOutput",
    "Plan",
    "Transducer",
    "load_bench",
]
