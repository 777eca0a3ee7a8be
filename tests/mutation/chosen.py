"""Which tests look at which module: the first entry that a path begins with; beside the module's own doctests."""

from __future__ import annotations

PACKAGES = tuple(
    f"torsionnet/{name}"
    for name in ("solve", "assembly", "response", "signals", "modal", "identification", "io/records", "io/formats")
)

ALWAYS = ("test_small_parts",)
RESPONSES = ("test_oracle", "test_transfer", "test_variants", "test_closed_forms", "test_state_space", "test_graph")
EIGENVALUES = ("test_oracle", "test_modes", "test_eigen", "test_closed_forms", "test_damping")
MODAL_FIT = ("test_modal_parts", "test_modal_single", "test_modal_shapes", "test_modal_report", "test_modal_fit")
FIT = ("test_fit_closed_forms", "test_identification", "test_virtual_chain")
RECORDS = ("test_recordings", "test_processing", "test_pulses", "test_disturbed_records")

CHOSEN: dict[str, tuple[str, ...]] = {
    "torsionnet/solve/responses/by_spectrum": ("test_simulate", "test_oracle"),
    "torsionnet/solve/modes/cut_drivetrain": ("test_cut", *EIGENVALUES),
    "torsionnet/solve/modes/eigen": EIGENVALUES,
    "torsionnet/solve/modes/frozen_stiffness": EIGENVALUES,
    "torsionnet/solve/responses/grid": ("test_solver_parts", "test_transfer"),
    "torsionnet/solve/modes/lowest_modes": ("test_lowest",),
    "torsionnet/solve/modes/modes": EIGENVALUES,
    "torsionnet/solve/modes/modular_arithmetic": ("test_cut", *EIGENVALUES),
    "torsionnet/solve/dynamic_stiffness/nullspace": ("test_cut", *EIGENVALUES),
    "torsionnet/solve/modes/bordered_system": ("test_cut", *EIGENVALUES),
    "torsionnet/solve/responses/peaks": ("test_solver_parts", "test_paper"),
    "torsionnet/solve/modes/bordered_poles": ("test_cut", *EIGENVALUES),
    "torsionnet/solve/dynamic_stiffness/reduction": EIGENVALUES,
    "torsionnet/solve/modes/ehrlich_aberth": EIGENVALUES,
    "torsionnet/solve/dynamic_stiffness/row_algebra": ("test_row_algebra", *RESPONSES),
    "torsionnet/solve/running/simulate": ("test_simulate", "test_bench"),
    "torsionnet/solve/modes/spectrum": ("test_lowest", *EIGENVALUES),
    "torsionnet/solve/dynamic_stiffness/state_space": ("test_simulate", "test_state_space"),
    "torsionnet/solve/dynamic_stiffness/triangular": ("test_solver_parts", "test_simulate"),
    "torsionnet/solve/batch/variants": ("test_variants", "test_transfer"),
    "torsionnet/solve/modes/mode_descriptions": EIGENVALUES,
    "torsionnet/solve": RESPONSES,
    "torsionnet/assembly/symbolic": ("test_symbolic", "test_symbolic_frf", "test_closed_forms"),
    "torsionnet/assembly/law_stiffness": (*RESPONSES, "test_damping"),
    "torsionnet/assembly": (*RESPONSES, "test_paper", "test_modes"),
    "torsionnet/response/recording": RECORDS,
    "torsionnet/response": ("test_results", "test_response", "test_modes", "test_transfer", "test_variants"),
    "torsionnet/signals/excitation": ("test_excitation",),
    "torsionnet/io/records": ("test_recordings",),
    "torsionnet/io/formats": ("test_recordings", "test_interchange_responses"),
    "torsionnet/signals/resolution": ("test_bench", "test_estimation"),
    "torsionnet/signals/bandlimited": RECORDS,
    "torsionnet/signals/calculus": RECORDS,
    "torsionnet/signals/recording_checks": RECORDS,
    "torsionnet/signals/decimation": RECORDS,
    "torsionnet/signals/detrending": RECORDS,
    "torsionnet/signals/double_pulses": RECORDS,
    "torsionnet/signals/encoder": RECORDS,
    "torsionnet/signals/value_faults": RECORDS,
    "torsionnet/signals/standstill": RECORDS,
    "torsionnet/signals/harmonics": (*RECORDS, "test_bench"),
    "torsionnet/signals/order_tracking": RECORDS,
    "torsionnet/signals/pulses": RECORDS,
    "torsionnet/signals/resampling": RECORDS,
    "torsionnet/signals/spectrogram": RECORDS,
    "torsionnet/signals/spikes": RECORDS,
    "torsionnet/signals/timing": RECORDS,
    "torsionnet/signals": ("test_advice", "test_estimation", "test_processing", "test_recordings", "test_bench"),
    "torsionnet/modal": MODAL_FIT,
    "torsionnet/identification/residuals/windowed_estimate": ("test_same_estimator", *FIT),
    "torsionnet/identification/fit_file": ("test_fit_files", "test_cli_fit"),
    "torsionnet/identification/fit_saving": ("test_cli_fit", *FIT),
    "torsionnet/identification/verdict_words": (*FIT, "test_cli_fit"),
    "torsionnet/identification": FIT,
}


def chosen_for(module: str) -> list[str]:
    """Files of tests, fast ones first."""
    chosen = next((names for start, names in CHOSEN.items() if module.startswith(start)), None)
    if chosen is None:
        raise SystemExit(f"{module}: no tests are chosen for it in tests/mutation/chosen.py")
    return [f"tests/{name}.py" for name in dict.fromkeys((*ALWAYS, *chosen))]
