"""What the README shows runs."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
README = (ROOT / "python" / "README.md").read_text()


def test_the_readme_runs(monkeypatch):
    monkeypatch.chdir(ROOT)
    blocks = re.findall(r"```python\n(.*?)```", README, re.S)
    assert len(blocks) >= 2
    names = {}
    for block in blocks:
        exec(compile(block, "README.md", "exec"), names)  # noqa: S102
