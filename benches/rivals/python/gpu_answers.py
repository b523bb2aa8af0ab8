"""Batch sizes of gpu_batches.py, and the recorded times and solutions of each contender."""

from __future__ import annotations

import json
import time
from pathlib import Path

import numpy as np

BASE, TIP = "panda_link0", "panda_hand"
BATCHES = {"plain": (1, 100, 1_000, 10_000), "boxes": (100, 1_000), "rounds": (100, 1_000)}
CALLS = {1: 200, 100: 20, 1_000: 12, 10_000: 10}


class Answers:
    """Times and solutions of one contender, saved after each row, so that a crash loses nothing. A new measurement
    replaces the row.
    """

    def __init__(self, folder: Path, who: str, about: dict) -> None:
        self.folder, self.who = folder, who
        self.told, self.answers = {"about": about, "rows": []}, {}
        if (folder / f"{who}.json").exists():
            self.told["rows"] = json.loads((folder / f"{who}.json").read_text())["rows"]
            self.answers = dict(np.load(folder / f"{who}.npz"))

    def take(self, name: str, kind: str, batch: int, pool: int, prepared: float, call, fetch) -> None:
        """Times `call(block)` until all results are computed; block has the indices of the queries. `fetch` extracts
        joint values.
        """
        answers, times = {}, []
        blocks = pool // batch
        for number in range(-2, CALLS[batch]):
            block = np.arange(batch) + (number % blocks) * batch
            ready = call(block, True)
            begun = time.perf_counter()
            answer = call(ready, False)
            took = time.perf_counter() - begun
            if number >= 0:
                times.append(took)
                answers[number % blocks] = fetch(answer)
        key = f"{self.who}|{name}|{kind}|{batch}"
        self.answers[key] = np.concatenate([answers[block] for block in sorted(answers)])
        row = {"key": key, "solver": name, "kind": kind, "batch": batch, "prepared_s": prepared, "times_s": times}
        self.told["rows"] = [one for one in self.told["rows"] if one["key"] != key] + [row]
        middle = float(np.median(times))
        print(f"{name} {kind} {batch}: {1e3 * middle:.3f} ms, {batch / middle:.0f} a second, ready after {prepared:.1f} s", flush=True)
        (self.folder / f"{self.who}.json").write_text(json.dumps(self.told))
        np.savez_compressed(self.folder / f"{self.who}.npz", **self.answers)
