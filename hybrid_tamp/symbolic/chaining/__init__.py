"""Chains: blocks in series that are compiled as one step and expanded again (paper, Sec. II-C).

Input: the blocks and the network of a task. Output: a domain in which each chain is one block, and the way back.
"""
