"""Virtual test benches: what they are made of, and tests that run on a model instead of a rig."""

from torsionnet.bench.bench import Bench
from torsionnet.bench.loading_bench import load_bench
from torsionnet.model.bench import Acquisition, Encoder, Exciter, Plan, Transducer

__all__ = ["Acquisition", "Bench", "Encoder", "Exciter", "Plan", "Transducer", "load_bench"]
