"""Questions about a task, answered from the results of planning and of runs."""
