"""Parallel work on the processors of this machine."""
