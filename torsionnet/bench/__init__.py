"""Virtual test benches: what they are made of, and tests that run on a model instead of a rig."""

from torsionnet.core.lazy import offered

__all__, __getattr__, __dir__ = offered(
    __name__,
    {
        "Acquisition": "torsionnet.model.bench",
        "Bench": "torsionnet.bench.bench",
        "Encoder": "torsionnet.model.bench",
        "Exciter": "torsionnet.model.bench",
        "Plan": "torsionnet.model.bench",
        "Transducer": "torsionnet.model.bench",
        "load_bench": "torsionnet.bench.loading_bench",
    },
)
