"""What hatchling adds to pyproject.toml: all extras as one, and links of the README that lead somewhere."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

LINK = re.compile(r"""(\]\(|src=")(?!\w+:|#)([^)"]+)""")
"""Link or picture of a README to a file of the checkout."""
PICTURES = (".png", ".svg")


class ReleaseMetadata(MetadataHookInterface):
    """Extras with ``all``, and the long description of the package index."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Add ``readme`` and ``optional-dependencies`` to the table [project]."""
        extras: dict[str, list[str]] = self.config["extras"]
        metadata["optional-dependencies"] = extras | {"all": [line for lines in extras.values() for line in lines]}
        readme = (Path(self.root) / "README.md").read_text(encoding="utf-8")

        def absolute(link: re.Match[str]) -> str:
            kind = "raw" if link[2].endswith(PICTURES) else "blob"
            return f"{link[1]}{metadata['urls']['Repository']}/{kind}/v{metadata['version']}/{link[2]}"

        metadata["readme"] = {"content-type": "text/markdown", "text": LINK.sub(absolute, readme)}
