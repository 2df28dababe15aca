"""Feasibility and relevance of a task's blocks: bindings, shares of a load, reachable slots and relevant blocks."""
