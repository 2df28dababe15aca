"""Interface to planning engines, which return validated plans. Only this package imports unified_planning."""
