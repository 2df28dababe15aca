"""The verbs (commands) of the command line, each in its own module. The verbs load tasks and save results."""
