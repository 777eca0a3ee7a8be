"""Documents of plants drawn at random: every number that follows from others does so in the digits printed."""

import pytest
from support.campaigns import by_day
from support.drawn_documents import drawn_plant, printed
from support.printed_checks import document_faults


@pytest.mark.slow
@pytest.mark.parametrize("seed", by_day(range(60), 9, 14, 17))
def test_printed_digits_follow_from_each_other(seed):
    assert document_faults(printed(drawn_plant(seed))) == []
