"""Virtual test benches: tests that run on a model instead of a rig, with an exciter, sensors and data acquisition."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Acquisition": "torsionnet.bench.plan",
        "Bench": "torsionnet.bench.bench",
        "Encoder": "torsionnet.bench.plan",
        "Plan": "torsionnet.bench.plan",
        "RunUp": "torsionnet.bench.plan",
        "ToothedWheel": "torsionnet.bench.plan",
        "Transducer": "torsionnet.bench.plan",
        "load_bench": "torsionnet.bench.loading_bench",
    },
)
