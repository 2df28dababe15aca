"""Check of `Block.key_poses`: every rollout that reaches its exit conditions must pass the declared key poses."""

from hybrid_tamp.collision.bodies import Body
from hybrid_tamp.collision.deviations import find_deviation
from hybrid_tamp.collision.sweeps import Track
from hybrid_tamp.model.expectation import declared_key_poses
from hybrid_tamp.model.key_pose import KeyPose
from hybrid_tamp.model.token import Token
from hybrid_tamp.testing.disagreement import Disagreements
from hybrid_tamp.testing.rollouts import Rollouts

_POSES = 200
"""Largest number of poses of a rollout between which the body is interpolated."""


def check_key_poses(rolled: Rollouts, found: Disagreements) -> None:
    """Compare the key poses of a block with all rollouts that reached their exit conditions.

    Args:
        rolled: rollouts of the block.
        found: collection to which disagreements are added, at most one for each slot.

    Raises:
        DomainError: the function fails, or its result has the wrong shape.
    """
    poses = declared_key_poses(rolled.block, rolled.binding, rolled.start)
    for slot in dict.fromkeys(pose.slot for pose in poses):
        token = rolled.binding[slot]
        assert isinstance(token, Token)
        if token.shape is None:
            continue
        body = Body(token.name, token.solid)
        tracks = [_track(body, rolled, row) for row in rolled.rows]
        for pose in poses:
            off = max((_distance(body, pose, track) for track in tracks), default=0.0) if pose.slot == slot else 0.0
            if off > pose.within:
                at = "({:.2f}, {:.2f}, {:.2f})".format(*pose.position)
                declared = f"{slot} passes the key pose at {at} within {1e3 * pose.within:.0f} mm"
                measured = f"in a rollout, {slot} is always at least {1e3 * off:.1f} mm away from this pose"
                found.add("key_pose", rolled.block, rolled.binding, declared, measured, slot)
                break


def _distance(body: Body, pose: KeyPose, track: Track) -> float:
    """Return the distance of a key pose from the nearest pose of a track [m]."""
    return find_deviation(Track(body, pose.position[None], pose.orientation[None]), track)


def _track(body: Body, rolled: Rollouts, row: int) -> Track:
    rows = rolled.sample(row, _POSES)
    return Track(body, *(rolled.states[body.name, name][rows, row] for name in ("position", "orientation")))
