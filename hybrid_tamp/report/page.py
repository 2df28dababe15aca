"""The page report.html, which presents the documents, pictures and video of a run."""

from importlib.resources import files
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.report.documents import Json, parse_document
from hybrid_tamp.report.folder import NUMBERED_FILES, RUN_FILES, RunFolder
from hybrid_tamp.report.refinement_tables import KEPT, MEANINGS, comparison, efforts, exclusion_text, number, values
from hybrid_tamp.report.tables import allocation, allocations, margin, network_text, plan_footer, reasons

PAGE = "report.html"


def write_page(folder: RunFolder, resting: str) -> Path:
    """Write the report page from the documents that `plan` or `run` wrote.

    Args:
        folder: the folder with plan.json and, after a run, result.json.
        resting: name of the block in which tokens rest.

    Raises:
        InputError: a document is missing or wrong, or the folder is not writable.
    """
    plan = _read(folder.path / "plan.json", "plan-1")
    run = folder.path / "result.json"
    result = _read(run, "result-1") if run.exists() else None
    return folder.write_text(PAGE, _template().render(_content(folder.path, plan, result, resting)))


def _template() -> Any:
    from jinja2 import Environment, StrictUndefined

    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    for function in (allocations, exclusion_text, margin, number, reasons):
        environment.filters[function.__name__] = function
    return environment.from_string(files("hybrid_tamp.report").joinpath("page.html").read_text(encoding="utf-8"))


def _content(path: Path, plan: Json, result: Json | None, resting: str) -> dict[str, Any]:
    refinement, task_file = plan["refinement"], path / "task.yaml"
    there = sorted(name for name in RUN_FILES if name != PAGE and (path / name).exists())
    return {
        "plan": plan,
        "result": result,
        "resting": resting,
        "lanes": lanes(plan, resting),
        "footer": plan_footer(plan) if plan["steps"] else "",
        "network": network_text(plan["network"]).splitlines(),
        "clearance": (result or plan)["clearance"],
        "performance": (result or refinement or {"performance": []})["performance"],
        "values": list(values(refinement)) if refinement else [],
        "effort": "; ".join(efforts(refinement)) if refinement else "",
        "meaning": MEANINGS[refinement["objective"]] if refinement else "",
        "kept": KEPT,
        "comparison": list(comparison(result["comparison"])) if result else [],
        "steps": sorted(file.name for file in path.glob(NUMBERED_FILES[0])),
        "video": "video.mp4" if "video.mp4" in there else "",
        "movements": "movements.png" if "movements.png" in there else "",
        "convergence": "convergence.png" if "convergence.png" in there else "",
        "files": there,
        "task_file": task_file.read_text(encoding="utf-8") if task_file.exists() else "",
    }


def lanes(plan: Json, resting: str) -> dict[str, list[Json]]:
    """Map each token to its timeline bars, with sizes in percent of the makespan. A resting token has no bar."""
    found: dict[str, list[Json]] = {}
    for step in plan["steps"]:
        for entry in step["blocks"]:
            for token in entry["slots"].values():
                bars = found.setdefault(token, [])
                if entry["block"] == resting:
                    continue
                left, right = (round(100 * step[end] / (plan["makespan"] or 1.0), 2) for end in ("start", "end"))
                if bars and bars[-1]["name"] == entry["instance"]:
                    bars[-1]["width"] = round(right - bars[-1]["left"], 2)
                else:
                    title = f"{allocation(entry)}, from {step['start']:.2f} s"
                    width = round(right - left, 2)
                    bars.append({"name": entry["instance"], "left": left, "width": width, "title": title})
    return dict(sorted(found.items()))


def _read(file: Path, stem: str) -> Json:
    """Return the document in a file, or raise `InputError` if the file does not follow the published JSON Schema."""
    try:
        return parse_document(stem, file.read_bytes())
    except OSError as error:
        wanted = f"cannot read {file.name}, which `plan` or `run` should have written"
        raise InputError([Issue(str(file), wanted, str(error.strerror))]) from error
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "the document"
        wanted = f"the document must follow the published JSON Schema of {file.name}"
        raise InputError([Issue(str(file), wanted, f"at {place}: {first['msg']}")]) from error
