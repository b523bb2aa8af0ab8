"""What gpu_batches.py asks in which batches, and what each contender took and said."""

from __future__ import annotations

import json
import time
from pathlib import Path

import numpy as np

BASE, TIP = "panda_link0", "panda_hand"
BATCHES = {"plain": (1, 100, 1_000, 10_000), "boxes": (100, 1_000), "rounds": (100, 1_000)}
CALLS = {1: 200, 100: 20, 1_000: 12, 10_000: 10}


class Answers:
    """What one contender took and said; written as it goes, so that what breaks later loses nothing. A row measured again is replaced."""

    def __init__(self, folder: Path, who: str, about: dict) -> None:
        self.folder, self.who = folder, who
        self.told, self.answers = {"about": about, "rows": []}, {}
        if (folder / f"{who}.json").exists():
            self.told["rows"] = json.loads((folder / f"{who}.json").read_text())["rows"]
            self.answers = dict(np.load(folder / f"{who}.npz"))

    def take(self, name: str, kind: str, batch: int, pool: int, prepared: float, call, fetch) -> None:
        """`call(block)` with the numbers of the questions is timed until all is computed; `fetch` makes joint values of its answer."""
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
