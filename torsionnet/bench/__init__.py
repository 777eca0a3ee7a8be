"""Virtual test benches: tests that run on a model instead of a rig, with an exciter, sensors and data acquisition."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Acquisition": "torsionnet.bench.plan",
        "Bench": "torsionnet.bench.bench",
        "CoastDown": "torsionnet.bench.plan",
        "DropOuts": "torsionnet.bench.plan",
        "Encoder": "torsionnet.bench.plan",
        "Exciter": "torsionnet.bench.plan",
        "ExciterOutput": "torsionnet.bench.recorded_signal",
        "GivenSpeed": "torsionnet.bench.plan",
        "Hum": "torsionnet.bench.plan",
        "PitchErrors": "torsionnet.bench.plan",
        "Plan": "torsionnet.bench.plan",
        "RadialVibration": "torsionnet.bench.plan",
        "RecordingSystem": "torsionnet.bench.plan",
        "RunDown": "torsionnet.bench.plan",
        "RunUp": "torsionnet.bench.plan",
        "ShuntCalibration": "torsionnet.bench.plan",
        "SteadyPoints": "torsionnet.bench.plan",
        "StrainGauge": "torsionnet.bench.plan",
        "ToothedWheel": "torsionnet.bench.plan",
        "Transducer": "torsionnet.bench.plan",
        "TrueFault": "torsionnet.bench.wheel_turning",
        "TurningTest": "torsionnet.bench.bench",
        "ZeroDrift": "torsionnet.bench.plan",
        "load_bench": "torsionnet.bench.loading_bench",
    },
)
