"""Movements of people on the G1, on one core: kinopt frame by frame and as one problem, GMR's loop on mink and DAQP,
and holosoma-retargeting.

Usage: ``python retargeting.py G1.urdf MAP.json CAPTURE... [--gmr CONFIG.json --gmr-model G1.xml] [--holosoma
FOLDER] [--frames N]``. The environment needs kinopt's wheel and requirements-retargeting.txt.

- MAP is a body map of ``kinopt retarget``.
- A CAPTURE is a .npy (frames, joints, 3) of the MAP's joints, or a .bvh, for which kinopt guesses the map.
- CONFIG and G1.xml are GMR's ``general_motion_retargeting/ik_configs/bvh_to_g1.json`` and
  ``assets/unitree_g1/g1_mocap_29dof.xml`` (YanjieZe/GMR).
- FOLDER is ``holosoma_retargeting`` of the unpacked wheel. It solves its own captures, every fourth frame, and its
  evaluator judges all movements.

Columns by Pinocchio:

- Frames per second of processor time.
- Mean angle of limbs and of the lines across hips and shoulders to those of the subject, and its 95th percentile.
- Mean distance of hands and feet from the subject's, each relative to its limb's start and length.
- Mean position error of the driven links after one scale and shift of the whole movement.
- Mean angle of feet and hands to the subject's (hands with captured fingers), and tilt of soles in contact.
- Drift of a toe during foot contacts of the subject: mean and maximum.
- Largest penetration of level ground by a sole, and frames with more than 1 cm.
- Root mean square jerk of the joints at a fourth of the rate.
- Number of values beyond position limits, and of steps beyond velocity limits.

Columns by holosoma's evaluator, at a fourth of the rate:

- Frames with penetration of the floor or a box by more than 1 cm, and the largest penetration.
- Contact frames with sliding toes.
- Frames that keep all of the subject's contacts with boxes.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from pathlib import Path

# One core for every solver.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
import kinopt
import numpy as np
from retargeting_gmr import HEIGHT, Loop
from retargeting_holosoma import EVERY, Holosoma
from retargeting_holosoma import HEIGHT as HOLOSOMA_HEIGHT
from retargeting_holosoma import PERSON as HOLOSOMA_PERSON
from retargeting_judge import Judge, Movement, Subject

HEAD = ["movement", "solver", "frames", "frames/s", "limbs, °", "95 %", "ends, %", "off, mm", "feet, °", "hands, °", "tilt, °", "slip, mm",
        "worst", "below, mm", "below, %", "jerk, rad/s³", "beyond limits", "too fast",
        "deep, %", "deepest, mm", "sliding, %", "contacts kept, %"]
MEASURED = {"limbs": 1, "limbs most": 1, "ends": 1, "off": 1, "feet": 1, "hands": 1, "tilt": 1, "slip": 2, "worst slip": 1, "below": 1,
            "below share": 1, "jerk": 0, "beyond": 0, "fast": 0}
DEEP = ["deep", "deepest", "slides", "kept"]
ROUNDS = 3


class Asked:
    """A capture, in metres with z up."""

    def __init__(self, file: Path, told: dict, fps: float, unit: float, frames: int | None) -> None:
        self.name, self.own_map = file.stem, file.suffix == ".bvh"
        if self.own_map:
            self.capture = kinopt.retargeting.read_capture(file)
            places = np.array(self.capture.positions)
            self.joints, self.fps = list(self.capture.joints), self.capture.fps
            if self.capture.up == "y":
                places = np.stack([places[..., 0], -places[..., 2], places[..., 1]], axis=-1)
            self.places = unit * places[:frames]
        else:
            self.places, self.joints, self.fps = np.load(file)[:frames].astype(float), told["joints"], fps
        self.whole = np.load(file, mmap_mode="r") if not self.own_map else None


def by_kinopt(robot: kinopt.Robot, asked: Asked, told: dict, whole: bool, **options) -> tuple[Movement, float, float]:
    best, found = np.inf, None
    given = None if asked.own_map else told
    for _ in range(ROUNDS):
        begun = time.process_time()
        found = kinopt.retarget(asked.places, robot, given, joints=asked.joints, fps=asked.fps, up="z", whole=whole, **options)
        best = min(best, time.process_time() - begun)
    return Movement(found.q, found.names[7:], asked.fps), best, found.report.stride


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("urdf")
    parser.add_argument("map", type=Path)
    parser.add_argument("captures", type=Path, nargs="+")
    parser.add_argument("--fps", type=float, default=120.0, help="frames per second of arrays")
    parser.add_argument("--unit", type=float, default=0.056444, help="metres per unit of a .bvh (default: CMU's)")
    parser.add_argument("--frames", type=int, help="maximum number of frames")
    parser.add_argument("--gmr", type=Path)
    parser.add_argument("--gmr-model", type=Path)
    parser.add_argument("--holosoma", type=Path)
    parser.add_argument("--holosoma-frames", type=int, help="maximum number of frames for its slow solver")
    wanted = parser.parse_args()
    told = json.loads(wanted.map.read_text())
    drives = told["drives"].get(Path(wanted.urdf).name, told["drives"])
    limbs = {name: link for name, link in drives.items() if name.startswith(("Left", "Right"))}
    robot = kinopt.Robot.from_urdf(wanted.urdf, base_joint="free")
    judge = Judge(wanted.urdf, limbs)
    holosoma = Holosoma(wanted.holosoma) if wanted.holosoma else None
    print(f"| {' | '.join(HEAD)} |\n|---|---|{'---:|' * (len(HEAD) - 2)}")

    for asked in (Asked(file, told, wanted.fps, wanted.unit, wanted.frames) for file in wanted.captures):
        task = holosoma.task(asked.whole) if holosoma and asked.whole is not None else None

        def say(name: str, movement: Movement, seconds: float, scale: float, every: int) -> None:
            subject = Subject(asked.places[::EVERY // every][:len(movement.q)], asked.joints)
            found = judge.measures(movement, subject, every)
            cells = [asked.name, name, len(movement.q), f"{len(movement.q) / seconds:.0f}"]
            cells += [f"{found[key]:.{digits}f}" for key, digits in MEASURED.items()]
            if task:
                seen = asked.places[::EVERY]
                q = movement.q[::every]
                deep = holosoma.measures(task, q[:, :36], scale, seen[:len(q)])
                cells += [f"{deep[key]:.1f}" for key in DEEP]
            else:
                cells += ["-"] * len(DEEP)
            print(f"| {' | '.join(map(str, cells))} |", flush=True)

        for name, whole in (("kinopt, frame by frame", False), ("kinopt, whole", True)):
            movement, seconds, stride = by_kinopt(robot, asked, told, whole)
            say(name, movement, seconds, stride, EVERY)
        if wanted.gmr and wanted.gmr_model:
            loop = Loop(wanted.gmr_model, wanted.gmr)
            q, seconds = loop.retarget(asked.joints, asked.places)
            say(f"GMR's loop, {loop.steps / len(q):.1f} steps a frame", Movement(q, loop.joints(), asked.fps), seconds,
                loop.scales[loop.root], EVERY)
        if task:
            known = -(-len(asked.places) // EVERY)
            q, seconds = holosoma.retarget(task, min(known, wanted.holosoma_frames or known))
            movement = Movement(q, holosoma_joints(robot), asked.fps / EVERY)
            say("holosoma-retargeting", movement, seconds, HOLOSOMA_HEIGHT / HOLOSOMA_PERSON, 1)


def holosoma_joints(robot: kinopt.Robot) -> list[str]:
    """Joint names in the order of the same file in MuJoCo."""
    return [name for name in robot.model.joint_names if name.endswith("_joint")]


if __name__ == "__main__":
    main()
