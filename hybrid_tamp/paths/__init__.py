"""Collision-free paths: the free space of a movement -> the corners of a path, or None.

    free_space   positions at which moving bodies are clear of bodies at rest
    search       paths through free space, by sampling
    proofs       proofs on a grid that there is no path

Only this package imports OMPL, and only if a movement needs a path.
"""
