"""Explanations of failures to find a plan, suggested repairs, and explanations of the tokens in a plan."""
