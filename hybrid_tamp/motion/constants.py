"""Constants of nature."""

GRAVITY = 9.81
"""Acceleration of free fall, down along the world's z axis [m/s^2]."""
