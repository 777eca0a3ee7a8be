"""``torsionnet study``, and results as arrays and files."""

import csv
import json

import numpy as np
import pytest
from click.testing import CliRunner
from support.study_runs import small_study

import torsionnet as tn
from torsionnet.app.cli.app import app
from torsionnet.base.errors import MissingExtraError, UsageError
from torsionnet.study.run.run_chunks import Workload, run_study, shown_time

PLAN = """\
torsionnet: 1
name: spread of the first mode
model: dmf_rig
vary:
  k_2: {type: list, values: [400, 460, 500]}
quantities:
  f_1: {type: natural_frequency, mode: 1}
  H: {type: response, output: theta_1, input: T_M, band: 1..20 Hz, points: 4}
"""


def run(*words, code=0):
    found = CliRunner().invoke(app, ["study", *words])
    assert found.exit_code == code, found.output
    return found


@pytest.fixture
def plan(tmp_path):
    file = tmp_path / "plan.yaml"
    file.write_text(PLAN)
    return file


def frequencies():
    rig = tn.load("dmf_rig")
    return [rig.configured(k_2=value).modes().natural_frequencies[0] for value in (400, 460, 500)]


def test_json_is_that_of_models_made_singly(plan):
    found = json.loads(run(str(plan), "--json").stdout)
    first, curve = found["quantities"]
    assert first["mean"] == pytest.approx(np.mean(frequencies()), rel=1e-9)
    assert (first["smallest_at"], first["largest_at"]) == (0, 2)
    assert first["percentiles"] == pytest.approx([frequencies()[n] for n in (0, 1, 2)], rel=1e-9)
    assert len(curve["points"]) == len(curve["mean"]) == 4
    assert found["version"] == tn.__version__


def test_table_and_csv_of_all_variants(plan, tmp_path):
    file = tmp_path / "all.csv"
    shown = run(str(plan), "--variants", str(file)).stdout
    assert "spread of the first mode" in shown
    rows = list(csv.reader(line for line in file.read_text().splitlines() if not line.startswith("#")))
    assert rows[0] == ["k_2", "f_1 [Hz]"]
    assert [float(row[1]) for row in rows[1:]] == pytest.approx(frequencies(), rel=1e-9)


def test_folder_is_gone_on_with(plan, tmp_path):
    folder = tmp_path / "results"
    first = run(str(plan), "-o", str(folder), "--json").stdout
    plan.write_text(PLAN + "limits: {f_1: {below: 7}}\nanswers: {share: {type: yield}}\n")
    again = json.loads(run(str(plan), "-o", str(folder), "--json").stdout)
    assert again["quantities"] == json.loads(first)["quantities"]
    assert "share" in again["answers"]
    plan.write_text(PLAN.replace("460", "470"))
    assert "holds results of something else" in run(str(plan), "-o", str(folder), code=2).output


@pytest.mark.slow
def test_workers_change_nothing(plan):
    assert run(str(plan), "--json", "--workers", "2").stdout == run(str(plan), "--json").stdout


def test_workers_of_two_kinds(plan):
    assert "give one of them" in run(str(plan), "--workers", "2", "--cluster", "local:2", code=2).output


def test_cluster_needs_a_folder(plan):
    assert "needs a folder" in run(str(plan), "--cluster", "local:1", code=2).output


def test_every_fault_with_its_place(plan):
    plan.write_text(PLAN.replace("k_2:", "k_9:").replace("natural_frequency", "natural_frequencies"))
    said = run(str(plan), code=1).output
    assert "plan.yaml:5:" in said
    assert "plan.yaml:7:" in said
    assert '"natural_frequency"' in said


def test_a_grid_that_nobody_waits_for(plan):
    grids = "".join(f"  {name}: {{type: range, low: {low}, high: {2 * low}, count: 10000}}\n" for name, low in
                    {"k_1": 10_000, "c_1": 1, "I_1": 1}.items())  # fmt: skip
    plan.write_text(PLAN.replace("  k_2: {type: list, values: [400, 460, 500]}\n", grids))
    said = run(str(plan), code=2).output
    assert "1e+12 variants" in said
    assert "years" in said
    assert "--yes" in said


def test_picture_of_a_study_without_answers(plan, tmp_path):
    plan.write_text(PLAN.replace("[400, 460, 500]", str([400 + 10 * n for n in range(12)])))
    run(str(plan), "--plot", str(tmp_path / "spread.png"))
    assert {file.name for file in tmp_path.glob("*.png")} == {"spread_H.png", "spread_scatter.png"}


def test_nothing_to_draw(plan, tmp_path):
    plan.write_text("\n".join(line for line in PLAN.splitlines() if not line.startswith("  H:")))
    assert "nothing to draw" in run(str(plan), "--plot", str(tmp_path / "spread.png"), code=2).output


@pytest.mark.slow
def test_labelled_arrays():
    pytest.importorskip("xarray")
    result = run_study(small_study(10))
    found = result.to_xarray()
    assert found["f_1"].dims == ("configuration", "variant")
    assert found["f_1"].sel(configuration="V").values.tolist() == result.values("f_1", "V").tolist()
    assert found["k_2"].sel(configuration="V").values.tolist() == result.parameters("V")["k_2"].tolist()
    assert found["H"].sel(configuration="II", percentile=50).shape == (5,)
    assert found.attrs["seed"] == 1
    assert found.attrs["version"] == tn.__version__
    assert found["frequency_of_H"].values == pytest.approx(np.geomspace(1, 20, 5))
    (only,) = run_study(small_study(10, configurations=["V"])).to_xarray()["f_1"].values
    assert only.tolist() == result.values("f_1", "V").tolist()


def test_parquet_has_model_and_seed(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    result = run_study(small_study(10))
    result.to_parquet(tmp_path / "all.parquet")
    table = parquet.read_table(tmp_path / "all.parquet")
    assert table.column("f_1").to_pylist() == [*result.values("f_1", "II"), *result.values("f_1", "V")]
    about = json.loads(table.schema.metadata[b"torsionnet"])
    assert (about["seed"], about["version"]) == (1, tn.__version__)


@pytest.mark.parametrize(("package", "write"), [("xarray", "to_xarray"), ("pyarrow", "to_parquet")])
def test_missing_extra(monkeypatch, tmp_path, package, write):
    monkeypatch.setitem(__import__("sys").modules, package, None)
    result = run_study(small_study(10))
    with pytest.raises(MissingExtraError, match="pip install"):
        getattr(result, write)(*([tmp_path / "file"] if write == "to_parquet" else []))


def test_unknown_names():
    result = run_study(small_study(10))
    with pytest.raises(UsageError, match=r'(?s)did you mean "f_1".*unknown-name'):
        result.values("f_2", "V")
    with pytest.raises(UsageError, match="name one of them"):
        result.values("f_1")
    with pytest.raises(UsageError, match="is a curve"):
        result.values("H", "V")


def test_words_of_work():
    assert Workload(1_234_567, 1e-3, 100, False).words == "1 234 567 variants, about 21 min on one core"
    assert shown_time(3e8).endswith("years")


def test_a_study_that_is_stopped_says_how_it_goes_on(tmp_path, monkeypatch):
    def stop(*_args, **_more):
        raise KeyboardInterrupt

    monkeypatch.setattr("torsionnet.study.run.run_chunks.run_study", stop)
    file = tmp_path / "plan.yaml"
    file.write_text(
        "torsionnet: 1\nmodel: amt_rig\nvary: {k_1: {type: list, values: [400, 460]}}\n"
        "quantities: {z: {type: damping_ratio, mode: 1}}\n",
        encoding="utf-8",
    )
    shown = CliRunner().invoke(app, ["study", str(file), "-o", str(tmp_path / "kept")])
    assert shown.exit_code != 0
    assert "the same command goes on from there" in shown.stderr


def test_a_long_table_is_shown_by_its_beginning(plan, tmp_path):
    plan.write_text(PLAN.replace("points: 4", "points: 150") + "answers: {b: {type: percentile_bands, quantity: H}}\n")
    file = tmp_path / "b.csv"
    shown = run(str(plan), "--csv", str(file)).output
    assert "10 of 150 lines; --csv FILE and --json have all" in shown
    assert shown.count("\n") < 40
    assert sum(len(one.read_text().splitlines()) for one in tmp_path.glob("*b*.csv")) > 150
    assert run(str(plan), "--json").output.count("\n") > 150


def test_a_result_is_named_in_a_line():
    assert repr(run_study(small_study(count=20))) == "<StudyResult 'study of AMT test rig': 40 variants, f_1, H>"


def test_variants_without_a_value_are_counted():
    vary = {"c_2": {"type": "list", "values": [4, 100]}}
    result = run_study(tn.study.define(tn.load("dmf_rig"), vary, {"z": {"type": "damping_ratio", "mode": 1}}))
    assert np.isnan(result.values("z")).tolist() == [False, True]
    assert "z has no finite value in 1 of 2 variants" in result.notes


def test_an_answer_that_cannot_be_found_takes_no_other_along(plan):
    """Three variants are too few for rank correlations; the tornado is shown, and the study counts as failed."""
    plan.write_text(PLAN + "answers:\n  clouds: {type: scatter}\n  single: {type: tornado}\n")
    found = run(str(plan), code=3)
    assert "error: clouds: 3 variants" in found.stderr
    assert "k_2 moves it most" in found.stdout
    data = json.loads(run(str(plan), "--json", code=3).stdout)
    assert list(data["answers"]) == ["single"]
    assert list(data["unanswered"]) == ["clouds"]


def test_missing_extras_are_told_before_anything_is_calculated(plan, tmp_path, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    monkeypatch.setattr("torsionnet.study.run.run_chunks.run_study", lambda *_, **__: pytest.fail("it has begun"))
    assert "torsionnet[parquet]" in run(str(plan), "--variants", str(tmp_path / "all.parquet"), code=4).stderr
    two = "  g: {type: pareto, minimise: [f_1, z_1], population: 8}\n"
    plan.write_text(PLAN + "  z_1: {type: damping_ratio, mode: 1}\nanswers:\n" + two)
    monkeypatch.setattr("torsionnet.study.design.pareto.find_spec", lambda _: None)
    assert "torsionnet[pareto]" in run(str(plan), code=4).stderr
