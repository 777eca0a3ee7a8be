"""Protocol of the server in which no request stays without an answer, and each document has one address."""

from __future__ import annotations

import re
from typing import Any
from urllib.parse import unquote

from pygls.exceptions import JsonRpcException
from pygls.protocol import LanguageServerProtocol

_DRIVE = re.compile(r"(?<=^file:///)[A-Z](?=:)")


class AnsweringProtocol(LanguageServerProtocol):
    """Language Server Protocol that answers a request with wrong arguments, too, so that the editor does not wait."""

    def structure_message(self, data: dict[str, Any]) -> Any:
        """Message of the protocol from its JSON, which names an open document by the address that opened it."""
        try:
            message = super().structure_message(data)
        except JsonRpcException as error:
            if "method" in data and isinstance(data.get("id"), (int, str)):
                self._send_response(data["id"], error=error.to_response_error())
            raise
        named = getattr(getattr(message, "params", None), "text_document", None)
        if named is not None and self._workspace is not None:
            opened = [document.uri for document in self._workspace.text_documents.values()]
            named.uri = {_one_spelling(uri): uri for uri in opened}.get(_one_spelling(named.uri), named.uri)
        return message


def _one_spelling(uri: str) -> str:
    """Address in the spelling that stands for all of them, as ``file:///c%3A/a`` and ``file:///C:/a`` are one file.

    >>> _one_spelling("file:///C%3A/100%25%20%41.yaml"), _one_spelling("file:///c:/%2541.yaml")
    ('file:///c:/100% A.yaml', 'file:///c:/%41.yaml')
    """
    return _DRIVE.sub(lambda drive: drive[0].lower(), unquote(uri))
