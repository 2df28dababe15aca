"""PDDL: operators and problems as values, legal names, text."""
