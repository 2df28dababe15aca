"""Explanations of planning failures, suggested repairs, and explanations of the tokens in a plan."""
