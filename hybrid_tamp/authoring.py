"""What authors of domains write against: classes, predicates, blocks, shapes, rotations, motor primitives, constants.

Re-exports only. Domains import nothing else of the framework but `hybrid_tamp` and `hybrid_tamp.testing`.
"""

from hybrid_tamp.geometry.features import (
    across,
    rolling_likelihood,
    rolling_radius,
    roundest_axis,
    silhouette,
    tumbling_likelihood,
)
from hybrid_tamp.geometry.meshes import MeshShape
from hybrid_tamp.geometry.shapes import (
    Box,
    BoxPart,
    Compound,
    Cylinder,
    CylinderPart,
    MeshFile,
    Part,
    Shape,
    Sphere,
    SpherePart,
    solids_of,
)
from hybrid_tamp.geometry.surfaces import points_of, volume_of
from hybrid_tamp.model.affordance import (
    BODY_STATE,
    TOKEN,
    AffordanceClass,
    BasicAction,
    CapabilityClass,
    Direction,
    ObjectClass,
    PlaceClass,
    VaryingProperty,
    Vector3,
    quantity,
)
from hybrid_tamp.model.block import Block, Duration, Movement, Slot, Target
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands, ContinuousSystem, Policy, PolicyMaker
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.grasp import CAPTURE, FINGER_SPEED, GRIP_FRICTION, aperture_property
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.measure import Measure
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.parameters import Hyperparameter, Hyperparameters, Parameters
from hybrid_tamp.model.plan import BlockInstance, split_mode
from hybrid_tamp.model.predicate import ANY, Atom, Binding, Literal, Parameter, Predicate, SymbolSort, Value
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.model.trial import Carry, Estimate, TrialRecipe
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.motion.dmp import DMP
from hybrid_tamp.motion.minimum_jerk import minimum_jerk
from hybrid_tamp.motion.poses import (
    angle_about,
    cross,
    integrate,
    quaternion_conjugate,
    quaternion_from_axis_angle,
    quaternion_from_rotation_vector,
    quaternion_from_rpy,
    quaternion_multiply,
    quaternion_of_rotation,
    rotate,
)
from hybrid_tamp.motion.profile import Profile

__all__ = [
    "ANY",
    "AffordanceClass",
    "Atom",
    "BODY_STATE",
    "BasicAction",
    "Binding",
    "Block",
    "BlockInstance",
    "Box",
    "BoxPart",
    "CAPTURE",
    "CONTROL_PERIOD",
    "CapabilityClass",
    "Carry",
    "Commands",
    "Compound",
    "ContinuousSystem",
    "Cylinder",
    "CylinderPart",
    "DMP",
    "Direction",
    "Domain",
    "Duration",
    "Estimate",
    "FINGER_SPEED",
    "FloatArray",
    "GRAVITY",
    "GRIP_FRICTION",
    "Hyperparameter",
    "Hyperparameters",
    "Kind",
    "Literal",
    "Measure",
    "MeshFile",
    "MeshShape",
    "Movement",
    "ObjectClass",
    "Parameter",
    "Parameters",
    "Part",
    "PlaceClass",
    "Policy",
    "PolicyMaker",
    "Predicate",
    "Profile",
    "ReassignmentNetwork",
    "Recording",
    "Shape",
    "Slot",
    "Sphere",
    "SpherePart",
    "State",
    "SymbolSort",
    "TOKEN",
    "Target",
    "Task",
    "Token",
    "TrialRecipe",
    "Value",
    "VaryingProperty",
    "Vector3",
    "across",
    "angle_about",
    "aperture_property",
    "cross",
    "integrate",
    "minimum_jerk",
    "solids_of",
    "points_of",
    "quantity",
    "quaternion_conjugate",
    "quaternion_from_axis_angle",
    "quaternion_from_rotation_vector",
    "quaternion_from_rpy",
    "quaternion_multiply",
    "quaternion_of_rotation",
    "rolling_likelihood",
    "rolling_radius",
    "rotate",
    "roundest_axis",
    "silhouette",
    "split_mode",
    "tumbling_likelihood",
    "volume_of",
]
