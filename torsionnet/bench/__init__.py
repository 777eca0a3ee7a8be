"""Virtual test benches: tests that run on a model instead of a rig, with an exciter, sensors and data acquisition."""

from torsionnet.core.lazy_imports import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Acquisition": "torsionnet.model.bench",
        "Bench": "torsionnet.bench.bench",
        "Encoder": "torsionnet.model.bench",
        "Exciter": "torsionnet.model.bench",
        "ExciterOutput": "torsionnet.bench.exciter_torque",
        "Plan": "torsionnet.model.bench",
        "Transducer": "torsionnet.model.bench",
        "load_bench": "torsionnet.bench.loading_bench",
    },
)
