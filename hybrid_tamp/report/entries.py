"""What all documents and their parts have in common."""

from typing import Any

from pydantic import BaseModel, ConfigDict


class Document(BaseModel):
    """A document that programs read, or a part of one; its JSON Schema is published in `schemas/`."""

    model_config = ConfigDict(extra="forbid", populate_by_name=True)

    def dump(self) -> dict[str, Any]:
        """Return plain data with the published keys."""
        return self.model_dump(by_alias=True, mode="json")
