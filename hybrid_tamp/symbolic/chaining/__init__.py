"""Chains, which are blocks in series that are compiled as one block (paper, Sec. II-C)."""
