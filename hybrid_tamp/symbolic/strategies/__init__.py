"""Planning strategies, which plan goals separately and rebind tokens.

The input is a task and a running planner. The output is a plan of the whole task that the law checker accepted.
"""
