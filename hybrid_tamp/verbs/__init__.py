"""One module per verb: load, call the stages, save."""
