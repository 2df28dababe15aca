"""Which tokens may touch while some instances run."""

from dataclasses import replace
from typing import Any

import pytest

from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.block import FLOOR
from hybrid_tamp.model.contacts import Contact, ContactRules
from hybrid_tamp.model.state import State

STATE = State.of((), {})


def rules(toys: Any, moving: tuple[tuple[str, str], ...] = ()) -> ContactRules:
    resting = replace(toys.resting, allowed_contacts=(("token", FLOOR), ("token", "token")))
    blocks = {"MOVING": replace(toys.moving, allowed_contacts=moving), "RESTING": resting}
    instances = [toys.move("MOVING-1", 0, 1), *(toys.rest(f"RESTING-{t}", 0, 1, t) for t in ("post", "wall"))]
    return ContactRules(blocks, instances)


def test_tokens_of_one_role_may_touch_each_other_and_nothing_else(toys: Any) -> None:
    found = rules(toys)
    assert found.allow("post", "wall", STATE)
    assert found.allow(FLOOR, "wall", STATE)
    assert not found.allow("post", "pusher", STATE)
    assert not found.allow(FLOOR, "pusher", STATE)


def test_a_block_allows_its_own_pairs_in_either_order(toys: Any) -> None:
    found = rules(toys, (("pusher", FLOOR), ("spot", "pusher")))
    assert found.allow(FLOOR, "pusher", STATE)
    assert found.allow("pusher", FLOOR, STATE)
    assert found.allow("pusher", "spot", STATE)
    assert not found.allow("pusher", "post", STATE)


def test_a_role_that_the_block_lacks_is_refused(toys: Any) -> None:
    with pytest.raises(DomainError, match=r"MOVING\.allowed_contacts: .*'puscher'"):
        toys.world.block(allowed_contacts=(("puscher", FLOOR),)).pusher().spot().task()


def test_messages_name_the_floor_in_words_and_last() -> None:
    assert Contact((FLOOR, "hand"), ("", "RESTING-1"), 21.0, 1.0).pair == "hand and the floor"
    assert Contact(("box", "hand"), ("RESTING-1", "RESTING-2"), 21.0, 1.0).pair == "box and hand"
