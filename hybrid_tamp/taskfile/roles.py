"""Read the agents of a task file and the block in which each token starts."""

from typing import Any

from hybrid_tamp.model.affordance import CapabilityClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.token import Token
from hybrid_tamp.taskfile.names import check_printable
from hybrid_tamp.taskfile.places import Faults, KeyPath, shown
from hybrid_tamp.taskfile.tokens import Scene


def read_agents(data: dict[str, Any], faults: Faults, scene: Scene) -> dict[str, tuple[str, ...]]:
    """Read the agents. Record a fault for a token that is unknown, has no capability class or belongs to two agents."""
    agents = data.get("agents", {})
    owners: dict[str, str] = {}
    for agent, names in agents.items() if isinstance(agents, dict) else ():
        check_printable(agent, ("agents", agent), faults, "the name of an agent")
        for index, name in enumerate(names if isinstance(names, list) else ()):
            path: KeyPath = ("agents", agent, index)
            if not faults.sound(path) or not _is_known(name, path, faults, scene, f"agent {shown(agent)}"):
                continue
            if name in scene.outlines and not is_capability(scene.outlines[name]):
                capable = [other for other, token in scene.outlines.items() if is_capability(token)]
                members = ", ".join(member.name for member in scene.outlines[name].classes)
                wanted = f"the tokens of agent {shown(agent)} must be members of a capability class"
                faults.at(path, wanted, f"{shown(name)}, a member of {members}", capable)
            elif name in owners:
                wanted = "a capability token must belong to only one agent"
                came = f"{shown(name)}, which already belongs to agent {shown(owners[name])}"
                faults.at(path, wanted, came, remedy="remove one")
            owners.setdefault(name, agent)
    return {agent: tuple(names) for agent, names in agents.items()} if faults.sound(("agents",)) else {}


def is_capability(token: Token) -> bool:
    """Return whether the robot commands the token directly."""
    return any(issubclass(member, CapabilityClass) for member in token.classes)


def read_assignment(data: dict[str, Any], faults: Faults, domain: Domain | None, scene: Scene) -> dict[str, str]:
    """Read the block in which each token starts. The default is the domain's resting block."""
    starts = data.get("assignment", {})
    for name, block in starts.items() if isinstance(starts, dict) else ():
        path: KeyPath = ("assignment", name)
        if not faults.sound(path) or not _is_known(name, path, faults, scene, "the assignment", key=True):
            continue
        outline = scene.outlines.get(name)
        if outline is not None and outline.place:
            faults.at(path, "a place cannot be assigned to a block", shown(name), remedy="remove the line", key=True)
        elif domain is not None:
            _check_start(block, path, faults, domain, outline)
    if domain is None or not faults.sound(("assignment",)):
        return {}
    return {token.name: starts.get(token.name, domain.resting) for token in scene.tokens if not token.place}


def can_start(block: Block) -> bool:
    """Return whether a token can start in the block. The block must have one slot and no targets."""
    return len(block.slots) == 1 and not block.targets


def _check_start(name: str, path: KeyPath, faults: Faults, domain: Domain, outline: Token | None) -> None:
    block = domain.block_by_name.get(name)
    fitting = [
        other.name
        for other in domain.blocks
        if can_start(other) and (outline is None or outline.is_member(other.slots[0].object_class))
    ]
    if block is None:
        faults.at(path, f"unknown block in the domain {domain.name}", shown(name), fitting)
    elif not can_start(block):
        wanted = "a token must start in a block with one slot and no targets"
        faults.at(path, wanted, f"{shown(name)} with {', '.join(block.roles)}", fitting)
    elif outline is not None and block.name not in fitting:
        wanted = f"only a member of {block.slots[0].object_class.name} can start in {block.name}"
        members = ", ".join(member.name for member in outline.classes)
        faults.at(path, wanted, f"token {shown(outline.name)}, a member of {members}", fitting)


def _is_known(name: str, path: KeyPath, faults: Faults, scene: Scene, who: str, *, key: bool = False) -> bool:
    if scene.names is None or name in scene.names:
        return True
    faults.at(path, f"{who} names an unknown token", shown(name), scene.names, key=key)
    return False
