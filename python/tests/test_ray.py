"""Targets on Ray's workers: results are equal to those without Ray, and none is lost when a worker is killed."""

import importlib.util
import os
import pickle
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import kinopt

pytest.importorskip("ray", reason="SKIPPED LOUDLY: ray is not installed: pip install 'kinopt[ray]'")

import pyarrow as pa  # noqa: E402
import pyarrow.parquet as pq  # noqa: E402
import ray  # noqa: E402

import kinopt.ray as kr  # noqa: E402
from kinopt import tasks  # noqa: E402
from ray_cluster import ray_cluster  # noqa: E402
from waiting import wait_until  # noqa: E402

MODELS = Path(__file__).parents[2] / "models"
COUNT, BLOCK = 1000, 150
RESULT_COLUMNS = ["q", "reached", "position_error", "orientation_error", "attempts", "iterations"]


@pytest.fixture(scope="module")
def arm():
    return kinopt.Arm(kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf"), "base", "flange")


@pytest.fixture(scope="module")
def start(arm):
    return np.clip(np.full(7, 0.3), arm.lower, arm.upper)


@pytest.fixture(scope="module")
def targets(arm):
    q = np.random.default_rng(11).uniform(arm.lower, arm.upper, (COUNT, 7))
    targets = arm.base_from_tool(q)
    targets[::10, :3, 3] *= 3.0  # some that cannot be reached
    return targets


@pytest.fixture(scope="module")
def want(arm, targets, start):
    return arm.solve_batch(targets, start)


@pytest.fixture(scope="module")
def cluster():
    # Workers cannot import this file.
    ray.cloudpickle.register_pickle_by_value(sys.modules[__name__])
    with ray_cluster():
        ray.data.DataContext.get_current().enable_progress_bars = False
        yield


@pytest.fixture
def folder(tmp_path, targets):
    table = kr.table(target=targets, number=np.arange(COUNT))
    kr.write_blocks(table, tmp_path / "targets", BLOCK)
    return tmp_path


def assert_same(answers, want):
    """Asserts bitwise equal results, in the order of numbers."""
    answers = answers.sort_by("number")
    assert answers.column_names == ["number", *RESULT_COLUMNS]
    assert answers["number"].to_pylist() == list(range(COUNT))
    assert np.array_equal(kr.numbers(answers, "q"), want.q)
    for name in RESULT_COLUMNS[1:]:
        assert np.array_equal(answers[name].to_numpy(), getattr(want, name)), name


def gathered(dataset):
    return pa.concat_tables([ray.get(block) for block in dataset.to_arrow_refs()])


def test_arrays_and_tables_convert_without_a_copy(targets):
    table = kr.table(target=targets, number=np.arange(COUNT))
    back = kr.numbers(table, "target", (4, 4))
    assert np.array_equal(back, targets) and np.shares_memory(back, targets)


@pytest.mark.parametrize(
    "kind",
    [
        pa.list_(pa.float64()),
        pa.large_list(pa.float64()),
        pa.list_(pa.float32(), 16),
        pa.list_(pa.list_(pa.float64(), 4), 4),
        pa.fixed_shape_tensor(pa.float64(), (4, 4)),
    ],
    ids=str,
)
def test_targets_of_any_arrow_kind_are_read(targets, kind):
    few = targets[:5].astype(np.float32) if "float" in str(kind) else targets[:5]
    rows = few if kind == pa.list_(pa.list_(pa.float64(), 4), 4) else few.reshape(5, 16)
    storage = kind.storage_type if isinstance(kind, pa.ExtensionType) else kind
    column = pa.array(rows.tolist(), storage)
    if isinstance(kind, pa.ExtensionType):
        column = pa.ExtensionArray.from_storage(kind, column)
    # In two chunks, of which the second begins inside its buffer.
    column = pa.chunked_array([column[:2], column[2:]])
    assert np.array_equal(kr.numbers(pa.table({"target": column}), "target", (4, 4)), few)
    assert np.array_equal(kr.numbers(pa.table({"target": column}).slice(3), "target", (4, 4)), few[3:])


@pytest.mark.parametrize(
    ("column", "message"),
    [
        ([[1.0] * 16, None], "'target' has empty entries"),
        ([[1.0] * 15 + [None]], "'target' has empty entries"),
        ([[1.0] * 15], "15 numbers a row, not 16"),
        ([[1.0] * 16, [1.0] * 15], "rows of different lengths"),
        (["here"], "string for numbers"),
        ([[1.0] * 16], "target 0"),
    ],
)
def test_invalid_target_columns_raise(arm, column, message):
    with pytest.raises(kinopt.InvalidValueError, match=message):
        kr.SolveArm(arm)(pa.table({"target": column}))


def test_invalid_input_raises_before_workers_start(arm, start, targets):
    table = kr.table(target=targets, q=np.zeros(COUNT))
    with pytest.raises(kinopt.InvalidValueError, match="start"):
        kr.SolveArm(arm, start[:3])
    with pytest.raises(kinopt.InvalidValueError, match="no column 'goal'"):
        kr.SolveArm(arm, target="goal")(table)
    with pytest.raises(kinopt.InvalidValueError, match="column 'q' has the name of a result"):
        kr.SolveArm(arm)(table)
    with pytest.raises(kinopt.InvalidValueError, match="one length"):
        kr.table(target=targets, number=[1, 2])
    assert kr.SolveArm(arm, keep=[])(table).column_names == RESULT_COLUMNS


@pytest.fixture(scope="module")
def problem():
    """A humanoid with tasks for hand, eyes, foot and chest, and a joint."""
    rig = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
    rest = kinopt.ForwardKinematics(rig).place(np.zeros(rig.model.degrees_of_freedom))
    at = dict(zip(rig.model.frame_names, rest))
    return kinopt.Problem(
        rig,
        [
            tasks.Point("left_hand/tip", at["left_hand/tip"][:3, 3], name="hand"),
            tasks.Pose("right_foot", at["right_foot"], name="foot"),
            tasks.Orientation("chest", at["chest"], name="chest"),
            tasks.Plane("right_hand/tip", at["right_hand/tip"][:3, 3], [0, 1, 0], name="table"),
            tasks.Distance("left_hand/tip", "head", 0.6, name="apart", role="preference"),
        ],
    )


def test_tables_solve_problems_equally(problem):
    seeded = np.random.default_rng(3)
    count = 20
    frames = {task.name: task for task in problem.tasks}
    hand = frames["hand"].target + seeded.uniform(-0.1, 0.1, (count, 3))
    foot = np.tile(frames["foot"].target, (count, 1, 1))
    foot[:, :3, 3] += seeded.uniform(-0.05, 0.05, (count, 3))
    chest = np.tile(frames["chest"].target, (count, 1, 1))
    table = np.tile([frames["table"].point, frames["table"].normal], (count, 1, 1))
    table[:, 0] += seeded.uniform(-0.1, 0.1, (count, 3))
    apart = seeded.uniform(0.4, 0.8, count)
    targets = {"hand": hand, "foot": foot, "chest": chest, "table": table, "apart": apart}
    start = np.zeros(problem.configuration_len)
    want = kinopt.Solver(seed=5).solve_batch(problem, start, targets)
    columns = {name: f"to_{name}" for name in targets}
    target_table = kr.table(number=np.arange(count), **{f"to_{name}": values for name, values in targets.items()})
    solver = kr.SolveProblem(problem, start, targets=columns, solver=kinopt.Solver(seed=5))
    for solver in (solver, pickle.loads(pickle.dumps(solver))):
        answers = solver(target_table)
        assert answers.column_names == ["number", *RESULT_COLUMNS] and want.reached.mean() > 0.5
        assert np.array_equal(kr.numbers(answers, "q"), want.q)
        for name in RESULT_COLUMNS[1:]:
            assert np.array_equal(answers[name].to_numpy(), getattr(want, name)), name
    # Without targets there is one query for each row, here with its own start.
    starts = seeded.uniform(-0.2, 0.2, (3, len(start)))
    answers = kr.SolveProblem(problem, starts="from")(kr.table(**{"from": starts}))
    assert np.array_equal(kr.numbers(answers, "q"), kinopt.Solver().solve_batch(problem, starts).q)
    # No joint moves farther than `max_move`.
    near = kr.SolveProblem(problem, start, targets=columns, max_move=0.05)(target_table)
    want = kinopt.Solver().solve_batch(problem, start, targets, max_move=0.05)
    assert np.array_equal(kr.numbers(near, "q"), want.q) and np.abs(want.q - start).max() <= 0.05
    with pytest.raises(kinopt.InvalidValueError):
        kr.SolveProblem(problem, start, max_move=-1.0)(target_table)
    assert kr.SolveProblem(problem, start)(target_table.select(["number"])).num_rows == count
    assert kr.SolveProblem(problem, start, targets={"hand": "to_hand"})(target_table.slice(0, 0)).num_rows == 0

    with pytest.raises(kinopt.UnknownNameError, match="no task 'nose'"):
        kr.SolveProblem(problem, start, targets={"nose": "to_hand"})
    with pytest.raises(kinopt.InvalidValueError, match="finite numbers"):
        kr.SolveProblem(problem, start[:4])
    with pytest.raises(kinopt.InvalidValueError, match="start"):
        kr.SolveProblem(problem)
    with pytest.raises(kinopt.InvalidValueError, match="'to_hand' has 3 numbers a row, not 16"):
        kr.SolveProblem(problem, start, targets={"foot": "to_hand"})(target_table)


def test_goals_in_other_units_have_empty_errors():
    robot = kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")
    problem = kinopt.Problem(robot, [tasks.Posture(robot.neutral(), role="goal", tolerance=1e-3)])
    answers = kr.SolveProblem(problem, robot.neutral())(kr.table(number=[1, 2]))
    assert answers["position_error"].null_count == 2 and answers["reached"].to_pylist() == [True, True]


def test_table_may_be_empty_or_contain_starts(arm, targets, want):
    answers = kr.SolveArm(arm)(kr.table(target=targets[:0]))
    assert answers.num_rows == 0 and answers.column_names == RESULT_COLUMNS
    starts = want.q[::-1].copy()
    answers = kr.SolveArm(arm, starts="from")(kr.table(target=targets, **{"from": starts}))
    assert np.array_equal(kr.numbers(answers, "q"), arm.solve_batch(targets, starts).q)


class Dies(kr.SolveArm):
    """A worker that is killed, once, in the middle of the job."""

    marker: Path

    def __call__(self, targets):
        if 500 in targets["number"].to_pylist() and not self.marker.exists():
            self.marker.write_text(str(os.getpid()))
            os.kill(os.getpid(), signal.SIGKILL)
        return super().__call__(targets)


@pytest.fixture
def dies(tmp_path, arm, start):
    solver = Dies(arm, start)
    solver.marker = tmp_path / "killed"
    yield solver
    assert int(solver.marker.read_text()) != os.getpid()


def test_dataset_survives_a_killed_worker_bitwise(
    cluster, folder, dies, want
):
    dataset = ray.data.read_parquet(str(folder / "targets"))
    assert_same(gathered(kr.solve(dataset, dies, workers=2, batch_size=64)), want)


JOB = """
import sys, time
from pathlib import Path
import numpy as np
import ray
import kinopt, kinopt.ray as kr

class Slow(kr.SolveArm):
    def __call__(self, targets):
        if targets["number"][0].as_py() >= 300:
            time.sleep(600)
        return super().__call__(targets)

urdf, folder, address = sys.argv[1:]
ray.init(address=address, log_to_driver=False)
arm = kinopt.Arm(kinopt.Robot.from_urdf(urdf), "base", "flange")
kr.solve_files(folder + "/targets", folder + "/answers", Slow(arm, np.full(7, 0.3)), workers=1)
"""


def test_killed_job_resumes_after_a_killed_worker(
    cluster, folder, arm, start, dies, targets, want
):
    address = ray.get_runtime_context().gcs_address
    job = subprocess.Popen(
        [sys.executable, "-c", JOB, MODELS / "franka_panda.urdf", folder, address],
        stderr=subprocess.PIPE,
    )
    into = folder / "answers"
    finished = ["000000.parquet", "000001.parquet"]
    wait_until(
        lambda: job.poll() is not None or all((into / name).exists() for name in finished), seconds=240.0
    )
    assert job.poll() is None, job.stderr.read().decode()
    job.kill()
    job.wait()
    before = {name: (into / name).stat().st_mtime_ns for name in finished}
    assert sorted(path.name for path in into.glob("0*")) == finished
    # The partial file of a killed job, and a truncated file.
    (into / ".000003.parquet.x.part").write_bytes(b"PAR1")
    (into / "000004.parquet").write_bytes((into / finished[0]).read_bytes()[:-100])

    answers = kr.solve_files(folder / "targets", into, dies, workers=2)
    assert_same(answers.to_table(), want)
    assert {name: (into / name).stat().st_mtime_ns for name in finished} == before
    # In the order of the targets, each file complete, and nothing else.
    assert answers.to_table()["number"].to_pylist() == list(range(COUNT))
    names = sorted(path.name for path in (folder / "targets").iterdir())
    assert sorted(path.name for path in into.iterdir()) == names

    # Results of another query are not reused.
    with pytest.raises(kinopt.InvalidValueError, match="belongs to another query"):
        kr.solve_files(folder / "targets", into, kr.SolveArm(arm, -start))

    # Changed files are solved again; an invalid one is reported after the others are solved.
    bad = targets[:BLOCK].copy()
    bad[7, 0, 0] = np.nan
    changed = kr.table(target=[*bad, *targets[:100]], number=np.arange(BLOCK + 100))
    for new_name, old_name in zip(kr.write_blocks(changed, folder / "new", BLOCK), [names[2], names[5]]):
        os.replace(folder / "new" / new_name, folder / "targets" / old_name)
    with pytest.raises(kinopt.InvalidValueError, match=r"000002\.parquet: target 7: .*expected a finite number"):
        kr.solve_files(folder / "targets", into, dies, workers=1)
    assert pq.read_table(into / names[5])["number"].to_pylist() == list(range(BLOCK, BLOCK + 100))
    assert {name: (into / name).stat().st_mtime_ns for name in finished} == before


def test_readme_code_runs(cluster, tmp_path, monkeypatch, arm, start, targets):
    page = (Path(__file__).parents[1] / "README.md").read_text()
    blocks = re.findall(r"^<!-- with Ray -->\n```python\n(.*?)^```", page, re.S | re.M)
    monkeypatch.chdir(tmp_path)
    names = {"np": np, "arm": arm, "start": start, "targets": targets, "kinopt": kinopt}
    for block in blocks:
        exec(compile(block, "README.md", "exec"), names)  # noqa: S102
    assert len(blocks) == 1
    assert np.array_equal(names["q"], arm.solve_batch(targets, start).q)


def test_example_draws_a_reachability_map(cluster, tmp_path, monkeypatch, capsys):
    pytest.importorskip("matplotlib", reason="SKIPPED LOUDLY: matplotlib is not installed").use("Agg")
    path = Path(__file__).parents[2] / "examples" / "python" / "reachability.py"
    spec = importlib.util.spec_from_file_location("reachability", path)
    example = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "reachability", example)
    spec.loader.exec_module(example)
    ray.cloudpickle.register_pickle_by_value(example)

    turned = example.orientations(20, 4)
    assert turned.shape == (80, 3, 3) and np.allclose(np.linalg.det(turned), 1)
    assert np.allclose(turned @ np.swapaxes(turned, 1, 2), np.eye(3))
    apart = np.linalg.norm(turned[:, None] - turned, axis=(2, 3)) + 9 * np.eye(80)
    assert apart.min() > 0.5

    # The command of python/README.md, at a lower resolution.
    page = (Path(__file__).parents[1] / "README.md").read_text()
    (block,) = re.findall(r"^<!-- with Ray -->\n```sh\npython (.*)\n```", page, re.M)
    options = "--step 0.4 --directions 4 --turns 1 --starts 2 --workers 2 --picture map.png".split()
    (tmp_path / "models").symlink_to(MODELS)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [*shlex.split(block), *options])
    example.main()
    first = capsys.readouterr().out
    assert "4 orientations" in first and "best manipulability 0.1" in first
    assert Path("map.png").stat().st_size > 10_000
    example.main()  # there is nothing left to solve
    assert capsys.readouterr().out == first


def test_missing_folders_are_named(tmp_path, arm):
    with pytest.raises(kinopt.FileError, match="nowhere"):
        kr.solve_files(tmp_path / "nowhere", tmp_path / "answers", kr.SolveArm(arm))
    with pytest.raises(kinopt.FileError, match="no Parquet files"):
        kr.solve_files(tmp_path, tmp_path / "answers", kr.SolveArm(arm))
    with pytest.raises(kinopt.FileError, match="not a folder"):
        kr.write_blocks(kr.table(number=[1]), "nothing://here")
