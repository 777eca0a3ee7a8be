"""Requests of the explore page on the text in its text pane, from JSON to JSON data."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from torsionnet.app.explore.document import Answer, Document
from torsionnet.app.explore.offset_counting import OffsetCounting
from torsionnet.app.explore.request_reading import PageRequest
from torsionnet.app.text.text_edits import TextSpan
from torsionnet.base.errors import UsageError

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
            "label": one.label,
            "kind": one.kind,
            "detail": one.detail,
            "documentation": one.documentation,
            "insert": one.insert,
        }
        | asked.counting.span(one.span)
        for one in completions(*asked.place)
    ]
    return {"options": options}


def _hover(document: Document, request: PageRequest) -> Answer:
    from torsionnet.app.text.hovering import hover

    asked = TextQuestion(document, request, "at")
    found = hover(*asked.place)
    return {} if found is None else {"html_free_text": found.markdown} | asked.counting.span(found.span)


def _definition(document: Document, request: PageRequest) -> Answer:
    from torsionnet.app.text.name_definition import definition

    asked = TextQuestion(document, request, "at")
    found = definition(*asked.place)
    return asked.ranges([] if found is None else [found])


def _references(document: Document, request: PageRequest) -> Answer:
    from torsionnet.app.text.name_definition import references

    asked = TextQuestion(document, request, "at")
    return asked.ranges(references(*asked.place))


def _rename(document: Document, request: PageRequest) -> Answer:
    from torsionnet.app.text.name_change import rename

    asked, name = TextQuestion(document, request, "at", "name"), request.short("name")
    return {"edits": asked.counting.edits(rename(asked.text, asked.offset, name, asked.file, asked.folder))}


def _format(document: Document, request: PageRequest) -> Answer:
    from torsionnet.app.text.formatting import formatted

    asked = TextQuestion(document, request)
    return {"edits": asked.counting.edits(formatted(asked.text))}


def _outline(document: Document, request: PageRequest) -> Answer:
    from torsionnet.app.text.outline import OutlineItem, outline

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
    from torsionnet.app.explore.table_paste import pasted_model

    del document
    table = request.only("table").text("table")
    return pasted_model(table) if len(table) <= MOST_SERVED else {"no_table": True}


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
}
"""Answers to requests on a text by their paths."""
