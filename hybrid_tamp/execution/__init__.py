"""Execution of a plan on a physics backend, which gives a `Recording` of the measured run."""
