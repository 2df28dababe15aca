"""Encoder: block declarations to lifted STRIPS operators, slot by slot, for any domain.

Input: the blocks and the network of a domain. Output: a planning domain, and the meaning of each operator.
"""
