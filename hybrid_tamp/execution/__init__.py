"""Execution of plans on a physics backend. Each run is stored as a `Recording` of measured states and commands."""
