"""Page in the browser, served from this machine, to play with a drivetrain: sliders, responses and modes at once.

:class:`Documents` hold the texts of the page, one for each tab, and a :class:`Session` holds the model of one; an
:class:`ExploreServer` shows them to the browser and answers the page's questions (:mod:`torsionnet.app.explore.api`).
Everything is calculated here; the page in ``static/`` draws. Neither loads anything from elsewhere.

>>> from torsionnet.app.explore.answers import answer
>>> from torsionnet.app.explore.state import State
>>> session = open_session("amt_rig")
>>> data = answer(session, State({"gear": "V"}, {"c_O": "360 N*m*s/rad"}))
>>> round(data["modes"]["natural"][0], 3)
6.268
"""

from torsionnet.app.explore.documents import Documents, open_documents
from torsionnet.app.explore.server import ExploreServer
from torsionnet.app.explore.session import Session, open_session

__all__ = ["Documents", "ExploreServer", "Session", "open_documents", "open_session"]
