"""Whole bodies: kinopt compared with pink, mink, placo and a loop over Pinocchio.

    python benches/rivals/python/whole_body.py CASE ROBOT.urdf [--problems N] [--peers N] [--limit SECONDS]

Run it in the root of the repository, in an environment with requirements-whole-body.txt. CASE is a file of
benches/whole_body/ with pose targets of feet and hands.

kinopt's program samples the problems and solves them all (Rust, default settings). The peers get the first N
problems from the same starts, in the same run, with a time limit per problem. They restart if they stall, as
kinopt does. Times are processor times, the best of three rounds. The tolerance is 1e-6 m and rad.

Pinocchio judges every solution: feet, hands, the centre of mass over the soles, and joint limits. The limits hold
to 1e-9, and exactly for kinopt.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import tempfile
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path

# One core for every solver.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
import numpy as np
from whole_body_peers import PEERS, Body

TOLERANCE = 1e-6
ROUNDS = 3
# Tolerance of the judge, enlarged for rounding differences between kinematics.
JUDGED = 1.001 * TOLERANCE


def right(body, q, targets, slack):
    inside = (q[7:] >= body.lower - slack).all() and (q[7:] <= body.upper + slack).all()
    return inside and max(body.errors(q, targets)) <= JUDGED


def row(name, start, solved, micros):
    print(f"| {name} | {start} | {100 * np.mean(solved):.1f} % of {len(solved)} | {np.median(micros):.0f} "
          f"| {np.percentile(micros, 99):.0f} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case")
    parser.add_argument("robot")
    parser.add_argument("--problems", type=int, default=1000)
    parser.add_argument("--peers", type=int, default=100, help="problems for the peers")
    parser.add_argument("--limit", type=float, default=1.0, help="seconds per problem")
    wanted = parser.parse_args()

    build = ["cargo", "build", "--quiet", "--release", "-p", "kinopt-benches", "--bin", "whole_body"]
    metadata = ["cargo", "metadata", "--format-version", "1", "--no-deps"]
    subprocess.run(build, check=True)
    target = json.loads(subprocess.run(metadata, check=True, capture_output=True).stdout)["target_directory"]
    with tempfile.TemporaryDirectory() as folder:
        problems = Path(folder) / "problems.json"
        run = [f"{target}/release/whole_body", wanted.case, wanted.robot, str(wanted.problems), "--write", problems]
        subprocess.run(run, check=True)
        document = json.loads(problems.read_text())
        # Removes shapes, whose files can be missing; the masses are unchanged.
        tree = ElementTree.parse(wanted.robot)
        for link in tree.getroot().iter("link"):
            for shape in link.findall("visual") + link.findall("collision"):
                link.remove(shape)
        bare = Path(folder) / "robot.urdf"
        tree.write(bare)
        body = Body(bare, document, TOLERANCE)
        asked = [body.feet + [np.array(at) for at in hands] for hands in document["targets"]]
        print("| solver | start | solved | median us | p99 us |\n|---|---|---:|---:|---:|")
        for start in ("near", "standing"):
            told = document[start]
            solved = [right(body, body.configuration(one["q"]), at, 0.0) for one, at in zip(told, asked)]
            row("**kinopt**", start, solved, [one["micros"] for one in told])
            row("**kinopt**", start, solved[: wanted.peers], [one["micros"] for one in told[: wanted.peers]])
        for name, peer in PEERS.items():
            solver = peer(body)
            for start in ("near", "standing"):
                solved, micros = [], []
                for one, at in zip(document[start][: wanted.peers], asked):
                    begin, taken = body.configuration(one["start"]), []
                    for _ in range(ROUNDS):
                        begun = time.process_time()
                        q = solver.solve(begin, at, begun + wanted.limit)
                        taken.append(1e6 * (time.process_time() - begun))
                    micros.append(min(taken))
                    solved.append(q is not None and right(body, q, at, 1e-9))
                row(name, start, solved, micros)


if __name__ == "__main__":
    main()
