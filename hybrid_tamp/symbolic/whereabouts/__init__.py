"""Whereabouts of tokens as symbols: a task becomes a task in which feasibility facts depend on where tokens are."""
