"""Constants of nature."""

GRAVITY = 9.81
"""Acceleration of free fall, along the world's negative z axis [m/s^2]."""
