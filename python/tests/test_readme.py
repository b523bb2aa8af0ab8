"""What the README and other pages show runs."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = ["python/README.md", *sorted(f"docs/{page.name}" for page in (ROOT / "docs").glob("*.md"))]


def blocks_of(page):
    return re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(), re.S | re.M)


@pytest.mark.parametrize("page", [page for page in PAGES if blocks_of(page)])
def test_what_a_page_shows_runs(monkeypatch, page):
    monkeypatch.chdir(ROOT)
    names = {}
    for block in blocks_of(page):
        exec(compile(block, page, "exec"), names)  # noqa: S102


def test_most_pages_show_something():
    assert sum(bool(blocks_of(page)) for page in PAGES) >= 12
