"""The second encoder, for export: one durative action per block, in PDDL 2.1.

Input: a task, and optionally a plan. Output: temporal PDDL, and the plan as a temporal plan.
"""
