"""A million Panda poses through kinopt.ray by 1 and by 2 workers: equality with results without Ray, scaling, and
the cost of a killed worker.

    python benches/rivals/python/ray_workers.py [POSES] [RUNS]

Wall time is from the first pose to the last, and depends on other programs on the machine. The workers' processor
time for reading, solving and writing depends less on them. The start of Ray and of its workers is not included.
"""

import os
import signal
import sys
import tempfile
import threading
import time
from collections import defaultdict
from pathlib import Path

import numpy as np
import ray

import kinopt
import kinopt.ray

ROOT = Path(__file__).parents[3]
BLOCK = 16_384
FURTHER = float(os.environ.get("FURTHER", 0.1))


class Timed(kinopt.ray.SolveArm):
    """Records the wall time and processor time of each finished table."""

    def __call__(self, targets):
        begun = time.time()
        answers = super().__call__(targets)
        with open(f"{self.notes}/{os.getpid()}", "a") as notes:
            notes.write(f"{begun} {time.time()} {time.process_time()}\n")
        return answers


def noted(folder):
    return {path.name: np.loadtxt(path, ndmin=2) for path in Path(folder).iterdir()}


def run(folder, targets, arm, workers, kill=False):
    """Solutions, poses per second, processor seconds per pose, and the total time."""
    answers, notes = folder / f"answers-{time.time()}", folder / f"notes-{time.time()}"
    notes.mkdir()
    solver = Timed(arm)
    solver.notes = str(notes)
    killed = []

    def killer():
        while not killed:
            for path in notes.iterdir():
                if len(path.read_text().splitlines()) >= 5 and not killed:
                    os.kill(int(path.name), signal.SIGKILL)
                    killed.append(path.name)

    if kill:
        threading.Thread(target=killer, daemon=True).start()
    begun = time.time()
    dataset = kinopt.ray.solve_files(targets, answers, solver, workers=workers)
    took = time.time() - begun
    told = noted(notes)
    span = max(times[-1, 1] for times in told.values()) - min(times[0, 0] for times in told.values())
    blocks = sum(len(times) for times in told.values())
    # From a worker's first block to its last, without its start.
    seconds = sum(times[-1, 2] - times[0, 2] for times in told.values()) / (blocks - len(told))
    table = dataset.to_table()
    return table, table.num_rows / span, seconds * blocks / table.num_rows, took, len(told), killed


def main():
    count, runs = (int(number) for number in (sys.argv[1:] + ["1000000", "3"])[:2]) if len(sys.argv) > 2 else (1_000_000, 3)
    arm = kinopt.Arm(kinopt.Robot.from_urdf(ROOT / "models" / "franka_panda.urdf"), "base", "flange")
    q = np.random.default_rng(2026).uniform(arm.lower, arm.upper, (count, 7))
    targets = arm.base_from_tool(q)
    # Some targets are moved outward. Most of these are out of reach, which takes a hundred times longer to detect.
    # Without them a million poses take about a second, less than the start of a worker.
    outward = targets[:: round(1 / FURTHER)] if FURTHER else targets[:0]
    outward[:, :3, 3] *= 1 + 0.3 / np.linalg.norm(outward[:, :3, 3], axis=1, keepdims=True)
    begun = time.process_time()
    want = arm.solve_batch(targets)
    alone = time.process_time() - begun
    print(f"without Ray: {alone:.2f} s of one core, {want.reached.mean():.3%} reached; load {os.getloadavg()[0]:.1f}", flush=True)
    ray.init("local", num_cpus=2, include_dashboard=False, log_to_driver=False, logging_level="error")
    ray.cloudpickle.register_pickle_by_value(sys.modules[__name__])
    ray.data.DataContext.get_current().enable_progress_bars = False
    figures = defaultdict(list)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        kinopt.ray.write_blocks(kinopt.ray.table(target=targets), folder / "targets", BLOCK)
        for number in range(runs + 1):
            for workers in (1, 2):
                kill = number == runs
                if kill and workers == 1:
                    continue
                table, rate, cpu, took, processes, killed = run(folder, folder / "targets", arm, workers, kill)
                same = np.array_equal(kinopt.ray.numbers(table, "q"), want.q)
                for name in ("reached", "position_error", "orientation_error", "attempts", "iterations"):
                    same &= np.array_equal(table[name].to_numpy(), getattr(want, name))
                end = f"; worker {killed[0]} killed, {processes} processes" if kill else ""
                print(
                    f"{workers} workers: same bits {same}, {rate:.0f} poses/s, "
                    f"{1e6 * cpu:.3f} us of processor a pose, job {took:.1f} s, load {os.getloadavg()[0]:.1f}{end}",
                    flush=True,
                )
                if not kill:
                    figures[workers].append((rate, cpu))
    rate, cpu = ({w: np.median([run[i] for run in figures[w]]) for w in (1, 2)} for i in (0, 1))
    print(f"medians: wall efficiency {rate[2] / rate[1] / 2:.1%}, processor time {cpu[1] / cpu[2]:.1%}")
    best = {w: max(run[0] for run in figures[w]) for w in (1, 2)}
    print(f"best runs: wall efficiency {best[2] / best[1] / 2:.1%}")


if __name__ == "__main__":
    main()
