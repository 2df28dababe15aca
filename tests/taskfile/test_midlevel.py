"""Tests of the settings of the mid-level planner in a task file, and of goals with a choice."""

import json
from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from hybrid_tamp_domains.rolling_tumbling import DOMAIN
from texts import load_task_text

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import Hyperparameter
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.measure import Measure
from hybrid_tamp.model.predicate import ANY, Atom, Binding
from hybrid_tamp.model.task import MidLevel, Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.reference import reference_page
from hybrid_tamp.taskfile.schema import json_schema
from hybrid_tamp.taskfile.yaml.nodes import parse

PROBLEMS = Path(__file__).parents[2] / "problems"
ROLL = (PROBLEMS / "roll_cylinder.yaml").read_text(encoding="utf-8")
EITHER = (PROBLEMS / "roll_to_either_region.yaml").read_text(encoding="utf-8")


def measured(block: Block) -> Block:
    """Return a block with two measures."""
    measures = (
        Measure("effort", "J", -0.5, end=lambda b, before, after, h: np.zeros(()), description="work that it takes"),
        Measure("haste", "1", 1.0, end=lambda b, before, after, h: np.zeros(())),
    )
    return replace(block, performance=measures)


MEASURED = DOMAIN.with_blocks([measured(b) for b in DOMAIN.blocks if b.action in ("ROLLING", "TIPPING")])


def load(section: str, domain: Domain = MEASURED) -> Task:
    return load_task_text(f"{ROLL}midlevel: {section}\n", "t", lambda name: domain)


def hyperparameter(task: Task, block: str, name: str) -> Hyperparameter:
    return next(h for h in task.domain.block_by_name[block].hyperparameters if h.name == name)


def test_the_task_says_what_the_section_says() -> None:
    task = load("{optimiser: grid, evaluations: 50, refine: physics}")
    assert task.midlevel == MidLevel("grid", 50, "physics")
    assert task.domain is MEASURED
    assert load("{}").midlevel == load_task_text(ROLL, "t").midlevel == MidLevel()


def test_weights_of_a_block_and_of_all_modes() -> None:
    task = load("{weights: {'TIPPING:lower.effort': 3, TIPPING.effort: 2, ROLLING.haste: -1}}")
    weights = {b.name: [m.weight for m in b.performance] for b in task.domain.blocks if b.performance}
    assert weights == {
        "TIPPING:opposite": [2.0, 1.0],
        "TIPPING:lower": [3.0, 1.0],
        "TIPPING:adjacent": [2.0, 1.0],
        "ROLLING": [-0.5, -1.0],
    }
    assert MEASURED.block_by_name["ROLLING"].performance[1].weight == 1.0


def test_bounds_are_narrowed_and_the_default_is_the_initial_value_of_a_whole_batch() -> None:
    task = load("{hyperparameters: {ROLLING.speed: {lower: 0.1, upper: 0.3, default: 0.2}}}")
    speed = hyperparameter(task, "ROLLING", "speed")
    assert (speed.lower, speed.upper) == (0.1, 0.3)
    assert speed.initial_value({}, task.state.repeated(3)).tolist() == [0.2, 0.2, 0.2]
    assert speed.initial_value({}, task.state).shape == ()


def test_what_is_left_out_stays_and_the_old_initial_value_is_clipped() -> None:
    task = load("{hyperparameters: {ROLLING.speed: {upper: 0.3}}}")
    speed = hyperparameter(task, "ROLLING", "speed")
    assert (speed.lower, speed.upper, float(speed.initial_value({}, task.state))) == (0.05, 0.3, 0.3)


def test_a_number_fixes_a_hyperparameter_of_every_mode() -> None:
    task = load("{hyperparameters: {TIPPING.rate: 0.7}}")
    for mode in ("opposite", "lower", "adjacent"):
        rate = hyperparameter(task, f"TIPPING:{mode}", "rate")
        assert (rate.lower, rate.upper, float(rate.initial_value({}, task.state))) == (0.7, 0.7, 0.7)


# ``«`` marks the place that the message must name.
FAULTS = {
    "{optimiser: «cmaa}": ("'cma' or 'grid'", "did you mean 'cma'?"),
    "{refine: «phisics}": ("did you mean 'physics'?",),
    "{evaluations: «0}": ("midlevel.evaluations must be more than 0",),
    "{evaluations: «-5}": ("more than 0", "got -5"),
    "{evaluations: «2.5}": ("must be a whole number",),
    "{«seconds: 5}": (
        "the key midlevel.seconds no longer exists",
        "delete the key, because midlevel.evaluations limits",
    ),
    "{«evalutions: 5}": ("unknown key in midlevel", "did you mean 'evaluations'?"),
    "{weights: {«ROLLING.efort: 1}}": ("a measure of the domain", "did you mean 'ROLLING.effort'?"),
    "{weights: {«ROLING.effort: 1}}": ("a measure of the domain", "did you mean 'ROLLING.effort'?"),
    "{weights: {«effort: 1}}": ("must be 'BLOCK.name' with a measure",),
    "{weights: {ROLLING.effort: «.nan}}": ("must be a finite number",),
    "{weights: {ROLLING.effort: «much}}": ("must be a number", "got 'much'"),
    "{hyperparameters: {«ROLLING.sped: 1}}": ("a hyperparameter of the domain", "did you mean 'ROLLING.speed'?"),
    "{hyperparameters: {«'TIPPING:lowr.rate': 1}}": ("did you mean 'TIPPING:lower.rate'?",),
    "{hyperparameters: {ROLLING.speed: «{lower: 0.5, upper: 0.2}}}": ("lower must not exceed upper", "got 0.5 and 0.2"),
    "{hyperparameters: {ROLLING.speed: {lower: 0.3, default: «0.2}}}": ("default", "between 0.3 and 0.6 [m/s]"),
    "{hyperparameters: {ROLLING.speed: {default: «0.7}}}": ("default", "between 0.05 and 0.6 [m/s]", "got 0.7"),
    "{hyperparameters: {ROLLING.speed: {lower: «0.01}}}": ("lower of ROLLING.speed must be between 0.05 and 0.6",),
    "{hyperparameters: {ROLLING.speed: {upper: «0.61}}}": ("upper of ROLLING.speed must be between 0.05 and 0.6",),
    "{hyperparameters: {ROLLING.speed: «0.9}}": ("fixed value of ROLLING.speed must be between 0.05 and 0.6 [m/s]",),
    "{hyperparameters: {ROLLING.speed: «.nan}}": ("must be a finite number",),
    "{hyperparameters: {ROLLING.speed: {upper: «.inf}}}": ("must be a finite number",),
    "{hyperparameters: {ROLLING.speed: {«lowr: 0.1}}}": ("unknown key", "did you mean 'lower'?"),
    "{hyperparameters: {TIPPING.rate: «5}}": ("TIPPING.rate", "between 0.1 and 1 [rad/s]"),
}


@pytest.mark.parametrize("section", FAULTS)
def test_a_fault_is_named_once_with_its_place(section: str) -> None:
    with pytest.raises(InputError) as caught:
        load(section.replace("«", ""))
    (issue,) = caught.value.issues
    assert all(word in str(issue) for word in FAULTS[section]), str(issue)
    assert issue.where == f"t:{len(ROLL.splitlines()) + 1}:{len('midlevel: ') + section.index('«') + 1}"


def test_bounds_that_no_token_of_the_task_allows_are_refused() -> None:
    def reach(binding: Binding) -> tuple[float, float]:
        drum = binding["object"]
        assert isinstance(drum, Token)
        return 0.1, 2 * drum["radius_of_rotation"]

    rolling = DOMAIN.block_by_name["ROLLING"]
    changed = [replace(h, within=reach) if h.name == "speed" else h for h in rolling.hyperparameters]
    domain = DOMAIN.with_blocks([replace(rolling, hyperparameters=tuple(changed))])
    assert hyperparameter(load("{hyperparameters: {ROLLING.speed: 0.2}}", domain), "ROLLING", "speed").upper == 0.2
    with pytest.raises(InputError, match=r"t:37:45: .* at least one token of the task: 0.1 to 0.2; got 0.3"):
        load("{hyperparameters: {ROLLING.speed: 0.3}}", domain)


def test_a_domain_without_measures_says_so() -> None:
    with pytest.raises(InputError, match="no block of rolling_tumbling has a measure"):
        load("{weights: {ROLLING.effort: 1}}", DOMAIN)


def test_schema_and_reference_page_know_the_section() -> None:
    schema = json_schema([MEASURED])
    validator = jsonschema.Draft202012Validator(schema)
    for section, right in (
        ("{weights: {TIPPING.effort: 1}, hyperparameters: {ROLLING.speed: {lower: 0.1}, TIPPING.rate: 1}}", True),
        ("{weights: {TIPPING.efort: 1}}", False),
        ("{hyperparameters: {TIPPING.rat: 1}}", False),
        ("{hyperparameters: {TIPPING.rate: fast}}", False),
        ("{evaluations: 0}", False),
        ("{optimiser: cmaa}", False),
    ):
        assert validator.is_valid(parse(f"{ROLL}midlevel: {section}\n", "t").data) == right, section
    assert "0.05 to 0.6 [m/s]. largest speed" in json.dumps(schema)
    page = reference_page([MEASURED])
    assert "- measure `effort` [J]: weight -0.5. work that it takes" in page
    assert "| `evaluations` | whole number |  | > 0" in page


def test_a_goal_may_leave_a_choice() -> None:
    task = load_task(PROBLEMS / "roll_to_either_region.yaml")
    assert task.goal == (Atom("inside", ("drum", ANY)),)
    assert [each.goal[0].arguments[1] for each in task.alternatives()] == ["near", "far"]
    assert jsonschema.Draft202012Validator(json_schema([DOMAIN])).is_valid(parse(EITHER, "t").data)


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        ("at_face: [hand, «'*', left]", ("no token can replace '*'", "add a token of class TUMBLABLE")),
        ("inside: [drum, «'*', near]", ()),
        (
            "inside: ['*', near]\n  - inside: [drum, far]",
            ("all goal atoms must be true at the same time", "got no such choice"),
        ),
    ],
)
def test_a_choice_of_nothing_is_refused(goal: str, words: tuple[str, ...]) -> None:
    text = EITHER.replace('inside: [drum, "*"]', goal.replace("«", ""))
    with pytest.raises(InputError) as caught:
        load_task_text(text, "t")
    (issue,) = caught.value.issues
    assert all(word in str(issue) for word in words), str(issue)
    if "«" in goal and words:
        assert issue.where == f"t:{EITHER.splitlines().index('goal:') + 2}:{len('  - ') + goal.index('«') + 1}"
