"""Breadth-first search over bindings, to check proofs of the planner.

Modules, in reading order: `world` (states, margins, movements), `moves` (lawful reassignments), `search` (the search).
The package shares no code with the symbolic stage. Every condition, static or
not, is measured in the current state.
"""
