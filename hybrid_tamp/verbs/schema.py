"""The verb ``schema``: return the JSON Schemas of task files and documents, and the reference page of task files."""

from typing import Any

from hybrid_tamp.report.documents import json_schemas
from hybrid_tamp.taskfile.reference import reference_page
from hybrid_tamp.taskfile.schema import json_schema
from hybrid_tamp.verbs.domains import list_domains


def find_schema(document: str) -> dict[str, Any]:
    """Return the JSON Schema of a document: ``task``, ``plan``, ``result``, ``explain`` or ``affordances``."""
    if document == "task":
        return json_schema(list_domains())
    return json_schemas()[f"{document}-1"]


def write_reference() -> str:
    """Return the reference page of task files in Markdown."""
    return reference_page(list_domains())
