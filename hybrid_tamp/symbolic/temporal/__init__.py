"""Encoder of tasks and plans for export to PDDL 2.1, with one durative action per block."""
