"""Data structures of tasks, domains, plans and recordings.

This package neither plans nor simulates, and does not access files. Other packages import this package.
"""
