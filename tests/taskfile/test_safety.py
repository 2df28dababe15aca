"""Tests of safety factors in a task file."""

from pathlib import Path

import jsonschema
import pytest
from hybrid_tamp_domains.joint_lifting import DOMAIN
from hybrid_tamp_domains.rolling_tumbling import DOMAIN as ROLLING
from texts import load_task_text

from hybrid_tamp.errors import InputError
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.reference import reference_page
from hybrid_tamp.taskfile.saving import differences, save_task
from hybrid_tamp.taskfile.schema import json_schema
from hybrid_tamp.taskfile.yaml.nodes import parse

LIFT = (Path(__file__).parents[2] / "problems" / "lift_two_hands.yaml").read_text(encoding="utf-8")


def test_a_task_without_the_key_has_the_factors_of_the_domain() -> None:
    task = load_task_text(LIFT, "t")
    assert task.safety == {}
    assert task.domain.safety == DOMAIN.safety == {"bears": 1.5}


def test_a_task_chooses_its_factors_and_keeps_them_when_it_is_saved(tmp_path: Path) -> None:
    task = load_task_text(f"{LIFT}safety: {{bears: 1.2}}\n", "t")
    assert task.safety == task.domain.safety == {"bears": 1.2}
    assert DOMAIN.safety == {"bears": 1.5}
    save_task(task, tmp_path / "t.yaml")
    again = load_task(tmp_path / "t.yaml")
    assert again.domain.safety == {"bears": 1.2}
    assert differences(task.replaced(name="t"), again) == []
    assert differences(task, task.with_safety({"bears": 1.3})) == ["safety differs"]


@pytest.mark.parametrize(
    ("section", "place", "said"),
    [
        ("{bears: 0.9}", "bears", "safety.bears must be at least 1; got 0.9"),
        ("{beers: 2}", "beers", "must be a predicate of the domain joint_lifting with a safety factor; got 'beers'"),
        ("{fits: 2}", "fits", "must be a predicate of the domain joint_lifting with a safety factor; got 'fits'"),
        ("{bears: much}", "bears", "safety.bears must be a number"),
    ],
)
def test_a_wrong_factor_is_refused_at_its_place(section: str, place: str, said: str) -> None:
    text = f"{LIFT}safety: {section}\n"
    with pytest.raises(InputError) as caught:
        load_task_text(text, "t")
    (issue,) = caught.value.issues
    assert said in str(issue)
    assert issue.where.startswith(f"t:{len(LIFT.splitlines()) + 1}:")
    validator = jsonschema.Draft202012Validator(json_schema([DOMAIN]))
    assert not validator.is_valid(parse(text, "t").data)


def test_the_schema_accepts_a_factor_and_the_reference_describes_it() -> None:
    validator = jsonschema.Draft202012Validator(json_schema([DOMAIN, ROLLING]))
    assert validator.is_valid(parse(f"{LIFT}safety: {{bears: 1}}\n", "t").data)
    assert "safety factor 1.5 (key `safety`): ratio of the squeeze" in reference_page([DOMAIN])
