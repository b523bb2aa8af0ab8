"""Ten drags of characters on their feet: directions of knees and elbows, balance, feet and frames.

    python benches/rivals/python/posing.py CHARACTER.glb ... [--json OUT.json]

Each drag moves one bone, and the other feet stay. A knee bends the right way if it is in front of the line from hip to
ankle, seen along its own foot. An elbow bends the right way if the forearm rotates about the axis of the T-pose, moved
with the upper arm: towards the front. Both may be
off by 1 degree, and by as much as they are at rest. Lengths are relative to the height.
"""

import argparse
import json
import time
from pathlib import Path

import kinopt
import numpy as np

TOLERANCE = np.sin(np.radians(1))


def unit(v):
    return v / np.linalg.norm(v)


def is_left(name):
    return "left" in name.lower() or name.endswith((".L", "_L"))


class Body:
    """Joints of a character at rest, from its guessed hinges and the tree of its bones."""

    def __init__(self, path):
        self.scene = kinopt.Scene.read(path)
        skeleton = self.scene.armature.skeleton()
        self.names = skeleton.bone_names
        self.parents = skeleton.parents
        self.hinges = skeleton.guess_hinges()
        drag = kinopt.StandingDrag(self.scene, [])
        self.rest = {name: np.asarray(p) for name, p in drag.positions.items()}
        heights = np.array([self.rest[name][1] for name in self.names])
        self.height = np.ptp(heights)
        middle = 0.5 * (heights.max() + heights.min())
        middles = sorted(self.hinges, key=lambda name: self.rest[name][1])
        self.legs = [self.limb(name) for name in middles if self.rest[name][1] < middle]
        self.arms = [self.limb(name) for name in middles if self.rest[name][1] >= middle]
        for pair in (self.legs, self.arms):
            pair.sort(key=lambda limb: not is_left(limb[1]))
        self.hips = self.parent(self.legs[0][0])
        hips = self.rest[self.legs[0][0]] - self.rest[self.legs[-1][0]]
        self.up = np.array([0.0, 1.0, 0.0])
        self.left = unit(hips - self.up * (hips @ self.up))
        self.forward = np.cross(self.left, self.up)

    def parent(self, name):
        return self.names[self.parents[self.names.index(name)]]

    def children(self, name):
        index = self.names.index(name)
        return [self.names[k] for k, parent in enumerate(self.parents) if parent == index]

    def limb(self, middle):
        """Upper, middle and end bone: the farthest child ends the limb."""
        upper = self.parent(middle)
        while np.linalg.norm(self.rest[upper] - self.rest[middle]) < 0.08 * self.height:
            upper = self.parent(upper)
        end = middle
        while np.linalg.norm(self.rest[end] - self.rest[middle]) < 0.08 * self.height and self.children(end):
            end = max(self.children(end), key=lambda child: np.linalg.norm(self.rest[child] - self.rest[middle]))
        return upper, middle, end

    def head(self):
        """The highest bone that is no end of a chain."""
        inner = [name for name in self.names if self.children(name)]
        return max(inner, key=lambda name: self.rest[name][1] - 10 * abs(self.rest[name][0] - self.rest[self.hips][0]))

    def drags(self):
        """Bone and target of ten drags."""
        h, u, f, le = self.height, self.up, self.forward, self.left
        left_hand, right_hand = self.arms[0][2], self.arms[-1][2]
        left_foot, right_foot = self.legs[0][2], self.legs[-1][2]
        shoulders = [self.rest[arm[0]] for arm in (self.arms[0], self.arms[-1])]
        return [
            (left_hand, shoulders[0] + h * (0.15 * f - 0.10 * u)),
            (right_hand, shoulders[1] + h * (0.10 * f + 0.22 * u)),
            (left_hand, shoulders[0] + h * (0.18 * f - 0.02 * u - 0.15 * le)),
            (right_hand, shoulders[1] + h * (0.12 * f - 0.40 * u)),
            (left_hand, shoulders[0] + h * (0.9 * f)),
            (left_foot, self.rest[left_foot] + h * (0.10 * f + 0.15 * u)),
            (right_foot, self.rest[right_foot] + h * (-0.12 * f + 0.08 * u)),
            (self.hips, self.rest[self.hips] - 0.12 * h * u),
            (self.hips, self.rest[self.hips] + h * (0.04 * le - 0.04 * u)),
            (self.head(), self.rest[self.head()] + h * (0.12 * f - 0.10 * u)),
        ]


def knee_bulge(body, at, leg):
    """Sine of the angle by which a knee is in front of the line from hip to ankle, seen along its foot."""
    upper, middle, end = leg
    a, b, c = (at[name] for name in leg)
    toes = body.children(end)
    foot = at[toes[0]] - c if toes else body.forward
    along = unit(c - a)
    return unit(b - a) @ unit(foot - along * (foot @ along))


def elbow_bend(body, at, arm, rotation):
    """Sine of the angle by which a forearm is bent towards the front, in the frame of its upper arm."""
    upper, middle, end = arm
    rest_along = unit(body.rest[end] - body.rest[upper])
    axis = rotation @ unit(np.cross(rest_along, body.forward))
    a, b, c = (at[name] for name in arm)
    return np.cross(unit(b - a), unit(c - b)) @ axis


def wrong_bends(body, at, rotations):
    """Lower bones of the limbs that are bent the wrong way, more than at rest."""
    still = np.eye(3)
    knees = [(leg[1], knee_bulge(body, at, leg), knee_bulge(body, body.rest, leg)) for leg in body.legs]
    elbows = [
        (arm[1], elbow_bend(body, at, arm, rotations[arm[0]]), elbow_bend(body, body.rest, arm, still))
        for arm in body.arms
    ]
    return [name for name, now, rest in knees + elbows if now < min(rest, 0.0) - TOLERANCE]


def turned(model, q, rest_q, name):
    """Rotation of a bone from rest, in the model's axes."""
    now, rest = (kinopt.frame_placement(model, name, value)[:3, :3] for value in (q, rest_q))
    return now @ rest.T


def run(path):
    body = Body(path)
    rows = []
    for bone, target in body.drags():
        drag = kinopt.StandingDrag(body.scene, [bone])
        rest_q = drag.q
        started = time.perf_counter()
        frames = 0
        while frames < 40 and not (frames and drag.is_at_rest):
            solution = drag.advance({bone: target})
            frames += 1
        seconds = time.perf_counter() - started
        at = {name: np.asarray(p) for name, p in drag.positions.items()}
        rotations = {arm[0]: turned(drag.model, drag.q, rest_q, arm[0]) for arm in body.arms}
        feet = [np.linalg.norm(at[foot] - body.rest[foot]) for foot in drag.feet]
        rows.append({
            "bone": bone,
            "target": target.tolist(),
            "pose": [np.asarray(part).tolist() for part in (drag.pose.translations, drag.pose.rotations_xyzw)],
            "positions": {name: p.tolist() for name, p in at.items()},
            "error": float(np.linalg.norm(at[bone] - target) / body.height),
            "wrong": wrong_bends(body, at, rotations),
            "margin": drag.balance_margin / body.height,
            "feet": max(feet, default=0.0) / body.height,
            "frames": frames,
            "ms": 1e3 * seconds / frames,
            "reached": solution.reached,
        })
    return body, rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("characters", nargs="+", type=Path)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    print("character             drags  reached  wrong bends  outside  least margin  feet moved  ms a frame")
    report = {}
    for path in options.characters:
        body, rows = run(path)
        report[path.name] = {
            "names": body.names, "hips": body.hips, "legs": body.legs, "arms": body.arms,
            "forward": body.forward.tolist(), "height": float(body.height), "rows": rows,
        }
        wrong = sum(bool(row["wrong"]) for row in rows)
        outside = sum(row["margin"] < 0 for row in rows)
        print(
            f"{path.stem:20}  {len(rows):5}  {sum(row['reached'] for row in rows):7}  {wrong:11}  {outside:7}"
            f"  {min(row['margin'] for row in rows):12.4f}  {max(row['feet'] for row in rows):10.1e}"
            f"  {np.median([row['ms'] for row in rows]):10.2f}"
        )
        for row in rows:
            if row["wrong"] or row["margin"] < 0:
                print(f"    {row['bone']}: wrong {row['wrong']}, margin {row['margin']:.4f}")
    if options.json:
        options.json.write_text(json.dumps(report, indent=1))


if __name__ == "__main__":
    main()
