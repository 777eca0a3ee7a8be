"""Which BLAS kernels the processor can run besides its own: ``python tests/support/kernels.py next COMMAND`` runs a command with the next one below it.

OpenBLAS rounds differently from one kernel to the next; the variable OPENBLAS_CORETYPE chooses one by name.
"""

import os
import subprocess
import sys

BELOW = {
    **dict.fromkeys(("SkylakeX", "Cooperlake", "SapphireRapids"), "Haswell"),
    # Those of AMD from Zen on are the kernels of Haswell, hardly changed.
    **dict.fromkeys(
        ("Haswell", "Zen", "Excavator", "Steamroller", "Piledriver", "Bulldozer", "Sandybridge"), "Nehalem"
    ),
}
"""The kernel with the next smaller set of instructions, for each that OpenBLAS chooses by itself on x86."""

ASK = """
import numpy, threadpoolctl
print(*{one.get("architecture") for one in threadpoolctl.threadpool_info() if one["internal_api"] == "openblas"})
"""


class NoOtherKernelError(Exception):
    """Says why no other kernel can be had."""


def kernel(chosen=None):
    """The name of the kernel that a new process works with: the processor's own, or what it makes of a chosen name."""
    environment = {**os.environ, "OPENBLAS_CORETYPE": chosen} if chosen else os.environ
    names = subprocess.run(
        [sys.executable, "-c", ASK], env=environment, capture_output=True, text=True, check=True
    ).stdout.split()
    if not names:
        raise NoOtherKernelError("numpy's BLAS is not OpenBLAS")
    return names[0]


def lower(own=None):
    """The kernel below the processor's own, or below a given one, tried in a process of its own."""
    own = own or kernel()
    if own not in BELOW:
        raise NoOtherKernelError(f"below the kernel {own} there is none that is compared")
    if kernel(BELOW[own]) != BELOW[own]:
        raise NoOtherKernelError(f"this OpenBLAS was built without the kernel {BELOW[own]}")
    return BELOW[own]


def all_lower():
    """All kernels below the processor's own, the next one first."""
    names = [lower()]
    while names[-1] in BELOW:
        names.append(lower(names[-1]))
    return names


def own_and_lower():
    """The processor's own kernel, then those below it; one empty name, which chooses nothing, where BLAS is another."""
    try:
        names = [kernel()]
    except NoOtherKernelError:
        return [""]
    try:
        return names + all_lower()
    except NoOtherKernelError:
        return names


def dispatched():
    """The sets of instructions for which numpy has code of its own and that this processor has."""
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

    return [name for name in __cpu_dispatch__ if __cpu_features__.get(name)]


def without_vectors():
    """The variable that leaves numpy the instructions which all processors have."""
    return {"NPY_DISABLE_CPU_FEATURES": " ".join(dispatched())}


def main(words):
    """Run a command with the next kernel, or with the lowest and without numpy's vector code; 0 where there is no other."""
    which, *command = words
    try:
        changes = {"OPENBLAS_CORETYPE": lower() if which == "next" else all_lower()[-1]}
    except NoOtherKernelError as reason:
        sys.stdout.write(f"no other kernel to try: {reason}\n")
        return 0
    if which == "lowest":
        changes |= without_vectors()
    sys.stdout.write(f"BLAS kernel {changes}\n")
    sys.stdout.flush()
    return subprocess.run(command, env=os.environ | changes, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
