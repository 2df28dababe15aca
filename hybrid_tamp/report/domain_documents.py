"""The documents that `domains --json`, `network --json` and `check-domain --json` print."""

from collections.abc import Iterable
from typing import Any

from hybrid_tamp.model.disagreement import DomainReport
from hybrid_tamp.model.domain import Domain


def domains_document(domains: Iterable[Domain]) -> dict[str, Any]:
    """Return a document with the names of each domain's classes, blocks and predicates."""
    return {
        "schema": "hybrid-tamp/domains/1",
        "domains": [
            {
                "name": domain.name,
                "description": domain.description,
                "classes": [each.name for each in domain.classes],
                "blocks": [each.name for each in domain.blocks],
                "predicates": [each.name for each in domain.predicates],
            }
            for domain in domains
        ],
    }


def network_document(domain: Domain) -> dict[str, Any]:
    """Return a document with the blocks, slots and edges of a domain's reassignment network."""
    return {
        "schema": "hybrid-tamp/network/1",
        "domain": domain.name,
        "blocks": [
            {"name": block.name, "slots": {slot.name: slot.object_class.name for slot in block.slots}}
            for block in domain.blocks
        ],
        "edges": [[".".join(source), ".".join(target)] for source, target in domain.network.edges],
    }


def mistakes_document(report: DomainReport) -> dict[str, Any]:
    """Return a document with the mistakes in a domain."""
    return {
        "schema": "hybrid-tamp/check-domain/1",
        "domain": report.domain,
        "tasks": list(report.tasks),
        "status": "mistakes" if report.mistakes else "ok",
        "mistakes": [
            {
                "kind": each.kind,
                "block": each.block,
                "role": each.role,
                "task": task,
                "binding": dict(each.binding),
                "declared": each.declared,
                "measured": each.measured,
                "remedy": each.remedy,
            }
            for task, each in report.mistakes
        ],
    }
