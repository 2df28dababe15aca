"""Queries of the affordances of objects in different perspectives (paper, Sec. II-E)."""
