"""Tests of the class membership of new tokens (paper, Sec. II-B)."""
