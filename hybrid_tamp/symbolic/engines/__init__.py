"""Interface to planning engines.

The input is a planning problem. The output is a validated sequence of actions. Only this package imports
unified_planning.
"""
