"""The tables of docs/reference/options.md list exactly the existing options."""

import inspect
import re
from pathlib import Path

import pytest

import kinopt

PAGE = (Path(__file__).parents[2] / "docs/reference/options.md").read_text()


def named(section):
    """The Python column of the table of a section."""
    part = PAGE.split(f"\n## {section}\n")[1].split("\n## ")[0]
    rows = [line.split("|")[1:-1] for line in part.splitlines() if line.startswith("|")]
    column = [cell.strip() for cell in rows[0]].index("Python")
    return sorted(name for row in rows[2:] for name in re.findall(r"`([^`]+)`", row[column]))


def keywords(called, but=()):
    """The keywords of a class or a function."""
    return sorted(set(inspect.signature(called).parameters) - set(but))


METHODS = [field for name in ("LevenbergMarquardt", "GaussNewton") for field in getattr(kinopt.methods, name).__dataclass_fields__]
SECTIONS = {
    "Arms": keywords(kinopt.Arm, ["robot", "base", "tip"]),
    "Followers and servos": keywords(kinopt.Arm.servo, ["self", "start", "time_step"]),
    "Reach maps": keywords(kinopt.ReachMap.build, ["arm"]),
    "Problems": keywords(kinopt.Problem, ["model"]),
    "Tasks": sorted(name for name in kinopt.tasks.Task.__dataclass_fields__ if not name.startswith("_")),
    "Solvers": sorted([*keywords(kinopt.Solver), *(name for name in METHODS if name not in ("damping", "_kind"))]),
    "Drags": keywords(kinopt.Drag, ["problem", "start"]),
    "Paths": keywords(kinopt.solve_path, ["arm", "path"]),
    "Trajectories": keywords(kinopt.JointPath.trajectory, ["self"]),
}


@pytest.mark.parametrize(("section", "keywords_of_section"), SECTIONS.items())
def test_table_has_every_keyword(section, keywords_of_section):
    assert named(section) == keywords_of_section


def test_page_on_choosing_names_existing_items():
    page = (Path(__file__).parents[2] / "docs/guide/choosing.md").read_text()
    dotted = keyword = 0
    for table in re.findall(r"(?:^\|.*\n)+", page, re.MULTILINE):
        rows = [line.split("|")[1:-1] for line in table.splitlines()]
        column = next(k for k, cell in enumerate(rows[0]) if "Python" in cell)
        for name in (name for row in rows[2:] for name in re.findall(r"`([^`]+)`", row[column])):
            word = name.split("=")[0]
            if word in SECTIONS["Arms"]:
                keyword += 1
                continue
            item = kinopt
            for part in name.split("."):
                item = getattr(item, part)
            dotted += 1
    assert dotted > 20 and keyword > 10
