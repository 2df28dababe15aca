"""Parallel work on the processors of the local machine."""
