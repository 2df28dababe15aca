"""Checks of blocks: which bindings are feasible, which slots tokens can reach, and which blocks a goal needs."""
