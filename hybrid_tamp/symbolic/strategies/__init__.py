"""Ways to a plan: the whole task at once, goals apart, tokens rebound."""
