"""What ``--json`` prints, as JSON Schema, by command."""

from __future__ import annotations

import json

from torsionnet.core.entries.spec import Schema

TEXT: Schema = {"type": "string"}
TEXTS: Schema = {"type": "array", "items": TEXT}
YES_OR_NO: Schema = {"type": "boolean"}
COUNT: Schema = {"type": "integer", "minimum": 0}
NUMBER: Schema = {"type": ["number", "null"], "description": "null where it is infinite or not determined"}


def text_or_nothing() -> Schema:
    return {"type": ["string", "null"]}


def listed(items: Schema) -> Schema:
    return {"type": "array", "items": items}


def by_name(values: Schema) -> Schema:
    return {"type": "object", "additionalProperties": values}


def record(optional: dict[str, Schema] | None = None, /, **fields: Schema) -> Schema:
    """An object with these fields, and maybe the optional ones."""
    return {
        "type": "object",
        "properties": {**fields, **(optional or {})},
        "required": list(fields),
        "additionalProperties": False,
    }


def or_null(schema: Schema) -> Schema:
    return {"anyOf": [schema, {"type": "null"}]}


VERDICT: Schema = {"enum": ["pass", "barred range", "incomplete", "not judged", "fail"]}
NUMBERS = listed(NUMBER)
ROWS = listed(NUMBERS)
PAIR: Schema = {**NUMBERS, "minItems": 2, "maxItems": 2}
COMPLEX: Schema = {**PAIR, "description": "real and imaginary part"}
CURVE: dict[str, Schema] = {
    "output": TEXT,
    "input": TEXT,
    "quantity": TEXT,
    "unit": TEXT,
    "real": NUMBERS,
    "imag": NUMBERS,
}
ESTIMATE = record(
    title=TEXT,
    notes=TEXTS,
    usable_up_to_Hz=NUMBER,
    frequencies_Hz=NUMBERS,
    responses=listed(record(**CURVE, coherence=or_null(NUMBERS))),
)
OVER_POINTS: Schema = {"anyOf": [NUMBER, NUMBERS], "description": "of a curve one for each point"}
OVER_VARIANTS = record(
    {"over": {"enum": ["frequency", "speed"]}, "points": NUMBERS},
    quantity=TEXT,
    configuration=TEXT,
    unit=TEXT,
    variants=OVER_POINTS,
    mean=OVER_POINTS,
    standard_deviation=OVER_POINTS,
    smallest=OVER_POINTS,
    smallest_at=OVER_POINTS,
    largest=OVER_POINTS,
    largest_at=OVER_POINTS,
    percentiles={"anyOf": [NUMBERS, ROWS]},
)
POSITION = record(file=TEXT, line=COUNT, column=COUNT, end_column=COUNT, source=TEXT)
FAULT = record(
    severity={"enum": ["error", "warning", "note"]},
    message=TEXT,
    meant=text_or_nothing(),
    configuration=text_or_nothing(),
    path=listed({"type": ["string", "integer"]}),
    position=or_null(POSITION),
    used_at=listed(POSITION),
    defined_at=or_null(POSITION),
)
NUMBER_OF_MODE: Schema = {"type": ["integer", "null"], "description": "null for rigid bodies and real poles"}
KIND: Schema = {"enum": ["rigid body", "real pole", "oscillatory"]}
MODE = record(
    mode=NUMBER_OF_MODE,
    kind=KIND,
    natural_frequency_Hz=NUMBER,
    damped_frequency_Hz=NUMBER,
    damping_ratio=NUMBER,
    eigenvalue_rad_per_s=COMPLEX,
    converged=YES_OR_NO,
    description=TEXT,
    shape=by_name(COMPLEX),
    energy_shares=by_name(record(kinetic=NUMBER, strain=NUMBER, dissipated=NUMBER)),
)
IDENTIFIED = record(
    mode=COUNT,
    kind=KIND,
    natural_frequency_Hz=NUMBER,
    standard_error_Hz=NUMBER,
    damping_ratio=NUMBER,
    standard_error=NUMBER,
    pole_rad_per_s=COMPLEX,
    shape=by_name(COMPLEX),
)
EXPLANATION = record(
    kind=TEXT,
    of=TEXT,
    unknown=TEXT,
    values=by_name(NUMBER),
    standard_errors=by_name(NUMBER),
    before=NUMBER,
    complete=YES_OR_NO,
    left=NUMBER,
)
LACK = record(
    rejected=YES_OR_NO,
    measurements=listed(record(name=TEXT, ratio=NUMBER, size=NUMBER, probability=NUMBER)),
    explanations=listed(EXPLANATION),
    doubts=TEXTS,
)
FITTED = record(
    name=TEXT,
    value=NUMBER,
    standard_error=NUMBER,
    interval_95=PAIR,
    profile_95=or_null(PAIR),
    unit=TEXT,
    true=NUMBER,
)
MOTION = {
    "coordinates": TEXTS,
    "equations": TEXTS,
    "dependent": by_name(TEXT),
    "conditions": TEXTS,
    **dict.fromkeys("MCK", listed(TEXTS)),
}
EQUATIONS = record(**MOTION)
TRANSFER_FUNCTION = record(
    {"left_out": TEXTS, "band": PAIR, "errors": record(omega=NUMBER, zeta=NUMBER, decibels=NUMBER)},
    configuration=TEXT,
    transfer_function=TEXT,
    text=TEXT,
)
RANKED = record(
    kind=TEXT, of=TEXT, unknown=TEXT, before=NUMBER, value=NUMBER, misfit=NUMBER, left=NUMBER, explains=YES_OR_NO
)
COMPARED = record(name=TEXT, unit=TEXT, frequencies_Hz=NUMBERS, misfit=NUMBER, measured=ROWS, fitted=ROWS)

CROSSING = record(
    mode=COUNT,
    excitation=TEXT,
    order=NUMBER,
    fixed_Hz=NUMBER,
    of_reference=NUMBER,
    undamped_rad_per_s=NUMBER,
    natural_rad_per_s=NUMBER,
    damped_rad_per_s=NUMBER,
    margin=NUMBER,
    required=NUMBER,
    generalised_force_Nm=NUMBER,
    relative_force=NUMBER,
    excited={"type": ["boolean", "null"], "description": "null where nothing says what acts"},
    excited_in=TEXTS,
    peaks=listed(record(output=TEXT, rad_per_s=NUMBER, amplitude=NUMBER)),
    star=listed(record(label=TEXT, node=TEXT, vector=COMPLEX)),
)
STATION = record(
    node=TEXT,
    ratio=NUMBER,
    inertia=NUMBER,
    amplitude=NUMBER,
    inertia_torque=NUMBER,
    joined=NUMBER,
    torque=NUMBER,
    link=or_null(record(elements=TEXTS, rigid=YES_OR_NO, stiffness=NUMBER, twist=NUMBER, stress=NUMBER)),
)

AT_LEVEL = record(at=NUMBER, level=NUMBER)

OUTPUTS: dict[str, Schema] = {
    "check": listed(record(model=TEXT, errors=COUNT, faults=listed(FAULT))),
    "library": listed(
        record(name=TEXT, kind={"enum": ["model", "part", "catalogue", "study"]}, what=TEXT, source=TEXT, file=TEXT)
    ),
    "modes": listed(
        record(
            title=TEXT,
            configuration=TEXT,
            notes=TEXTS,
            undamped_natural_frequencies_Hz=NUMBERS,
            nodes=TEXTS,
            modes=listed(MODE),
        )
    ),
    "frf": listed(
        record(
            title=TEXT,
            configuration=TEXT,
            notes=TEXTS,
            frequencies_Hz=NUMBERS,
            responses=listed(
                record(
                    **CURVE,
                    static=COMPLEX,
                    peaks=listed(record(frequency_Hz=NUMBER, magnitude=NUMBER, phase_deg=NUMBER)),
                )
            ),
        )
    ),
    "sensitivity": listed(
        record(
            title=TEXT,
            configuration=TEXT,
            parameters=TEXTS,
            values=NUMBERS,
            modes=listed(
                record(
                    mode=NUMBER_OF_MODE,
                    natural_frequency_Hz=NUMBER,
                    damping_ratio=NUMBER,
                    frequency_percent_per_percent=NUMBERS,
                    damping_percent_per_percent=NUMBERS,
                    d_frequency=NUMBERS,
                    d_damping=NUMBERS,
                )
            ),
            words=TEXTS,
        )
    ),
    "show": listed(
        record(
            {"equations": EQUATIONS, "matrices": record(coordinates=TEXTS, M=ROWS, C=ROWS, K=ROWS)},
            title=TEXT,
            configuration=TEXT,
            model={"type": "object", "description": "a model file, see torsionnet schema"},
            nodes=TEXTS,
            parameters=by_name(record(value=NUMBER, unit=TEXT)),
            mean_speeds_rad_per_s=by_name(NUMBER),
        )
    ),
    "equations": listed({"anyOf": [record(configuration=TEXT, **MOTION), TRANSFER_FUNCTION]}),
    "orders": listed(
        record(
            title=TEXT,
            configuration=TEXT,
            speed_of=TEXT,
            speeds_rpm=NUMBERS,
            common_cycle_revolutions={"type": ["integer", "null"], "description": "null where there is none"},
            outputs=listed(
                record(
                    {
                        "measured": listed(
                            record(of_reference=NUMBER, speeds_rpm=NUMBERS, measured=NUMBERS, calculated=NUMBERS)
                        ),
                        "angles_deg": {
                            **by_name(NUMBERS),
                            "description": "of engines that are not fixed to the first one, where the half range is "
                            "largest: by how much of its crank angle each fires later",
                        },
                        "smallest_half_range": {**NUMBERS, "description": "with these engines at the best angles"},
                        "smallest_at_deg": by_name(NUMBERS),
                    },
                    output=TEXT,
                    unit=TEXT,
                    half_range=NUMBERS,
                    rms=NUMBERS,
                    cases={"type": ["array", "null"], "items": TEXT, "description": "what is worst at each speed"},
                    orders=listed(
                        record(
                            excitation=TEXT,
                            order=NUMBER,
                            fixed_Hz=NUMBER,
                            of_reference=NUMBER,
                            real=NUMBERS,
                            imag=NUMBERS,
                        )
                    ),
                    sums=listed(record(lines=TEXT, fixed_Hz=NUMBER, of_reference=NUMBER, real=NUMBERS, imag=NUMBERS)),
                )
            ),
        )
    ),
    "critical-speeds": listed(
        record(
            title=TEXT,
            configuration=TEXT,
            speed_of=TEXT,
            speed_range_rad_per_s=PAIR,
            margin_rule=text_or_nothing(),
            modes=listed(
                record(
                    mode=COUNT,
                    undamped_natural_frequency_Hz=NUMBER,
                    natural_frequency_Hz=NUMBER,
                    damped_frequency_Hz=NUMBER,
                    damping_ratio=NUMBER,
                    amplification=NUMBER,
                    similarity=NUMBER,
                    shape=by_name(COMPLEX),
                )
            ),
            crossings=listed(CROSSING),
        )
    ),
    "margins": listed(
        record(
            title=TEXT,
            configuration=TEXT,
            controller=TEXT,
            stable=YES_OR_NO,
            **dict.fromkeys(
                ("gain_increase", "gain_decrease", "phase_deg", "delay_s", "modulus"),
                record(value=NUMBER, frequency_Hz=NUMBER),
            ),
        )
    ),
    "holzer": listed(
        record(
            title=TEXT,
            configuration=TEXT,
            mode={"type": ["integer", "null"], "description": "null for a trial frequency"},
            frequency_Hz=NUMBER,
            referred_to=TEXT,
            remainder_Nm=NUMBER,
            relative_remainder=NUMBER,
            notes=TEXTS,
            branches=listed(record(joins=text_or_nothing(), stations=listed(STATION))),
        )
    ),
    "static": listed(
        record(
            title=TEXT,
            configuration=TEXT,
            speed_of=TEXT,
            speed_rpm=NUMBER,
            external=listed(record(node=TEXT, torque=NUMBER)),
            elements=listed(
                record(
                    element=TEXT,
                    port=TEXT,
                    **dict.fromkeys(("speed", "torque", "twist", "stress", "power"), or_null(NUMBER)),
                )
            ),
            notes=TEXTS,
        )
    ),
    "limits": listed(
        record(
            title=TEXT,
            configuration=TEXT,
            speed_of=TEXT,
            misfiring=YES_OR_NO,
            verdict=VERDICT,
            overall=record(verdict=VERDICT, conclusion=TEXT, not_examined=TEXTS, left_out=TEXTS, barred_rpm=ROWS),
            barred_rpm=ROWS,
            speeds_rpm=NUMBERS,
            limits=listed(
                record(
                    **dict.fromkeys(("limit", "of", "criterion", "quantity", "unit"), TEXT),
                    verdict=VERDICT,
                    **dict.fromkeys(("worst_rpm", "value", "allowed", "utilisation"), NUMBER),
                    barred_rpm=ROWS,
                    values=NUMBERS,
                    allowed_over_speed=NUMBERS,
                    **dict.fromkeys(("source", "formula", "not_covered"), TEXT),
                    remarks=TEXTS,
                )
            ),
            notes=TEXTS,
        )
    ),
    "damper": listed(
        record(
            title=TEXT,
            configuration=TEXT,
            output=TEXT,
            unit=TEXT,
            over=TEXT,
            parameters=listed(
                record(
                    name=TEXT,
                    unit=TEXT,
                    start=NUMBER,
                    lower=NUMBER,
                    upper=NUMBER,
                    value=NUMBER,
                    at_bound=text_or_nothing(),
                    values=NUMBERS,
                    largest=NUMBERS,
                )
            ),
            before=AT_LEVEL,
            after=AT_LEVEL,
            peaks=listed(AT_LEVEL),
            fixed_points=listed(record(at=NUMBER, level=NUMBER, spread=NUMBER)),
            words=TEXTS,
        )
    ),
    "estimate": ESTIMATE,
    "compare": record(
        test=ESTIMATE,
        model=ESTIMATE,
        difference_dB=NUMBERS,
        difference_deg=NUMBERS,
        summary=listed(record(what=TEXT, at_Hz=NUMBER, value=NUMBER, unit=text_or_nothing())),
        notes=TEXTS,
    ),
    "spectrogram": listed(
        record(channel=TEXT, unit=TEXT, notes=TEXTS, times_s=NUMBERS, frequencies_Hz=NUMBERS, amplitude=ROWS)
    ),
    "bench": listed(
        record(
            title=TEXT,
            configuration=TEXT,
            file=TEXT,
            sampling_rate_Hz=NUMBER,
            samples=COUNT,
            duration_s=NUMBER,
            notes=TEXTS,
            channels=listed(record(name=TEXT, unit=TEXT, smallest=NUMBER, largest=NUMBER, RMS=NUMBER, notes=TEXTS)),
        )
    ),
    "study": record(
        {
            "count": COUNT,
            "seed": or_null(COUNT),
            "model": TEXT,
            "version": TEXT,
            "percentiles": NUMBERS,
            "quantities": listed(OVER_VARIANTS),
            "notes": TEXTS,
            "unanswered": by_name(TEXT),
        },
        title=TEXT,
        answers=by_name(record(sentences=TEXTS, numbers={"description": "as the type of the answer has them"})),
    ),
    "fit": record(
        {"ranking": listed(RANKED)},
        title=TEXT,
        parameters=listed(FITTED),
        correlation=ROWS,
        chi_squared=NUMBER,
        degrees_of_freedom=COUNT,
        aicc=NUMBER,
        verdicts=TEXTS,
        lack_of_fit=or_null(LACK),
        notes=TEXTS,
        measurements=listed(COMPARED),
    ),
    "identify-modes": record(
        {
            "against_model": listed(
                record(identified=COUNT, model=NUMBER_OF_MODE, frequency_error=NUMBER, damping_error=NUMBER)
            )
        },
        title=TEXT,
        method=TEXT,
        notes=TEXTS,
        modes=listed(IDENTIFIED),
    ),
}


def output_schema_text(command: str) -> str:
    """JSON Schema of what a command prints with ``--json``."""
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": f"torsionnet {command} --json"}
    return json.dumps({**head, **OUTPUTS[command]}, indent=1) + "\n"
