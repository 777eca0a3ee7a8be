"""Virtual test benches: tests that run on a model instead of a rig, with an exciter, sensors and data acquisition."""

from torsionnet.core.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Acquisition": "torsionnet.model.bench",
        "Bench": "torsionnet.bench.bench",
        "CoastDown": "torsionnet.model.bench",
        "DropOuts": "torsionnet.model.bench",
        "Encoder": "torsionnet.model.bench",
        "Exciter": "torsionnet.model.bench",
        "ExciterOutput": "torsionnet.bench.exciter_torque",
        "GivenSpeed": "torsionnet.model.bench",
        "Hum": "torsionnet.model.bench",
        "PitchErrors": "torsionnet.model.bench",
        "Plan": "torsionnet.model.bench",
        "RadialVibration": "torsionnet.model.bench",
        "RecordingSystem": "torsionnet.model.bench",
        "RunDown": "torsionnet.model.bench",
        "RunUp": "torsionnet.model.bench",
        "ShuntCalibration": "torsionnet.model.bench",
        "SteadyPoints": "torsionnet.model.bench",
        "StrainGauge": "torsionnet.model.bench",
        "ToothedWheel": "torsionnet.model.bench",
        "Transducer": "torsionnet.model.bench",
        "TrueFault": "torsionnet.bench.true_fault",
        "TurningTest": "torsionnet.bench.turning_test",
        "ZeroDrift": "torsionnet.model.bench",
        "load_bench": "torsionnet.bench.loading_bench",
    },
)
