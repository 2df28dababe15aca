"""Data structures of tasks, domains, plans and recordings.

This package does not plan, simulate, or read and write files. All other packages for these purposes build on it.
"""
