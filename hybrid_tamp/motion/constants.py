"""Physical constants, and values for bodies that do not declare a property."""

GRAVITY = 9.81
"""Gravitational acceleration along the negative z axis of the world frame [m/s^2]."""
DEFAULT_MASS = 1.0
"""Mass of a token without the property `mass` [kg]."""
DEFAULT_FRICTION = 0.5
"""Friction coefficient of a token without the property `friction`. The coefficients of two bodies multiply."""
FLOOR_FRICTION = 1.0
"""Friction coefficient of the floor."""
