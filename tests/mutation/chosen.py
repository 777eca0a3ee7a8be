"""Which tests look at which module: the first entry that a path begins with; beside the module's own doctests."""

from __future__ import annotations

PACKAGES = tuple(
    f"torsionnet/{name}" for name in ("solve", "assembly", "response", "signals", "modal", "identification")
)

ELIMINATION = ("test_row_algebra", "test_transfer", "test_closed_forms", "test_state_space", "test_starmesh")
RESPONSES = ("test_transfer", "test_closed_forms", "test_state_space")
EIGENVALUES = ("test_modes", "test_eigen", "test_closed_forms", "test_damping")
MODAL_FIT = ("test_modal_parts", "test_modal_single", "test_modal_shapes", "test_modal_report", "test_modal_fit")
FIT = ("test_fit_closed_forms", "test_identification", "test_virtual_chain")
RECORDS = ("test_recordings", "test_processing")

CHOSEN: dict[str, tuple[str, ...]] = {
    "torsionnet/solve/cut": ("test_cut", "test_closed_forms", *EIGENVALUES),
    "torsionnet/solve/pencil": ("test_cut", "test_closed_forms", *EIGENVALUES),
    "torsionnet/solve/eigen": EIGENVALUES,
    "torsionnet/solve/frozen": EIGENVALUES,
    "torsionnet/solve/modes": EIGENVALUES,
    "torsionnet/solve/reduction": (*EIGENVALUES, "test_lowest"),
    "torsionnet/solve/refine": (*EIGENVALUES, "test_lowest"),
    "torsionnet/solve/triangular": EIGENVALUES,
    "torsionnet/solve/words": EIGENVALUES,
    "torsionnet/solve/lowest": ("test_lowest",),
    "torsionnet/solve/by_spectrum": ("test_modes", "test_lowest"),
    "torsionnet/solve/spectrum": ("test_modes", "test_lowest"),
    "torsionnet/solve/peaks": ("test_paper", "test_validation", "test_cli"),
    "torsionnet/solve/simulate": ("test_simulate", "test_bench"),
    "torsionnet/solve/state_space": ("test_simulate", "test_state_space"),
    "torsionnet/solve/variants": ("test_variants", "test_transfer"),
    "torsionnet/solve/graph_plan": ELIMINATION,
    "torsionnet/solve/row_algebra": ELIMINATION,
    "torsionnet/solve/starmesh": ELIMINATION,
    "torsionnet/solve/compiled": ELIMINATION,
    "torsionnet/solve/sweep": ELIMINATION,
    "torsionnet/solve/tape": ELIMINATION,
    "torsionnet/solve": RESPONSES,
    "torsionnet/assembly/symbolic": ("test_symbolic", "test_closed_forms"),
    "torsionnet/assembly/law_stiffness": ("test_transfer", "test_damping", "test_state_space"),
    "torsionnet/assembly": ("test_closed_forms", "test_transfer", "test_paper", "test_state_space", "test_modes"),
    "torsionnet/response": ("test_results", "test_response", "test_modes", "test_transfer", "test_variants"),
    "torsionnet/signals/excitation": ("test_excitation",),
    "torsionnet/signals/files": ("test_recordings",),
    "torsionnet/signals/resolution": ("test_bench", "test_estimation"),
    "torsionnet/signals/calculus": RECORDS,
    "torsionnet/signals/checks": RECORDS,
    "torsionnet/signals/decimation": RECORDS,
    "torsionnet/signals/detrending": RECORDS,
    "torsionnet/signals/encoder": RECORDS,
    "torsionnet/signals/faults_in_values": RECORDS,
    "torsionnet/signals/harmonics": (*RECORDS, "test_bench"),
    "torsionnet/signals/orders": RECORDS,
    "torsionnet/signals/recording": RECORDS,
    "torsionnet/signals/resampling": RECORDS,
    "torsionnet/signals/spectrogram": RECORDS,
    "torsionnet/signals/timing": RECORDS,
    "torsionnet/signals": ("test_advice", "test_estimation", "test_processing", "test_recordings", "test_bench"),
    "torsionnet/modal": MODAL_FIT,
    "torsionnet/identification/operator": ("test_same_estimator", *FIT),
    "torsionnet/identification/files": ("test_fit_files", "test_cli_fit"),
    "torsionnet/identification/saving": ("test_cli_fit", *FIT),
    "torsionnet/identification/words": (*FIT, "test_cli_fit"),
    "torsionnet/identification": FIT,
}


def chosen_for(module: str) -> list[str]:
    """Files of tests, fast ones first."""
    chosen = next((names for start, names in CHOSEN.items() if module.startswith(start)), None)
    if chosen is None:
        msg = f"{module}: no tests are chosen for it in tests/mutation/chosen.py"
        raise SystemExit(msg)
    return [f"tests/{name}.py" for name in dict.fromkeys(chosen)]
