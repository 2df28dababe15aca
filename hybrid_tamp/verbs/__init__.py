"""One module per verb of the command line: it loads a task, calls the stages and saves the results."""
