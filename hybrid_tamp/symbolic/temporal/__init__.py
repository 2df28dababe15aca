"""Encoder for export to PDDL 2.1, with one durative action per block.

The input is a task and optionally a plan. The output is temporal PDDL and the plan as a temporal plan.
"""
