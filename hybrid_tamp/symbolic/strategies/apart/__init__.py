"""Independent goals planned apart and merged.

Before: a task whose goals name different boxes, say. After: the planner's actions for the whole task, part by part.
"""
