"""A hand that reads an object may enter a block that changes the object, because its old block ends at this instant."""

import crates

import hybrid_tamp
from hybrid_tamp.model.law import check_law
from hybrid_tamp.symbolic.encoding.encoder import encode_task


def test_the_anchor_may_read_the_object_that_its_next_block_changes() -> None:
    task = crates.make_task()
    found = hybrid_tamp.plan(task)
    assert found.plan is not None
    assert not check_law(task, found.plan)
    names = [each.name for each in encode_task(task).planning.operators if each.name.startswith("fill")]
    assert names == ["fill-pushing-crate-from-resting", "fill-pushing-crate-from-resting-read-in-reaching"]
