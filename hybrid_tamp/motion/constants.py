"""Physical constants."""

GRAVITY = 9.81
"""Gravitational acceleration along the negative z axis of the world frame [m/s^2]."""
