"""Questions about a task: results of planning and runs go in, answers come out."""
