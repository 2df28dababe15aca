"""The collision world: distances between the bodies of a state, and the least distances during movements.

    cores    bodies for the library python-fcl, each without its outermost layer
    bodies   bodies of tokens at poses, their distances from each other and from the floor
    sweeps   least distances during movements, by bisection

Only this package imports python-fcl, and only if two bodies are near each other.
"""
