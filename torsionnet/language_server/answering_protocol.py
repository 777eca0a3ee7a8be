"""Protocol of the server in which no request stays without an answer."""

from __future__ import annotations

from typing import Any

from pygls.exceptions import JsonRpcException
from pygls.protocol import LanguageServerProtocol


class AnsweringProtocol(LanguageServerProtocol):
    """Language Server Protocol that answers a request with wrong arguments, too, so that the editor does not wait."""

    def structure_message(self, data: dict[str, Any]) -> Any:
        """Message of the protocol from its JSON."""
        try:
            return super().structure_message(data)
        except JsonRpcException as error:
            if "method" in data and isinstance(data.get("id"), (int, str)):
                self._send_response(data["id"], error=error.to_response_error())
            raise
