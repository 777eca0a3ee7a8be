"""Names that moved are found under their old places too, with a warning that says where they are now."""

import pytest

import torsionnet as tn

PLOTS = [
    "bode",
    "circle",
    "coherence",
    "comparison",
    "correlation",
    "fit",
    "mac_matrix",
    "mode_shapes",
    "order_map",
    "save",
    "schematic",
    "spectrogram",
    "stabilisation",
    "sweep_harmonics",
    "time_histories",
    "tornado",
]

LATER = {"damper_design", "half_ranges", "interference_diagram", "order_response", "star_diagrams", "waveform"}


@pytest.mark.parametrize(("old", "new"), [("document", "report"), ("interchange", "io")])
def test_packages_that_were_renamed(old, new):
    with pytest.warns(DeprecationWarning, match=rf"torsionnet\.{old} is called torsionnet\.{new} now"):
        assert getattr(tn, old) is getattr(tn, new)


@pytest.mark.parametrize("name", PLOTS)
def test_pictures_under_the_name_of_reports(name):
    with pytest.warns(DeprecationWarning, match=rf"torsionnet\.report\.{name} is torsionnet\.plot\.{name} now"):
        assert getattr(tn.report, name) is getattr(tn.plot, name)


LATER = {
    "STYLE",
    "contour_map",
    "damper_design",
    "damper_over_conditions",
    "design_optimum",
    "failure_probabilities",
    "half_ranges",
    "interference_diagram",
    "limit_check",
    "limit_shares",
    "nyquist",
    "order_overlay",
    "order_response",
    "parallel_coordinates",
    "pareto_front",
    "percentile_bands",
    "robust_optimum",
    "scatter_matrix",
    "sobol_indices",
    "star_diagrams",
    "study_tornado",
    "waterfall",
    "waveform",
    "worst_variants",
}
"""Pictures that torsionnet.report never had."""


def test_no_other_names_are_invented():
    assert sorted(PLOTS) == sorted(set(tn.plot.__all__) - LATER)
    for package in (tn, tn.report, tn.io, tn.signals):
        with pytest.raises(AttributeError, match="nothing_there"):
            getattr(package, "nothing_there")  # noqa: B009


def test_records_are_read_by_either_name():
    for name in ("iter_blocks", "read_recording", "write_recording"):
        assert getattr(tn.signals, name) is getattr(tn.io, name)
        assert name in tn.signals.__all__


def test_every_public_name_is_there():
    for package in (tn, tn.bench, tn.identification, tn.io, tn.modal, tn.plot, tn.report, tn.sensitivity, tn.signals):
        for name in set(package.__all__) - {"document", "interchange"}:
            assert getattr(package, name) is not None, name
