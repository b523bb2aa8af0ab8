"""The tables of docs/options.md name the options that there are, and no others."""

import inspect
import re
from pathlib import Path

import pytest

import kinopt

PAGE = (Path(__file__).parents[2] / "docs/options.md").read_text()


def named(section):
    """What a section's table has in its column of Python."""
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
    "Problems": keywords(kinopt.Problem, ["model"]),
    "Tasks": sorted(name for name in kinopt.tasks.Task.__dataclass_fields__ if not name.startswith("_")),
    "Solvers": sorted([*keywords(kinopt.Solver), *(name for name in METHODS if name not in ("damping", "_kind"))]),
    "Drags": keywords(kinopt.Drag, ["problem", "start"]),
    "Paths": keywords(kinopt.solve_path, ["arm", "path"]),
}


@pytest.mark.parametrize(("section", "there"), SECTIONS.items())
def test_a_table_has_every_keyword(section, there):
    assert named(section) == there
