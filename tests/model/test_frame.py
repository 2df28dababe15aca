"""Frame conditions: which predicates a block keeps without a declaration."""

from dataclasses import replace

import pytest
from default_domains import BEHIND, DELIVERED, make_shoving, shoving_task

from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.frame import explain_kept, find_changes
from hybrid_tamp.model.predicate import Parameter, Predicate
from hybrid_tamp.skills import AT_REST, StaticEndEffector, length_predicate
from hybrid_tamp.testing.disagreement import Disagreements
from hybrid_tamp.testing.facts import check_keeps

LOW = length_predicate(
    "low",
    (Parameter("hand", StaticEndEffector),),
    lambda state, hand: 2.0 - state[hand, "position"][..., 2],
    reads={"hand": ("position",)},
)


def with_low(*, entry: bool) -> Domain:
    """Return the domain of shoving in which the reach has the invariant `low`, and perhaps the entry condition."""
    domain = make_shoving()
    reach = domain.block_by_name["REACHING:behind"]
    changed = replace(reach, invariants=(*reach.invariants, LOW("hand")))
    return domain.with_blocks([replace(changed, entry=(*reach.entry, LOW("hand"))) if entry else changed], [LOW])


def test_no_effect_on_a_predicate_that_only_invariants_mention_is_declared() -> None:
    domain = with_low(entry=False)
    assert explain_kept(domain, domain.block_by_name["SHOVING"], LOW) == "no entry or exit condition mentions low"


def test_an_entry_condition_requires_a_declaration() -> None:
    with pytest.raises(DomainError, match=r"SHOVING\.hand: the block must declare its effect on low\(hand\)"):
        with_low(entry=True)


@pytest.mark.parametrize(
    ("name", "predicate", "reason"),
    [
        ("REACHING:behind", DELIVERED, "the block writes nothing that inside reads"),
        ("SHOVING", BEHIND, "behind is maintained, so its facts end with the block that made them true"),
        ("SHOVING", AT_REST, ""),
        ("SHOVING", DELIVERED, ""),
    ],
)
def test_the_reason_is_known(name: str, predicate: Predicate, reason: str) -> None:
    domain = make_shoving()
    assert explain_kept(domain, domain.block_by_name[name], predicate) == reason


def test_changes_name_the_slot_and_the_properties() -> None:
    domain = make_shoving()
    (change,) = find_changes(domain, domain.block_by_name["SHOVING"], DELIVERED)
    assert (change.slot, change.parameter, change.names, change.handled) == ("object", "object", ("position",), True)


def test_the_check_reports_a_declaration_that_follows_anyway() -> None:
    def kept(*predicates: Predicate) -> Block:
        return replace(shoving_task().domain.block_by_name["SHOVING"], keeps=predicates)

    found = Disagreements()
    check_keeps(make_shoving(), [kept(BEHIND)], found)
    (mistake,) = found.all()
    assert (mistake.kind, mistake.block, mistake.remedy) == ("keeps", "SHOVING", "remove behind from 'keeps'")
    check_keeps(make_shoving(), [kept(DELIVERED)], sound := Disagreements())
    assert not sound.all()
