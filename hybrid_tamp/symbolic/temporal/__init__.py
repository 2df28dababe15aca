"""The second encoder: one durative action a block, for Aries and for PDDL 2.1.

Before: a task, and for Aries a lawful plan of it. After: temporal PDDL, timelines as temporal plans, shorter plans.
"""
