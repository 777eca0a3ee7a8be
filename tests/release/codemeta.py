"""codemeta.json, made from pyproject.toml: ``python -m release.codemeta`` writes it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from release.project import ROOT, project


def codemeta(about: dict[str, Any]) -> str:
    """Text of codemeta.json in the terms of CodeMeta 3.0 for a table [project]."""
    urls = about["urls"]
    terms = {
        "@context": "https://w3id.org/codemeta/3.0",
        "type": "SoftwareSourceCode",
        "name": about["name"],
        "version": about["version"],
        "description": about["description"],
        "keywords": about["keywords"],
        "license": f"https://spdx.org/licenses/{about['license']}",
        "author": [{"type": "Organization", "name": author["name"]} for author in about["authors"]],
        "url": urls["Homepage"],
        "codeRepository": urls["Repository"],
        "issueTracker": urls["Issues"],
        "softwareHelp": {"type": "WebSite", "url": urls["Documentation"]},
        "releaseNotes": urls["Changelog"],
        "programmingLanguage": "Python",
        "runtimePlatform": f"Python {about['requires-python']}",
        "operatingSystem": "Linux, macOS, Windows",
        "developmentStatus": "active",
        "softwareRequirements": about["dependencies"],
    }
    return json.dumps(terms, indent=2, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    Path(ROOT / "codemeta.json").write_text(codemeta(project()), encoding="utf-8")
