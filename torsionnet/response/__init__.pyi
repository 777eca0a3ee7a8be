# Written by `make generate`.
from torsionnet.response.conventions import Conventions as Conventions
from torsionnet.response.conventions import SI as SI
from torsionnet.response.frequency_response import Channel as Channel
from torsionnet.response.frequency_response import FrequencyResponse as FrequencyResponse
from torsionnet.response.modes import Modes as Modes
from torsionnet.response.table import Column as Column
from torsionnet.response.table import Table as Table
from torsionnet.response.variant_responses import FrequencyResponses as FrequencyResponses

__all__ = [
    "Channel",
    "Column",
    "Conventions",
    "FrequencyResponse",
    "FrequencyResponses",
    "Modes",
    "SI",
    "Table",
]
