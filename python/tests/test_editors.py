"""pyright, the language server of many editors, knows the types of the package and shows shapes and units."""

import json
import subprocess
import sys

import pytest

pytest.importorskip("pyright", reason="pip install pyright")
# The package downloads the program at its first use.
if subprocess.run([sys.executable, "-m", "pyright", "--version"], capture_output=True).returncode:
    pytest.skip("pyright cannot be downloaded here", allow_module_level=True)

PROGRAM = """\
import kinopt
arm = kinopt.Arm(robot, "base", "tool")
arm.solve(target)
kinopt.Problem(robot, [])
kinopt.retarget(capture, robot)
"""


def message(stream):
    """The next message of the language server."""
    length = 0
    while line := stream.readline().strip():
        if line.lower().startswith(b"content-length"):
            length = int(line.split(b":")[1])
    return json.loads(stream.read(length))


@pytest.fixture(scope="module")
def hover(tmp_path_factory):
    """A function that returns the text over the first occurrence of a word in the program."""
    file = tmp_path_factory.mktemp("editor") / "program.py"
    command = [sys.executable, "-m", "pyright.langserver", "--stdio"]
    server = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)

    def send(**content):
        data = json.dumps({"jsonrpc": "2.0", **content}).encode()
        server.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(data), data))
        server.stdin.flush()

    def ask(method, **params):
        send(id=method, method=method, params=params)
        while True:
            received = message(server.stdout)
            if "method" not in received and received.get("id") == method:
                return received["result"]
            if "method" in received and "id" in received:
                items = received.get("params", {}).get("items", [])
                send(id=received["id"], result=[{"pythonPath": sys.executable} for _ in items])

    folder = {"uri": file.parent.as_uri(), "name": "program"}
    text_document = {"hover": {"contentFormat": ["markdown"]}}
    capabilities = {"workspace": {"configuration": True}, "textDocument": text_document}
    ask("initialize", processId=None, rootUri=folder["uri"], capabilities=capabilities, workspaceFolders=[folder])
    send(method="initialized", params={})
    document = {"uri": file.as_uri(), "languageId": "python", "version": 1, "text": PROGRAM}
    send(method="textDocument/didOpen", params={"textDocument": document})

    def text(word):
        line, character = next((i, line.index(word)) for i, line in enumerate(PROGRAM.splitlines()) if word in line)
        position = {"line": line, "character": character}
        shown = ask("textDocument/hover", textDocument={"uri": file.as_uri()}, position=position)
        return shown["contents"]["value"].replace("\\", "")

    yield text
    server.kill()
    server.wait()


@pytest.mark.parametrize("name, words", [
    ("Arm", ("robot: Robot | Model", "shape (dof,)", "radians or metres")),
    ("solve", ("-> Solution", "shape (dof,)", "radians or metres")),
    ("Problem", ("tasks: Iterable[Task]", "shape (configuration_len,)", "radians and metres")),
    ("retarget", ("-> Trajectory[RetargetReport]", "shape (T, J, 3)", "shape (T, configuration_len)", "metres (else the model's unit) and radians")),
])
def test_hover_shows_shapes_and_units(hover, name, words):
    shown = hover(name)
    assert [word for word in words if word not in shown] == [], shown


def test_exported_types_are_known():
    # Types of NumPy that it leaves partly unknown do not count.
    command = [sys.executable, "-m", "pyright", "--pythonpath", sys.executable, "--verifytypes", "kinopt"]
    result = subprocess.run([*command, "--ignoreexternal", "--outputjson"], capture_output=True, text=True)
    types = json.loads(result.stdout)["typeCompleteness"]
    unknown = [s["name"] for s in types["symbols"] if s["isExported"] and not s["isTypeKnown"]]
    assert types["completenessScore"] >= 0.98, unknown
