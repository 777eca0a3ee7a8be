"""Requests of the explore page, from JSON to JSON."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeAlias

from torsionnet.app.explore.answers import answer, collected_notes, fault_texts, mode_motion, page_modes
from torsionnet.app.explore.disk_file import plain_line_ends
from torsionnet.app.explore.document import Answer, Document, OffsetCounting
from torsionnet.app.explore.documents import Documents
from torsionnet.app.explore.session import MANY_NODES, Session
from torsionnet.app.explore.state import PageRequest, State, read_request, read_state
from torsionnet.app.text.text_edits import TextSpan, as_parameter
from torsionnet.base.delimited.cell_grid import parse_grid
from torsionnet.base.errors import Fault, ModelError, TorsionnetError, UsageError
from torsionnet.model.files.library import MOST_BYTES
from torsionnet.model.sheets.mass_elastic_sheet import parse_sheet
from torsionnet.model.sheets.meanings import BY_KEY
from torsionnet.model.sheets.sheet_columns import is_inertia_heading

# Requests of the explore page on the text in its text pane, from JSON to JSON data.

MOST_SERVED = 1_500_000
"""Largest number of characters of a text in which names are completed, shown and changed; a model with 20 000 elements
has about as many, and the faults of a larger text are shown all the same."""


class TextQuestion:
    """Question on a text, or on a place in it, with what is needed to answer it."""

    def __init__(self, document: Document, request: PageRequest, *entries: str) -> None:
        request.only("text", *entries)
        self.text = request.text("text")
        if len(self.text) > MOST_SERVED:
            raise UsageError(f"the text is too large for this: more than {MOST_SERVED:,} characters".replace(",", " "))
        self.counting = OffsetCounting(self.text)
        self.offset = self.counting.from_page(request.number("at")) if "at" in entries else 0
        self.file, self.folder = str(document.options.path), document.options.folder

    @property
    def place(self) -> tuple[Any, ...]:
        """Arguments of a service on a place in a text."""
        return self.text, self.offset, self.file, self.folder

    def ranges(self, spans: Iterable[TextSpan]) -> Answer:
        """Stretches of the text as JSON data."""
        return {"ranges": [self.counting.span(span) for span in spans]}


def _changed(document: Document, request: PageRequest) -> Answer:
    request.only("revision", "text")
    return document.change(request.number("revision"), request.text("text"))


def _complete(document: Document, request: PageRequest) -> Answer:
    from torsionnet.app.text.completion import completions

    asked = TextQuestion(document, request, "at")
    options = [
        {
            "label": completion.label,
            "kind": completion.kind,
            "detail": completion.detail,
            "documentation": completion.documentation,
            "insert": completion.insert,
        }
        | asked.counting.span(completion.span)
        for completion in completions(*asked.place)
    ]
    return {"options": options}


def _hover(document: Document, request: PageRequest) -> Answer:
    from torsionnet.app.text.layout import hover

    asked = TextQuestion(document, request, "at")
    help_text = hover(*asked.place)
    return {} if help_text is None else {"html_free_text": help_text.markdown} | asked.counting.span(help_text.span)


def _definition(document: Document, request: PageRequest) -> Answer:
    from torsionnet.app.text.named_places import definition

    asked = TextQuestion(document, request, "at")
    span = definition(*asked.place)
    return asked.ranges([] if span is None else [span])


def _references(document: Document, request: PageRequest) -> Answer:
    from torsionnet.app.text.named_places import references

    asked = TextQuestion(document, request, "at")
    return asked.ranges(references(*asked.place))


def _rename(document: Document, request: PageRequest) -> Answer:
    from torsionnet.app.text.named_places import rename

    asked, name = TextQuestion(document, request, "at", "name"), request.short("name")
    return {"edits": asked.counting.edits(rename(asked.text, asked.offset, name, asked.file, asked.folder))}


def _format(document: Document, request: PageRequest) -> Answer:
    from torsionnet.app.text.layout import formatted

    asked = TextQuestion(document, request)
    return {"edits": asked.counting.edits(formatted(asked.text))}


def _outline(document: Document, request: PageRequest) -> Answer:
    from torsionnet.app.text.layout import OutlineItem, outline

    asked = TextQuestion(document, request)
    counting = asked.counting

    def data(item: OutlineItem) -> Answer:
        name = {"name_from": counting.to_page(item.name_span.start), "name_to": counting.to_page(item.name_span.end)}
        children = [data(child) for child in item.children]
        return (
            {"name": item.name, "kind": item.kind, "detail": item.detail, "children": children}
            | name
            | (counting.span(item.span))
        )

    return {"items": [data(item) for item in outline(asked.text, asked.file)]}


def _paste(document: Document, request: PageRequest) -> Answer:

    del document
    table = request.only("table").text("table")
    return pasted_model(table) if len(table) <= MOST_SERVED else {"no_table": True}


def _parameter(document: Document, request: PageRequest) -> Answer:
    asked = TextQuestion(document, request, "element", "entry", "symbol")
    element, entry, symbol = (request.short(key) for key in ("element", "entry", "symbol"))
    return {"edits": asked.counting.edits(as_parameter(asked.text, element, entry, symbol, asked.file))}


TEXT_QUESTIONS: Mapping[str, Callable[[Document, PageRequest], Answer]] = {
    "api/text": _changed,
    "api/complete": _complete,
    "api/hover": _hover,
    "api/definition": _definition,
    "api/references": _references,
    "api/rename": _rename,
    "api/format": _format,
    "api/outline": _outline,
    "api/paste": _paste,
    "api/parameter": _parameter,
}
"""Answers to requests on a text by their paths."""


# Answers of the explore page for its schematic and for the motion of its modes, as JSON data.

Make: TypeAlias = Callable[[Session, State], dict[str, Any]]
MOST_MOVING = 12
"""Number of lowest modes of a large model that the page can move; each more takes time while the text is written."""
BYTES_OF_MOTION = 100
"""Size in bytes of the motion of one node in one mode, roughly."""


def schematic_answer(session: Session, state: State) -> dict[str, Any]:
    """Schematic of a state's drivetrain as SVG text, with the ids of elements and nodes, as JSON data.

    It shows the elements of the configuration chosen and the values of the sliders; reasons under ``refused`` if the
    state is impossible.

    Examples
    --------
    >>> from torsionnet.app.explore.session import open_session
    >>> schematic_answer(open_session("amt_rig"), State({"gear": "V"}))["elements"]["gearbox"]
    'element-gearbox'
    """
    return _kept(session, state, "schematic", _schematic)


def motion_answer(session: Session, state: State) -> dict[str, Any]:
    """Motion of the nodes in each mode of a state's drivetrain, and mean torques of its elements, as JSON data.

    Reasons under ``refused`` if the state is impossible.
    """
    return _kept(session, state, "motion", _mode_motion)


def _schematic(session: Session, state: State) -> dict[str, Any]:
    from torsionnet.plot.schematics.svg_drawing import schematic_svg  # what draws is loaded by pages that show it

    drawing = schematic_svg(session.model_for(state), width=math.inf)  # along one line, as the mode shapes below it
    return {
        "svg": drawing.svg,
        "elements": dict(drawing.elements),
        "nodes": dict(drawing.nodes),
        "size": list(drawing.size),
    }


def _mode_motion(session: Session, state: State) -> dict[str, Any]:
    rig = session.model_for(state)
    with collected_notes() as notes:
        is_large = len(rig.nodes) > MANY_NODES
        motion = mode_motion(rig, page_modes(session, state, rig).first(MOST_MOVING if is_large else None))
    said = [f"{len(rig.nodes)} nodes: the {MOST_MOVING} lowest modes can be moved"] if is_large else []
    return motion | {"notes": list(dict.fromkeys([*said, *motion["notes"], *notes]))}


def _kept(session: Session, state: State, what: str, make: Make) -> dict[str, Any]:
    """Answer that depends on the configuration and the values of a state alone, kept by the session."""
    key = (what, tuple(state.choice.items()), tuple(state.values.items()))

    def answer() -> dict[str, Any]:
        try:
            return dict(make(session, state))
        except TorsionnetError as error:
            return {"refused": fault_texts(error)}

    return session.pictures.once(dict, key, answer, _size)


def _size(data: dict[str, Any]) -> int:
    moved = sum(len(mode["nodes"]) for mode in data.get("modes", ()))
    return len(data.get("svg", "")) + BYTES_OF_MOTION * moved


LARGEST_REQUEST = 100_000
"""Largest number of bytes of a request without a text; a state of 2000 parameters has about that many."""
LARGEST_TEXT_REQUEST = 2 * MOST_BYTES + LARGEST_REQUEST
"""Largest number of bytes of a request with a text, in which JSON writes a line feed as two."""


def _overlay(session: Session, state: State) -> dict[str, Any]:
    return {"overlay": session.overlay_for(state)}


def _values(session: Session, state: State) -> dict[str, Any]:
    return {"text": plain_line_ends(session.changed_file_text(state))}


QUESTIONS: Mapping[str, Callable[[Session, State], dict[str, Any]]] = {
    "api/answer": answer,
    "api/overlay": _overlay,
    "api/values": _values,
}
"""Calculations for a state of the page by their paths; each waits for the one before it of the same document."""

PICTURES: Mapping[str, Callable[[Session, State], dict[str, Any]]] = {
    "api/schematic": schematic_answer,
    "api/motion": motion_answer,
}
"""Pictures of a state of the page by their paths; they wait for one another, and for no response."""


def _model(documents: Documents, request: PageRequest, is_closed: Callable[[], bool]) -> Answer:
    del is_closed
    read_state(request.entries)
    return documents.named(request.document).described()


def _open(documents: Documents, request: PageRequest, is_closed: Callable[[], bool]) -> Answer:
    del is_closed
    return documents.open(request.only().document)


def _changes(documents: Documents, request: PageRequest, is_closed: Callable[[], bool]) -> Answer:
    disk = request.only("disk").short("disk")
    return documents.changes(documents.named(request.document), disk, is_closed)


def _store(documents: Documents, request: PageRequest, is_closed: Callable[[], bool]) -> Answer:
    del is_closed
    request.only("text", "disk", "force")
    text, disk = request.text("text"), request.short("disk")
    # Whoever insists names the version that was shown; an older one is refused all the same.
    request.flag("force")
    return documents.store(documents.named(request.document), text, disk)


OF_THE_FILE: Mapping[str, Callable[[Documents, PageRequest, Callable[[], bool]], Answer]] = {
    "api/open": _open,
    "api/model": _model,
    "api/changes": _changes,
    "api/store": _store,
}
"""Answers to requests on the file and its model by their paths; the last argument tells whether the asker has gone."""
PATHS = (*OF_THE_FILE, *TEXT_QUESTIONS, *QUESTIONS, *PICTURES)
"""Paths of all requests of the page."""


def largest_request(path: str) -> int:
    """Largest number of bytes of a request to a path."""
    return LARGEST_TEXT_REQUEST if path in TEXT_QUESTIONS or path == "api/store" else LARGEST_REQUEST


def reply(documents: Documents, path: str, body: bytes, is_closed: Callable[[], bool] = lambda: False) -> bytes:
    """JSON text, in bytes, that answers a request of the page.

    A state that the model refuses is answered with its reasons under ``refused``: sliders reach such states.

    Raises
    ------
    RequestError
        The body is no such request.
    """
    request = read_request(body)
    try:
        response = _answer_to(documents, path, request, is_closed)
    except TorsionnetError as error:
        response = {"refused": fault_texts(error)}
    return json.dumps(response, separators=(",", ":"), allow_nan=False).encode()


def _answer_to(documents: Documents, path: str, request: PageRequest, is_closed: Callable[[], bool]) -> Answer:
    if path in OF_THE_FILE:
        return OF_THE_FILE[path](documents, request, is_closed)
    document = documents.named(request.document)
    if path == "api/text":  # takes its turn by itself, as the text counts before it is examined
        return TEXT_QUESTIONS[path](document, request)
    kind = f"{path} {request.kind}"
    if path in TEXT_QUESTIONS:
        return document.in_turn(kind, lambda: TEXT_QUESTIONS[path](document, request))
    state = read_state(request.entries)
    if path in PICTURES:
        return document.drawn(kind, lambda session: _calculated(PICTURES[path], session, state))
    return document.calculated(kind, lambda session: _calculated(QUESTIONS[path], session, state))


def _calculated(question: Callable[[Session, State], Answer], session: Session, state: State) -> Answer:
    try:
        return question(session, state)
    except TorsionnetError as error:
        return {"refused": fault_texts(error)}


# Model text from a mass-elastic table that was copied from a spreadsheet or a paper.

TABLE = "pasted table"
"""Name of a pasted table in messages."""
_MODEL = re.compile(r"^\s*(torsionnet|elements|parameters|nodes?)\s*:|\{\s*type\s*:|^\s*type\s*:", re.MULTILINE)
"""Expression of what only texts of models hold, whose words of inertias would be taken for headings."""


def pasted_model(table: str) -> dict[str, Any]:
    """Text of a model from a table of masses and shafts with a heading, as JSON data.

    Cells stand between tabs, semicolons or commas. ``no_table`` where the text is no such table, ``refused`` with
    reasons where it is one with faults.

    Examples
    --------
    >>> model = pasted_model("mass\\tJ [kg m²]\\tk [MNm/rad]\\ncyl 1\\t0,45\\t2,1\\nflywheel\\t14\\t")
    >>> model["text"].splitlines()[4]
    '  cyl_1: {type: inertia, node: cyl_1, inertia: 0.45 kg m², description: cyl 1}'
    >>> pasted_model("elements:\\n  a: {type: inertia}")
    {'no_table': True}
    """
    if _MODEL.search(table):
        return {"no_table": True}
    try:
        grid = parse_grid(table.splitlines(), TABLE)
    except ModelError:
        return {"no_table": True}
    if not any(is_inertia_heading(cell) for row in grid.rows for cell in row):
        return {"no_table": True}
    from torsionnet.io.mass_elastic_files import sheet_drivetrain

    try:
        sheet = parse_sheet(grid)
        text = sheet_drivetrain(sheet).to_yaml().replace(f"mass-elastic sheet {TABLE}", "pasted mass-elastic table", 1)
    except ModelError as error:
        said = [f"line {fault.position.line}: {fault.text}" if fault.position else fault.text for fault in error.faults]
        wanting = [_unit_asked(fault) for fault in error.faults if fault.kind == "missing-unit"]
        return {"refused": said} | ({"asked": wanting} if len(wanting) == len(said) else {})
    except TorsionnetError as error:
        return {"refused": [str(error)]}
    notes = [f'"{column.heading}": {BY_KEY[column.meaning].shown}' for column in sheet.columns if column.meaning]
    return {"text": text, "notes": [*notes, *sheet.notes]}


def _unit_asked(fault: Fault) -> dict[str, Any]:
    """Line and heading of a column without unit as JSON data, with the units that it may have."""
    from torsionnet.app.text.completion_values import units_of

    assert fault.position is not None
    return {"line": fault.position.line, "heading": fault.about, "units": list(units_of(fault.meant))}
