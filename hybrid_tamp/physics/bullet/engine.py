"""Connection to PyBullet without a display, and construction of a scene.

The parameters below reproduce closed-form solutions within 1 % (see the tests):

- Four substeps per control period, so that contact points are at most one substep old.
- A contact ERP (error reduction parameter) of 0.2, so that bodies that start 1 mm inside the floor do not jump.
- No damping, so that only the modelled friction decelerates bodies.
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
from hybrid_tamp.motion.constants import FLOOR_FRICTION
from hybrid_tamp.physics.bullet.solids import place_solids
from hybrid_tamp.physics.protocol import Resource
from hybrid_tamp.physics.scene import Body

SUBSTEPS = 4
"""Number of substeps per control period."""
SUBSTEP = CONTROL_PERIOD / SUBSTEPS
"""Duration of a substep [s]."""
SOLVER_ITERATIONS = 50
CONTACT_ERP = 0.2
FASTEST = 1e6
"""Largest speed of a body [m/s, rad/s]. Bullet's default of 100 rad/s would slow down small rolling bodies."""
HULL_MARGIN = 0.001
"""Thickness of the layer that Bullet adds around a convex hull [m]."""


class Client(Resource):
    """A connection to Bullet that has its own simulated world."""

    def __init__(self) -> None:
        self._client: int = pybullet.connect(pybullet.DIRECT)

    def close(self) -> None:
        """Disconnect from Bullet. Further calls have no effect."""
        if self._client >= 0:
            pybullet.disconnect(self._client)
            self._client = -1


def prepare_world(client: int, gravity: Sequence[float]) -> int:
    """Clear the world, set its parameters, add a floor and return the handle of the floor.

    Args:
        client: PyBullet's identifier of the client.
        gravity: acceleration of free fall, shape ``(3,)`` [m/s^2].
    """
    pybullet.resetSimulation(physicsClientId=client)
    # A reset of the engine does not reset its parameters, so all relevant parameters are set explicitly.
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
    """Create a body with its frame at the centre of mass, and return the body's handle."""
    # A hand follows its commands, so it never rolls freely.
    collision = _create_shape(client, body.shape, rolls=not body.driven)
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
        maxJointVelocity=FASTEST,
        physicsClientId=client,
    )
    return handle


def _create_shape(client: int, shape: Shape, rolls: bool) -> int:
    if isinstance(shape, MeshShape):
        return _create_hulls(client, shape)
    placed = place_solids(shape, rolls)
    if len(placed) == 1 and not isinstance(shape, Compound):
        handle: int = pybullet.createCollisionShape(**_geometry(placed[0].solid), physicsClientId=client)
        return handle
    solids = [_geometry(each.solid) for each in placed]
    handle = pybullet.createCollisionShapeArray(
        # Every list must have one entry per solid, even if the solid's kind ignores the entry.
        shapeTypes=[solid["shapeType"] for solid in solids],
        halfExtents=[solid.get("halfExtents", (0.0, 0.0, 0.0)) for solid in solids],
        radii=[solid.get("radius", 0.0) for solid in solids],
        lengths=[solid.get("height", 0.0) for solid in solids],
        collisionFramePositions=[each.position for each in placed],
        collisionFrameOrientations=[each.orientation for each in placed],
        physicsClientId=client,
    )
    return handle


def _create_hulls(client: int, shape: MeshShape) -> int:
    """Create a compound of convex hulls. Bullet accepts several hulls only as a file with one object per hull."""
    half = np.ptp(shape.corners, axis=0) / 2.0
    # Bullet adds a layer around each hull, so the hulls are scaled down to give the body its true size.
    kept = 1.0 - HULL_MARGIN / np.maximum(half, 2.0 * HULL_MARGIN)
    # Bullet caches files by name, so each file name must be unique.
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
