"""Runnable examples. ``hybrid-tamp new`` copies the domain in ``sweeping``."""
