"""The mathematics of policies: poses, profiles and movement primitives, on numpy only.

Conventions
===========

Frames
    Right-handed, z up: gravity points along -z. A vector is given in the world frame unless its name says
    otherwise.

Units
    SI: metre, second, radian, kilogram, newton. Degrees are not used.

Quaternions
    Unit quaternions in the order ``(x, y, z, w)``, as in PyBullet; the identity is ``(0, 0, 0, 1)``. The
    product is Hamilton's: ``quaternion_multiply(a, b)`` turns by ``b`` first, then by ``a``. ``q`` and ``-q``
    are the same rotation; functions that return an angle take the shortest way.

Names of rotations
    ``target_from_source`` takes the coordinates of a vector in the source frame to its coordinates in the
    target frame, so that neighbouring names cancel::

        world_from_hand = quaternion_multiply(world_from_object, object_from_hand)
        grip_in_world = rotate(world_from_object, grip_in_object)

    A body's orientation, as a simulator gives it, is ``world_from_body``.

Batches
    Batch dimensions lead: a vector is ``(..., 3)``, a quaternion ``(..., 4)``, a scalar quantity ``(...)``,
    and ``...`` broadcasts between the arguments of a call. One call thus evaluates a whole population of
    policies, or a single one with ``...`` empty. A series in time has time in front of the batch: ``(t, ..., 3)``.

Purity
    No function changes its arguments or keeps a state; the same arguments give the same bits.

Normalised time
    Profiles and primitives use normalised time, elapsed time over duration: 0 at the beginning of a
    movement, 1 at its end. Divide a first derivative in normalised time by the duration for a velocity, and a
    second derivative by its square for an acceleration.
"""
