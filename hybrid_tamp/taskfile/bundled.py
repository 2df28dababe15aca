"""Descriptions of the bundled task files."""

import re
from itertools import takewhile
from pathlib import Path

from hybrid_tamp.model.listings import BundledTask
from hybrid_tamp.taskfile.domains import bundled_tasks, find_task_file
from hybrid_tamp.taskfile.yaml.nodes import parse, read_text

_REFERENCE = re.compile(r" \(paper,[^)]*\)")


def describe_bundled() -> list[BundledTask]:
    """Return the bundled tasks, sorted by name. The files are read, but not checked."""
    return [_describe(name, find_task_file(name)) for name in bundled_tasks()]


def _describe(name: str, path: Path) -> BundledTask:
    text = read_text(path)
    comments = takewhile(lambda line: line.startswith("#"), text.splitlines())
    # References to the paper contain full stops.
    about = _REFERENCE.sub("", " ".join(line.lstrip("# ") for line in comments))
    sentence, _, _ = about.partition(". ")
    return BundledTask(name, str(parse(text, str(path)).data.get("domain", "")), f"{sentence.rstrip('.')}.", path)
