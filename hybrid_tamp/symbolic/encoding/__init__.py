"""Encoder of the blocks and the network of a domain as a planning domain, with the meaning of each operator."""
