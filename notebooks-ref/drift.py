"""Compares regenerated fixtures (KINOPT_FIXTURES) with the committed ones; numbers only, not dates.

Kinematics, interpolants, skins and the statements of the minima repeat to rounding. The solutions of the minima
come from long iterations, whose last digits depend on the processor. A few searches can end in another minimum:

- The best known cost of a problem must repeat to a relative 1e-7, for all but 2 % of the problems.
- Each tool must repeat its cost to a relative 1e-6, in all but 10 % of the solutions that are stationary in both runs.
"""

import itertools
import sys

from fixtures import COMMITTED, FOLDER, differences, read
from minima import NO_COST, SAME_COST, STATIONARY

EXACT = {
    "urdf_fk.json": 1e-13, "urdf_jacobians.json": 1e-13, "rig_kinematics.json": 1e-12,
    "interpolation.json": 1e-12,
    "skinning.json": 2e-9,  # written to nine decimals
    "distances.json": 1e-10,
}
#: Fixtures that the notebooks do not write.
REPORTED = {"paths_from_starts.json", "starts_on_limits.json"}
BEST_WITHIN, BEST_MISSES, ANSWER_MISSES = 1e-7, 0.02, 0.10
STATEMENT = ("name", "kind", "model", "tasks", "start")


def same_cost(a, b, within):
    return abs(a - b) <= max(NO_COST, within * max(a, b))


def of_minima(old, new):
    statements = [[{key: problem[key] for key in STATEMENT} for problem in part["problems"]] for part in (old, new)]
    yield from itertools.islice(differences(*statements, 1e-12, "problems"), 10)
    yield from differences(old["models"], new["models"], 0.0, "models")
    pairs = list(zip(old["problems"], new["problems"]))
    best = lambda problem: problem["minima"][problem["best"]]["cost"]
    missed = [a["name"] for a, b in pairs if not same_cost(best(a), best(b), BEST_WITHIN)]
    print(f"minima.json: another best cost in {len(missed)} of {len(pairs)} problems")
    if len(missed) > BEST_MISSES * len(pairs):
        yield f"another best cost in {len(missed)} problems: {', '.join(missed)}"
    for tool in old["problems"][0]["answers"]:
        both = [(a["answers"][tool], b["answers"][tool]) for a, b in pairs]
        both = [(a, b) for a, b in both if max(a["kkt"], b["kkt"]) <= STATIONARY]
        other = sum(not same_cost(a["cost"], b["cost"], SAME_COST) for a, b in both)
        print(f"minima.json: {tool} has {other} other of {len(both)} stationary answers")
        if other > ANSWER_MISSES * max(len(both), 10):
            yield f"{tool} came to another cost in {other} of {len(both)} stationary answers"


def of_loops(old, new):
    pairs = list(zip(old["problems"], new["problems"]))
    statements = [[{key: problem[key] for key in ("mechanism", "target")} for problem in part["problems"]]
                  for part in (old, new)]
    yield from itertools.islice(differences(*statements, 1e-12, "problems"), 10)
    best = lambda problem: problem["minima"][0]["cost"]
    missed = [k for k, (a, b) in enumerate(pairs) if not same_cost(best(a), best(b), BEST_WITHIN)]
    print(f"loops.json: another best cost in {len(missed)} of {len(pairs)} problems")
    if len(missed) > BEST_MISSES * len(pairs):
        yield f"another best cost in problems {missed}"


def of_motions(old, new):
    """Compares clips, whose minima depend on the path of IPOPT."""
    same = lambda a, b: a["targets"] == b["targets"] and same_cost(a["cost"], b["cost"], BEST_WITHIN)
    missed = [k for k, (a, b) in enumerate(zip(old["problems"], new["problems"])) if not same(a, b)]
    print(f"motions.json: another cost in {len(missed)} of {len(old['problems'])} problems")
    if len(missed) > BEST_MISSES * len(old["problems"]):
        yield f"another cost in problems {missed}"


def main():
    unknown = {path.name for path in COMMITTED.glob("*.json")} - {*EXACT, *REPORTED, "minima.json", "loops.json", "motions.json"}
    found = [f"{name}: no tolerance says when it has drifted" for name in sorted(unknown)]
    for name, within in EXACT.items():
        drift = list(differences(read(COMMITTED, name), read(FOLDER, name), within))
        print(f"{name}: {len(drift)} numbers differ by more than {within}")
        found += [f"{name}{place}" for place in drift[:5]]
    found += [f"minima.json: {what}" for what in of_minima(read(COMMITTED, "minima.json"), read(FOLDER, "minima.json"))]
    found += [f"loops.json: {what}" for what in of_loops(read(COMMITTED, "loops.json"), read(FOLDER, "loops.json"))]
    found += [f"motions.json: {what}" for what in of_motions(read(COMMITTED, "motions.json"), read(FOLDER, "motions.json"))]
    for what in found:
        print("DRIFTED", what, file=sys.stderr)
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
