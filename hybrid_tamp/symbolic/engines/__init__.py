"""Planning engines.

A planning problem goes in, a validated sequence of actions comes out. Only this package imports unified_planning.
"""
