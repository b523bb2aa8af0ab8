"""What the README and other pages show runs."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = {"python/README.md": 2, "docs/whole-bodies.md": 2, "docs/strict-levels.md": 1, "docs/retargeting.md": 2}


@pytest.mark.parametrize(("page", "least"), PAGES.items())
def test_what_a_page_shows_runs(monkeypatch, page, least):
    monkeypatch.chdir(ROOT)
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.S)
    assert len(blocks) >= least
    names = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)  # noqa: S102
