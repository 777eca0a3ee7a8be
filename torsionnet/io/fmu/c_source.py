"""C code of a drivetrain's FMU, with sizes, start values, and a function from parameters to all matrices."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from torsionnet.io.fmu.traced_matrices import System
from torsionnet.io.fmu.traced_numbers import Traced
from torsionnet.io.fmu.variables import Variables

HEADER = """/* Sizes of this model. */

#define TN_TOKEN "{token}"
#define TN_H {heavy} /* coordinates with inertia */
#define TN_B {damped} /* massless, with dampers */
#define TN_S {static} /* massless, with springs alone */
#define TN_U {inputs}
#define TN_Y {outputs}
#define TN_P {parameters}
#define TN_Q {derived}
"""
"""Template of ``model.h`` of an FMU, with numbers of coordinates by kind, signals and parameters."""

MODEL = """/* {title}: its matrices, from its parameters in SI units.

   Coordinates: {coordinates}
   Inputs: {inputs}
   Outputs: {outputs} */

#define M(i, j) m->M[(i) * TN_N + (j)]
#define C(i, j) m->C[(i) * TN_N + (j)]
#define K(i, j) m->K[(i) * TN_N + (j)]
#define L(i, j) m->L[(i) * TN_U + (j)]
#define R0(i, j) m->R0[(i) * TN_N + (j)]
#define R1(i, j) m->R1[(i) * TN_N + (j)]
#define R2(i, j) m->R2[(i) * TN_N + (j)]
#define F(i, j) m->F[(i) * TN_U + (j)]

static const double tn_start[] = {{{start}0}};

static void tn_fill(const double *p, double *derived, tn_mechanics *m)
{{
{body}
}}

#undef M
#undef C
#undef K
#undef L
#undef R0
#undef R1
#undef R2
#undef F
"""
"""Template of ``model.c`` of an FMU, with start values of the parameters and the function that fills the matrices."""


def header_source(system: System, variables: Variables, token: str) -> str:
    """Text of ``model.h`` of an FMU, with the sizes of the model and the token."""
    motion = system.motion
    return HEADER.format(
        token=token,
        heavy=len(motion.heavy),
        damped=len(motion.damped),
        static=len(motion.static),
        inputs=len(system.inputs),
        outputs=len(system.outputs),
        parameters=len(variables.open),
        derived=len(variables.derived),
    )


def model_source(system: System, variables: Variables, title: str) -> str:
    """Text of ``model.c`` of an FMU, with start values of the parameters, and the function that fills the matrices."""
    code = _Code(system, {name: number for number, name in enumerate(variables.open)})
    wanted = [*variables.derived.values(), *(v for entries in system.matrices.values() for _, _, v in entries)]
    lines = code.steps(wanted)
    lines += [f"derived[{place}] = {code.name(v)};" for place, v in enumerate(variables.derived.values())]
    for letter, entries in system.matrices.items():
        lines += [f"{letter}({i}, {j}) = {code.name(value)};" for i, j, value in entries]
    return MODEL.format(
        title=_comment(title),
        coordinates=_comment(", ".join(system.coordinates)),
        inputs=_comment(", ".join(system.inputs)),
        outputs=_comment(", ".join(system.outputs)),
        start="".join(f"{literal(value)}, " for value in variables.open.values()),
        body="\n".join(f"    {line}" for line in lines),
    )


@dataclass(frozen=True)
class _Code:
    """Names in C of numbers on the tape of calculations; ``numbers`` says where in p a parameter is."""

    system: System
    numbers: Mapping[str, int]

    def steps(self, wanted: Iterable[Traced]) -> list[str]:
        """Lines of C that calculate the numbers on the tape, each once."""
        places = self.system.motion.tape.needed(wanted)
        return [f"const double {self._place(place)} = {self._operation(place)};" for place in places]

    def _operation(self, place: int) -> str:
        sign, *parts = self.system.motion.tape.operations[place]
        if sign == "parameter":
            return f"p[{self.numbers[parts[0]]}]"
        names = [self.name(part) for part in parts]
        return f"sqrt({names[0]})" if sign == "sqrt" else f"{names[0]} {sign} {names[1]}"

    def name(self, number: Traced) -> str:
        """Text in C of a number on the tape, the variable that holds it, or the literal of a constant."""
        return literal(float(number.value)) if number.place is None else self._place(number.place)

    def _place(self, place: int) -> str:
        sign, *parts = self.system.motion.tape.operations[place]
        if sign != "parameter":
            return f"v{place}"
        # The number tells left.k from left_k.
        dotted = "." in parts[0]
        return f"p{self.numbers[parts[0]]}_{parts[0].replace('.', '_')}" if dotted else f"p_{parts[0]}"


def literal(value: float) -> str:
    """Text of a double-precision number in C, to the last digit.

    >>> literal(460.0), literal(-0.1)
    ('460.0', '(-0.1)')
    """
    return f"({value!r})" if value < 0 else repr(float(value))


def _comment(text: str) -> str:
    """Text for a C comment, on one line, in ASCII, and without what would end the comment."""
    plain = " ".join(text.split()).encode("ascii", "replace").decode()
    return plain.replace("*/", "* /").replace("/*", "/ *").replace("\\", "/").replace("??", "? ?")
