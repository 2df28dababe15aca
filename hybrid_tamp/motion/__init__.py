"""Poses, motion profiles and movement primitives for policies. This package depends only on numpy.

Conventions
===========

Frames
    All frames are right-handed. The z axis of the world frame points up, so gravity points along -z. A vector is
    given in the world frame unless the variable name says otherwise.

Units
    All units are SI units: metre, second, radian, kilogram and newton. Degrees are not used.

Quaternions
    Unit quaternions have the order ``(x, y, z, w)``, as in PyBullet. The identity is ``(0, 0, 0, 1)``. The product
    is Hamilton's product: ``quaternion_multiply(a, b)`` rotates first by ``b`` and then by ``a``. The quaternions
    ``q`` and ``-q`` represent the same rotation. A rotation vector always has a length of at most pi.

Names of rotations
    ``target_from_source`` transforms the coordinates of a vector from the source frame to the target frame. In a
    product, equal neighbouring names cancel::

        world_from_hand = quaternion_multiply(world_from_object, object_from_hand)
        grip_in_world = rotate(world_from_object, grip_in_object)

    The orientation of a body in a simulator is ``world_from_body``.

Batches
    Batch dimensions come first. A vector has shape ``(..., 3)``, a quaternion has shape ``(..., 4)`` and a scalar
    has shape ``(...)``. A function broadcasts the batch dimensions of its arguments. So one call can evaluate a
    single policy or a whole population. In a time series, time comes before the batch: ``(t, ..., 3)``.

Purity
    Functions do not change their arguments and keep no state. Equal arguments give bit-identical results.

Normalised time
    Profiles and primitives use normalised time, which is the elapsed time divided by the duration. Normalised time is
    0 at the start of a movement and 1 at its end. To get a velocity, divide the first derivative in normalised time
    by the duration. To get an acceleration, divide the second derivative by the squared duration.
"""
