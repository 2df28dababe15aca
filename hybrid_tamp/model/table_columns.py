"""Names of the columns in tables of token poses, which `imitate` reads and recordings are exported to."""

TIME = "time"
"""Name of the column of the instants [s], which is the first column."""

COMPONENTS = {"position": ("x", "y", "z"), "orientation": ("qx", "qy", "qz", "qw")}
"""Maps each varying property of a pose to the names of its components."""


def column_names(token: str, varying: str, size: int) -> tuple[str, ...]:
    """Return the columns of a token's varying property, e.g. ``hand.x``, ``hand.y`` and ``hand.z``.

    Only poses and properties with one component have columns. Velocities have none, because they follow from the poses.
    """
    components = COMPONENTS.get(varying, (varying,) if size == 1 else ())
    return tuple(f"{token}.{component}" for component in components)
