"""The code of the README and of other pages runs."""

import os
import re
import shlex
import socket
import subprocess
import sys
import urllib.request
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


OPENERS = [
    pytest.param(language, block, id=f"{page}-{number}")
    for page in PAGES
    for number, (language, block) in enumerate(
        re.findall(r"^```(sh|python) until its page answers\n(.*?)^```", (ROOT / page).read_text(), re.S | re.M)
    )
]


def a_free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.mark.parametrize("language, block", OPENERS)
def test_what_opens_a_page_opens_one(language, block):
    pytest.importorskip("viser", reason="SKIPPED LOUDLY: viser is not installed: pip install 'kinopt[view]'")
    if language == "sh":
        (line,) = [line for line in block.splitlines() if not line.startswith("pip install")]
        words = shlex.split(line)
        assert words[:3] == ["python", "-m", "kinopt.view"]
        command = [sys.executable, *words[1:], "--no-browser", "--port", str(a_free_port())]
    else:
        # Code that waits for ever prints its address first.
        assert block.count("scene.wait()") == 1
        command = [sys.executable, "-c", block.replace("scene.wait()", "print(scene.url, flush=True); scene.wait()")]
    environment = {**os.environ, "BROWSER": "true"}
    with subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            told = (line for line in process.stdout if "http://" in line)
            url = re.search(r"http://\S+", next(told))
            assert url is not None
            with urllib.request.urlopen(url[0], timeout=120) as page:
                assert page.status == 200
        finally:
            process.kill()


def test_some_pages_open_one():
    assert len(OPENERS) >= 4


def test_most_pages_show_something():
    assert sum(bool(blocks_of(page)) for page in PAGES) >= 12
