"""Why a task has no plan, what would give it one, and why each token is in the plan that it has."""
