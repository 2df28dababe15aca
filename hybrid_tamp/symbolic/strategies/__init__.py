"""Strategies for a plan: goals planned apart, tokens rebound.

Input: a task and a running planner. Output: a candidate plan of the whole task that the law checker accepted.
"""
