"""PDDL operators, problems, legal names and text."""
