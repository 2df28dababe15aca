"""Encoder of block declarations as lifted STRIPS operators, for any domain.

The input is the blocks and the network of a domain. The output is a planning domain and the meaning of each operator.
"""
