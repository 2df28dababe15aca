"""PyBullet without a display: the client and the construction of a scene.

The numbers come from measurements (closed forms within 1 %, see the tests): four substeps of 1/960 s in each control
period, because a rolling cylinder gains energy from contact points that are one substep old (1.2 % of a rolling
acceleration with one substep, 0.4 % with four); contact ERP 0.2, which takes up penetration without throwing a body
that starts a millimetre too low; no damping, so that only the modelled friction brakes.
"""

import os
import tempfile
from collections.abc import Sequence
from typing import Any

import numpy as np
import pybullet

from hybrid_tamp.geometry.meshes import Hull, MeshShape, obj_text
from hybrid_tamp.geometry.shapes import Box, Compound, Cylinder, Shape, Solid
from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.physics.protocol import Resource
from hybrid_tamp.physics.scene import FLOOR_FRICTION, Body

SUBSTEPS = 4
"""Number of substeps in a control period."""
SUBSTEP = CONTROL_PERIOD / SUBSTEPS
"""Length of a substep [s]."""
SOLVER_ITERATIONS = 50
CONTACT_ERP = 0.2
HULL_MARGIN = 0.001
"""Thickness of the layer about a convex hull [m]."""


class Client(Resource):
    """A connection to Bullet with a world of its own."""

    def __init__(self) -> None:
        self._client: int = pybullet.connect(pybullet.DIRECT)

    def close(self) -> None:
        """Disconnect from Bullet; a second call does nothing."""
        if self._client >= 0:
            pybullet.disconnect(self._client)
            self._client = -1


def prepare_world(client: int, gravity: Sequence[float]) -> int:
    """Empty a client's world, set its parameters and return the handle of the floor.

    Args:
        client: PyBullet's client.
        gravity: acceleration of free fall ``(3,)`` [m/s^2].
    """
    pybullet.resetSimulation(physicsClientId=client)
    # A reset keeps the engine's parameters, so all that matter are set every time.
    pybullet.setPhysicsEngineParameter(
        fixedTimeStep=SUBSTEP,
        numSolverIterations=SOLVER_ITERATIONS,
        contactERP=CONTACT_ERP,
        deterministicOverlappingPairs=1,
        physicsClientId=client,
    )
    pybullet.setGravity(*gravity, physicsClientId=client)
    plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
    floor: int = pybullet.createMultiBody(0.0, plane, physicsClientId=client)
    pybullet.changeDynamics(floor, -1, lateralFriction=FLOOR_FRICTION, physicsClientId=client)
    return floor


def create_body(client: int, body: Body) -> int:
    """Create a body with its frame at its centre of mass and return its handle."""
    collision = _create_shape(client, body.shape)
    handle: int = pybullet.createMultiBody(body.mass, collision, physicsClientId=client)
    pybullet.changeDynamics(
        handle,
        -1,
        localInertiaDiagonal=body.inertia,
        lateralFriction=body.friction,
        rollingFriction=body.rolling_friction,
        spinningFriction=body.rolling_friction,
        restitution=0.0,
        linearDamping=0.0,
        angularDamping=0.0,
        physicsClientId=client,
    )
    return handle


def _create_shape(client: int, shape: Shape) -> int:
    if isinstance(shape, MeshShape):
        return _create_hulls(client, shape)
    if isinstance(shape, Compound):
        solids = [_geometry(part) for part in shape.parts]
        handle: int = pybullet.createCollisionShapeArray(
            # Each list needs an entry for every part of any kind.
            shapeTypes=[solid["shapeType"] for solid in solids],
            halfExtents=[solid.get("halfExtents", (0.0, 0.0, 0.0)) for solid in solids],
            radii=[solid.get("radius", 0.0) for solid in solids],
            lengths=[solid.get("height", 0.0) for solid in solids],
            collisionFramePositions=[part.position for part in shape.parts],
            collisionFrameOrientations=[quaternion_from_rpy(part.rpy).tolist() for part in shape.parts],
            physicsClientId=client,
        )
        return handle
    handle = pybullet.createCollisionShape(**_geometry(shape), physicsClientId=client)
    return handle


def _create_hulls(client: int, shape: MeshShape) -> int:
    """Create a compound of convex hulls; Bullet reads several hulls only from a file with one object for each."""
    half = np.ptp(shape.corners, axis=0) / 2.0
    # Bullet wraps each hull in a layer, so the hulls are scaled down to give the body its true size.
    kept = 1.0 - HULL_MARGIN / np.maximum(half, 2.0 * HULL_MARGIN)
    # Bullet caches files by name, so each name is used once.
    descriptor, name = tempfile.mkstemp(prefix="hulls-", suffix=".obj")
    try:
        with os.fdopen(descriptor, "w", encoding="ascii") as file:
            file.write(obj_text([Hull(part.vertices * kept, part.triangles) for part in shape.parts]))
        handle: int = pybullet.createCollisionShape(pybullet.GEOM_MESH, fileName=name, physicsClientId=client)
    finally:
        os.unlink(name)
    return handle


def _geometry(shape: Solid) -> dict[str, Any]:
    if isinstance(shape, Box):
        return {"shapeType": pybullet.GEOM_BOX, "halfExtents": shape.half_extents}
    if isinstance(shape, Cylinder):
        return {"shapeType": pybullet.GEOM_CYLINDER, "radius": shape.radius, "height": shape.length}
    return {"shapeType": pybullet.GEOM_SPHERE, "radius": shape.radius}
