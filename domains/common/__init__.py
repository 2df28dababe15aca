"""Parts that several domains share, e.g. hands, servos, motor primitives and the blocks REACHING and RESTING."""
