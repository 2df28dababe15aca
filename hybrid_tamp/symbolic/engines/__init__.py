"""Planning engines.

Input: a planning problem. Output: a validated sequence of actions. Only this package imports unified_planning.
"""
