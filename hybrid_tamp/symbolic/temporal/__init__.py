"""The second encoder, for export: one durative action a block, in PDDL 2.1.

Before: a task, and a plan of it where there is one. After: temporal PDDL, and the plan as a temporal plan.
"""
