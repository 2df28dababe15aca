"""Answers to questions about tasks, plans and runs."""
