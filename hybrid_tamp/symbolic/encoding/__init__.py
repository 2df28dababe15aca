"""Encoder: block declarations to lifted STRIPS operators, slot by slot, generic over domains.

Before: a domain's blocks and network. After: a planning domain, and what each operator means.
"""
