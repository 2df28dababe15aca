"""Data structures of tasks, domains, plans and recordings.

This package does not plan, simulate, or read and write files. The packages that do so import this package.
"""
