# Written by `make generate`.
from torsionnet.bench.bench import Bench as Bench
from torsionnet.bench.loading_bench import load_bench as load_bench
from torsionnet.model.bench import Acquisition as Acquisition
from torsionnet.model.bench import Encoder as Encoder
from torsionnet.model.bench import Exciter as Exciter
from torsionnet.model.bench import Plan as Plan
from torsionnet.model.bench import Transducer as Transducer

__all__ = [
    "Acquisition",
    "Bench",
    "Encoder",
    "Exciter",
    "Plan",
    "Transducer",
    "load_bench",
]
