"""What is tried: for each kind of file how one is made, and what a user would do with it."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

import torsionnet as tn
from fuzz import drawing, reuse, running, sources
from fuzz.mutating import Chance, mutated, mutated_bytes
from torsionnet.base.expression_reading import scalar
from torsionnet.base.expressions import ExpressionError
from torsionnet.base.number_text import json_finite
from torsionnet.identification.fit_file import load_fit_plan
from torsionnet.io import read_frequency_response, read_tors
from torsionnet.model.files.writer import dump, flat_text
from torsionnet.report import make_report
from torsionnet.signals import check_recording, read_recording
from torsionnet.study.run.run_chunks import run_study
from torsionnet.study.study import load_study

LIBRARIES = {".tdms": "nptdms", ".uff": "pyuff", ".h5": "h5py", ".parquet": "pyarrow", ".mf4": "asammdf"}
FREQUENCIES = np.geomspace(0.1, 1000.0, 12)
MOST_SAMPLES = 2000
"""Of a bench that is run: more are sound, and take their time."""
MOST_VARIANTS = 32
"""Of a study that is calculated."""
MOST_COORDINATES = 150
"""Of a model of which everything is calculated."""


@dataclass(frozen=True)
class Kind:
    """``make`` gives the content of a file, ``use`` reads it and goes on with what is in it; ``sound`` is a good one."""

    name: str
    ending: str
    make: Callable[[Chance, Path], bytes]
    use: Callable[[Path], None]
    sound: Callable[[Path], bytes] = lambda _: b""
    seconds: float = 2.0
    """Of processor time that a file below 10 kB may take."""


def _encoded(text: str) -> bytes:
    return text.encode("utf-8", errors="surrogatepass")


def _running(chance: Chance, folder: Path) -> bytes:
    del folder
    text = running.plant(chance)
    if chance.random() < 0.6:
        # What runs is damaged more often than what it runs in.
        at = text.index("speeds:") if chance.random() < 0.8 else 0
        text = text[:at] + mutated(text[at:], chance)
    return _encoded(text)


def _components(chance: Chance, folder: Path) -> bytes:
    del folder
    return _encoded(reuse.component_plant(chance))


def _text(of: Callable[[], tuple[str, ...]], chance: Chance, folder: Path) -> bytes:
    del folder
    return _encoded(mutated(chance.choice(of()), chance))


def _model(chance: Chance, folder: Path) -> bytes:
    if chance.random() < 0.4:
        text = drawing.model(chance)
        return _encoded(mutated(text, chance) if chance.random() < 0.3 else text)
    return _text(sources.models, chance, folder)


def _bench(chance: Chance, folder: Path) -> bytes:
    del folder
    text = sources.BENCH
    if chance.random() < 0.5:
        start = text.index("{type: linear")
        text = text[:start] + chance.choice(sources.EXCITATIONS) + text[text.index("\n", start) :]
    return _encoded(mutated(text, chance))


def _fit(chance: Chance, folder: Path) -> bytes:
    del folder
    return _encoded(mutated(sources.FIT, chance))


def _study(chance: Chance, folder: Path) -> bytes:
    del folder
    return _encoded(mutated(sources.STUDY, chance))


def _report(chance: Chance, folder: Path) -> bytes:
    del folder
    return _encoded(sources.RIG + mutated(sources.REPORT, chance))


def _expression(chance: Chance, folder: Path) -> bytes:
    del folder
    text = drawing.expression(chance)
    return _encoded(mutated(text, chance) if chance.random() < 0.4 else text)


def _of_bytes(of: Callable[[Path, str], tuple[bytes, ...]], ending: str, chance: Chance, folder: Path) -> bytes:
    raw = chance.choice(of(folder, ending))
    if ending == ".csv" and chance.random() < 0.8:
        return _encoded(mutated(raw.decode(), chance))
    return mutated_bytes(raw, chance)


def _first(of: Callable[[Path, str], tuple[bytes, ...]], ending: str, folder: Path) -> bytes:
    return of(folder, ending)[0]


def use_expression(path: Path) -> None:
    expression = scalar(path.read_bytes().decode("utf-8", errors="surrogatepass"))
    expression.evaluate(dict.fromkeys(expression.names, 2))
    expression.dimension(dict.fromkeys(expression.names))
    str(expression)


def use_model(path: Path) -> None:
    rig = tn.load(path)
    assert dump(rig.definition)
    names = list(rig.configurations)
    model = rig.configured(names[path.stat().st_size % len(names)]) if names else rig
    if len(model.nodes) > MOST_COORDINATES:
        return
    model.modes()
    if model.sensors and model.inputs:
        driven = next(iter(model.inputs))
        model.frequency_response(next(iter(model.sensors)), driven, FREQUENCIES, driven_by=driven)


def use_running(path: Path) -> None:
    plant = tn.load(path)
    assert tn.loads(dump(plant.definition), folder=path.parent).definition.to_data() == plant.definition.to_data()
    names = list(plant.configurations)
    plant = plant.configured(names[path.stat().st_size % len(names)]) if names else plant
    outputs, faults = ["torque(rubber)", "stress(shaft)", "angle(c1)"], []
    for question in (
        lambda: plant.order_response(outputs).half_range,
        lambda: plant.mean_response(outputs[:2]),
        plant.static_state,
        # Peaks are sought at many speeds, each of them solved alone where parameters follow it.
        lambda: plant.critical_speeds(
            () if "by:" in path.read_text(encoding="utf-8", errors="replace") else outputs[:1]
        ),
        lambda: plant.dissipated_power("rubber"),
        plant.check_limits,
        lambda: plant.holzer_table(1),
    ):
        try:
            question()
        except EXPECTED as fault:
            faults.append(fault)
    if faults:
        raise faults[0]


def _use_beside(text: str, path: Path) -> None:
    plant = path.with_name("plant.yaml")
    plant.write_text(text, encoding="utf-8")
    tn.load(plant).order_response("torque(rubber)")


def _use_sized(text: str, path: Path) -> None:
    plant = path.with_name("sized.yaml")
    plant.write_text(text, encoding="utf-8")
    use_model(plant)


def use_parts(path: Path) -> None:
    use_model(path)
    rig = tn.load(path)
    assert tn.loads(flat_text(rig.definition), folder=path.parent) == rig
    rig.check()


def use_bench(path: Path) -> None:
    bench = tn.load_bench(path)
    if bench.plan.excitation is None or bench.plan.acquisition.rate * bench.plan.excitation.length <= MOST_SAMPLES:
        bench.records()


def use_fit(path: Path) -> None:
    plan = load_fit_plan(path, read_frequency_response)
    tn.identify(plan.model, plan.measurements, dict(plan.parameters), **{**plan.options, "starts": 1})


def use_study(path: Path) -> None:
    study = load_study(path)
    if not 0 < study.count <= MOST_VARIANTS:
        return
    result = run_study(study)
    json.dumps(json_finite(result.to_data()), allow_nan=False)
    for answer in study.answers.values():
        if answer.of_variants:
            json.dumps(json_finite(answer.conclude(study, result).to_data()), allow_nan=False)


def use_report(path: Path) -> None:
    make_report(path, date=None)


def use_record(path: Path) -> None:
    check_recording(read_recording(path))


def use_response(path: Path) -> None:
    read_frequency_response(path)


def use_tors(path: Path) -> None:
    model = read_tors(path)
    if len(model.nodes) <= MOST_COORDINATES:
        model.modes()


def components() -> tuple[Kind, ...]:
    """Random components, which are drawn beside exact equations and want their library."""
    if importlib.util.find_spec("flint") is None:
        return ()
    return (Kind("components", ".yaml", _components, use_parts, lambda _: reuse.TWIN.encode(), seconds=5.0),)


def _installed(ending: str) -> bool:
    return ending not in LIBRARIES or importlib.util.find_spec(LIBRARIES[ending]) is not None


RECORDS = [
    ending
    for ending in (".csv", ".npz", ".mat", ".h5", ".tdms", ".uff", ".parquet", ".mf4", ".wav")
    if _installed(ending)
]
RESPONSES = [ending for ending in (".csv", ".npz", ".mat", ".uff") if _installed(ending)]
KINDS = {
    kind.name: kind
    for kind in (
        Kind("expression", ".txt", _expression, use_expression, lambda _: b"2*k"),
        Kind("model", ".yaml", _model, use_model, lambda _: sources.RIG.encode()),
        Kind("running", ".yaml", _running, use_running, lambda _: running.SOUND.encode(), seconds=6.0),
        Kind("parts", ".yaml", partial(_text, reuse.plants), use_parts, lambda _: reuse.TWIN.encode(), seconds=5.0),
        *components(),
        Kind(
            "catalogue",
            ".csv",
            partial(_text, lambda: (reuse.COUPLINGS,)),
            partial(_use_sized, reuse.SIZED),
            lambda _: reuse.COUPLINGS.encode(),
        ),
        Kind(
            "sheet",
            ".csv",
            partial(_text, reuse.sheets),
            partial(_use_sized, reuse.SHEET),
            lambda _: reuse.sheets()[0].encode(),
        ),
        Kind(
            "pressure",
            ".csv",
            partial(_text, running.traces),
            partial(_use_beside, running.TRACED),
            lambda _: running.traces()[0].encode(),
        ),
        Kind(
            "orders",
            ".csv",
            partial(_text, lambda: running.ORDERS),
            partial(_use_beside, running.RECORDED),
            lambda _: running.ORDERS[0].encode(),
        ),
        Kind("bench", ".yaml", _bench, use_bench, lambda _: sources.BENCH.encode()),
        Kind("fit", ".yaml", _fit, use_fit, lambda _: sources.FIT.encode(), seconds=10.0),
        # Modes are followed to variants of any size in a dozen steps each.
        Kind("study", ".yaml", _study, use_study, lambda _: sources.STUDY.encode(), seconds=20.0),
        Kind("report", ".yaml", _report, use_report, lambda _: sources.WHOLE_REPORT.encode()),
        Kind("tors", ".json", partial(_text, sources.tors), use_tors, lambda _: sources.tors()[0].encode()),
        *(
            Kind(
                f"record{ending}",
                ending,
                partial(_of_bytes, sources.records, ending),
                use_record,
                partial(_first, sources.records, ending),
            )
            for ending in RECORDS
        ),
        *(
            Kind(
                f"response{ending}",
                ending,
                partial(_of_bytes, sources.responses, ending),
                use_response,
                partial(_first, sources.responses, ending),
            )
            for ending in RESPONSES
        ),
    )
}
EXPECTED = (tn.TorsionnetError, ExpressionError)
"""What may be raised: errors with words, and a place where there is one."""
