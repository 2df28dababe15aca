"""Chains, which are blocks in series that are compiled as one block (paper, Sec. II-C).

The input is a task. The output is a domain in which each chain is one block, and the original blocks of each chain.
"""
