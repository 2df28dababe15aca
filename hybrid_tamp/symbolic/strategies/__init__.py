"""Strategies for a plan: goals planned apart, tokens rebound.

Before: a task and a running planner. After: a candidate plan of the whole task, which the law checker has passed.
"""
