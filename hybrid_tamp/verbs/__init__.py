"""The verbs of the command line, one module each. Each verb loads a task, calls the stages and saves the results."""
