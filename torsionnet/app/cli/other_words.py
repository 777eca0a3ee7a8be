"""Words from other programs and textbooks that name no command here, and what does the same; read on a miss alone."""

from __future__ import annotations

SAME = {
    "frf --plot bode.png": "bode bodeplot bodemag freqresp freq response responses receptance mobility tf transfer",
    "margins --plot nyquist.png": "nyquist margin stability allmargin",
    "modes": "eig eigs eigenvalues eigenfrequencies poles pole damp frequencies modal pzmap natural-frequencies",
    "modes --shapes --plot shapes.png": "shape shapes mode-shapes eigenvectors modeshapes",
    "equations": "symbolic latex formula formulas eom motion",
    "equations --tf OUTPUT/INPUT": "transfer-function transfer-functions",
    "show --plot schematic.svg": "draw picture schematic scheme diagram graph view",
    "show --matrices": "matrix matrices mck",
    "frf --plot, orders --plot, modes --plot, show --plot": "plot plots figure",
    "simulate, with a scenario of the model": "step impulse lsim sim transient time scenario run integrate ode45",
    "critical-speeds --plot campbell.png": "campbell interference resonance resonances criticals lateral",
    "orders --plot orders.png --picture waterfall": "waterfall cascade",
    "orders": "forced harmonic harmonics excitation tvc tva torsional",
    "static": "mean balance power torque equilibrium",
    "limits": "fatigue stress barred allowable strength rules",
    "damper": "tune absorber optimize-damper optimise-damper",
    "study": "monte-carlo montecarlo tolerance tolerances sweep sobol optimize optimise optimization variants doe",
    "sensitivity": "tornado gradient derivatives influence",
    "explore": "gui app ui browser slider sliders open edit",
    "check": "lint validate verify test-model",
    "new": "init create template start",
    "library": "examples list models parts catalogue",
    "bench": "test measure virtual record",
    "estimate": "h1 h2 coherence tfestimate welch",
    "spectrogram": "fft psd spectrum stft signal",
    "track": "order-tracking rpmtrack ordertrack ordertracking vold-kalman",
    "angle": "teeth encoder pulses tacho tachometer speed",
    "fit": "identify identification calibrate update correlate updating",
    "identify-modes": "ema modalfit stabilisation stabilization lscf",
    "damping": "decay logdec decrement oma ambient run-up",
    "report": "document doc word docx pdf html approval",
    "export MODEL -o model.mat": "ss state-space statespace",
    "export": "convert matlab modelica fmu fmi simulink tors opentorsion write save",
    "import": "load read sheet",
    "language-server": "lsp editor",
    "--help": "help commands usage man",
    "--version": "version about",
}
"""Commands as they are typed behind ``torsionnet``, each with the words that people try for it."""


def same_command(word: str) -> str:
    """Command for what a word from elsewhere asks for, as it is typed; the empty string where nothing is known.

    >>> same_command("bode"), same_command("brake")
    ('torsionnet frf --plot bode.png', '')
    """
    return next((f"torsionnet {said}" for said, words in SAME.items() if word.lower() in words.split()), "")
