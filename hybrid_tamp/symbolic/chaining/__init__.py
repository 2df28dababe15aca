"""Chains: blocks in series compiled as one step and expanded again (paper, Sec. II-C).

Before: a task's blocks and network. After: a domain in which each chain is one block, and the way back.
"""
