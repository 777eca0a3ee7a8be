"""Results of calculations and tests, frequency responses, modes, order responses, limits and tables of them."""

from torsionnet.core.lazy_imports import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Channel": "torsionnet.response.frequency_response",
        "Column": "torsionnet.response.table",
        "Conventions": "torsionnet.response.conventions",
        "FrequencyResponse": "torsionnet.response.frequency_response",
        "FrequencyResponses": "torsionnet.response.variant_responses",
        "Modes": "torsionnet.response.modes",
        "SI": "torsionnet.response.conventions",
        "Table": "torsionnet.response.table",
    },
)
