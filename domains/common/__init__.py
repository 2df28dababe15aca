"""Parts that several domains share: hands, regions, vectors, servos, motor primitives, REACHING and RESTING."""
