"""Messages about exceptions in functions of a domain name the function, its tokens and the line of the code."""

import ast
import copy
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from contracts.imports import ROOT

import hybrid_tamp
from hybrid_tamp.errors import DomainError, Issue, LimitReached
from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.block import Duration
from hybrid_tamp.model.control import Hyperparameter
from hybrid_tamp.model.measure import Measure

BOUND = "for pusher=pusher, spot=spot"


def misspelt(binding: Any, *rest: Any) -> Any:
    return binding["psuher"]


def later(binding: Any, *rest: Any) -> Any:
    return lambda *more: binding["psuher"]


def still(binding: Any, start: Any, parameters: Any) -> Any:
    return lambda elapsed, state: {("pusher", "force"): -40.0 * state["pusher", "velocity"]}


def measure(**how: Any) -> Any:
    return {"performance": (Measure("effort", "N", -1.0, **how),), "hyperparameters": (), "policy": still}


BROKEN = {
    "MOVING.policy": {"policy": misspelt},
    "MOVING.policy: ": {"policy": later},
    "MOVING.system": {"system": misspelt},
    "MOVING.system: ": {"system": later},
    "MOVING.outcome": {"outcome": misspelt},
    "MOVING.duration": {"duration": Duration(0.2, 3.0, misspelt)},
    "MOVING.stiffness": {"hyperparameters": (Hyperparameter("stiffness", "N/m", 1.0, 9.0, misspelt),)},
    "MOVING.effort": measure(end=misspelt),
    "MOVING.effort: ": measure(peak=misspelt),
    "MOVING.effort:  ": measure(rate=misspelt),
}


@pytest.mark.parametrize("where", BROKEN)
def test_a_block_is_named_with_its_function_and_roles(toys: Any, tmp_path: Path, where: str) -> None:
    task = toys.one_move_task(**BROKEN[where])
    with pytest.raises(DomainError) as caught:
        hybrid_tamp.run(task, tmp_path / "run", backend="analytic")
    (issue,) = caught.value.issues
    assert issue.where == where.rstrip(": ")
    assert BOUND in issue.wanted
    assert issue.came.startswith("KeyError: 'psuher' in line ")
    assert issue.came.endswith("of test_authored.py")
    assert issue.remedy == "did you mean 'pusher'?"


def near(task: Any, margin: Any) -> Any:
    broken = replace(task.domain.predicate_by_name["near"], margin=margin)
    predicates = tuple(broken if each.name == "near" else each for each in task.domain.predicates)
    blocks = [
        replace(
            block, exit=tuple(replace(x, predicate=broken) if x.predicate.name == "near" else x for x in block.exit)
        )
        for block in task.domain.blocks
    ]
    return task.replaced(domain=replace(task.domain, predicates=predicates, blocks=tuple(blocks)))


@pytest.mark.parametrize(
    ("margin", "came"),
    [
        (
            lambda state, pusher, spot: spot["raduis"],
            "UnknownProperty: spot has no property 'raduis'; did you mean 'radius'?",
        ),
        (lambda state, pusher, spot: state[pusher, "postion"], "did you mean 'position'?"),
        (lambda state, pusher: 1.0, "TypeError: "),
        (lambda state, pusher, spot: "far", "of test_authored.py"),
        (lambda state, pusher, spot: 1 / 0, "ZeroDivisionError: division by zero in line "),
    ],
)
def test_a_predicate_is_named_with_its_arguments(toys: Any, margin: Any, came: str) -> None:
    with pytest.raises(DomainError) as caught:
        hybrid_tamp.plan(near(toys.one_move_task(), margin))
    (issue,) = caught.value.issues
    assert issue.where == "predicate near"
    assert BOUND in issue.wanted
    assert came in issue.came or margin(None, None, None) == "far"


def test_a_domain_is_named_with_its_metrics(toys: Any, tmp_path: Path) -> None:
    task = toys.one_move_task()
    task = task.replaced(domain=replace(task.domain, metrics=lambda task, recording: recording.state(0)["nobody", "x"]))
    with pytest.raises(DomainError, match=r"the metrics of toy: .* nobody has no property 'x'"):
        hybrid_tamp.run(task, tmp_path / "run", backend="analytic")


def test_errors_of_the_library_pass_unchanged() -> None:
    for error in (LimitReached("the time limit was reached"), MemoryError(), KeyboardInterrupt()):
        with pytest.raises(type(error)) as caught, authored("ROLLING.policy", {}):
            raise error
        assert caught.value is error


def test_the_error_survives_the_way_between_processes() -> None:
    error = DomainError([Issue("ROLLING.policy", "the function must not fail", "1"), Issue("", "other")])
    again = copy.copy(error)  # uses the same method as a pickle
    assert (type(again), again.issues, str(again)) == (DomainError, error.issues, str(error))


FUNCTIONS = {"policy", "system", "outcome", "expected", "taught", "metrics", "estimate", "align", "share"}
FUNCTIONS |= {
    "end",
    "peak",
    "rate",
    "consistent",
    "consistent_start",
    "features",
    "within",
    "initial_value",
    "bound",
    "confines",
}
"""Names under which the library calls functions of a domain."""
RECEIVERS = {"block", "duration", "domain", "recipe", "predicate", "measure", "member", "object_class", "own", "h"}


def unguarded(node: ast.AST, guarded: bool = False) -> Iterator[ast.Call]:
    """Yield the calls of functions of a domain outside the context `authored`."""
    if isinstance(node, ast.With):
        guarded |= any(
            isinstance(c := i.context_expr, ast.Call) and ast.unparse(c.func) == "authored" for i in node.items
        )
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in FUNCTIONS:
        receiver = ast.unparse(node.func.value).split(".")[-1]
        own = node.func.attr == "initial_value" and receiver == "block"  # guarded inside
        if receiver in RECEIVERS and not guarded and not own:
            yield node
    for child in ast.iter_child_nodes(node):
        yield from unguarded(child, guarded)


def test_every_call_of_an_authors_function_is_guarded() -> None:
    files = sorted(Path(ROOT, "hybrid_tamp").rglob("*.py"))
    found = [f"{f.name}:{c.lineno}: {ast.unparse(c)}" for f in files for c in unguarded(ast.parse(f.read_text()))]
    assert found == []
