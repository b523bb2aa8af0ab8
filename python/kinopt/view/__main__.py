"""`python -m kinopt.view MODEL`: viewer page for dragging a robot or a character."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import get_args

import kinopt

from ..types import BaseJoint
from .opening import SUPPORTED, open_page
from .stage import Up

#: Upward axes by the name in the argument.
UPS: dict[str | None, Up] = {"y": "+y", "z": "+z"}


def main(arguments: Sequence[str] | None = None) -> int:
    """Opens the page and serves it until Ctrl-C; returns 1 if the model cannot be read."""
    parser = argparse.ArgumentParser(prog="python -m kinopt.view", description=__doc__)
    parser.add_argument("model", metavar="MODEL", help=SUPPORTED)
    parser.add_argument("--host", default="127.0.0.1", help="address to listen on; 0.0.0.0 allows other machines")
    parser.add_argument("--port", type=int, default=8080, help="first port to try")
    parser.add_argument(
        "--package", action="append", default=[], metavar="DIR", help="folder of packages with meshes"
    )
    parser.add_argument("--capsules", action="store_true", help="draw capsules instead of meshes and collision shapes")
    parser.add_argument(
        "--up", choices=("y", "z"), help="upward axis; default: z for robots and rigs, y for scenes and captures"
    )
    parser.add_argument(
        "--base-joint",
        choices=get_args(BaseJoint),
        metavar="KIND",
        help=f"base joint of a robot: {', '.join(get_args(BaseJoint))}",
    )
    parser.add_argument(
        "--hold",
        action="append",
        default=[],
        metavar="FRAME",
        help="pin a frame of a robot on a free base; default: the feet of a humanoid",
    )
    parser.add_argument(
        "--world", metavar="FILE", help="world of obstacles for a robot, or a rig with a skin: .json, or MoveIt's .yaml"
    )
    parser.add_argument("--margin", type=float, default=0.0, metavar="METRES", help="smallest distance from obstacles; default: 0")
    parser.add_argument(
        "--retarget", metavar="SOURCE", help="motion capture to retarget: .npy, .bvh, .glb; the subject is shown next to the model"
    )
    parser.add_argument(
        "--map", metavar="FILE|NAME", help="body map: .json, or cmu, lafan1, mixamo or smpl; default: guessed"
    )
    parser.add_argument("--fps", type=float, metavar="N", help="frames per second of the motion")
    parser.add_argument("--whole", action="store_true", help="solve the motion as a whole, not frame by frame")
    parser.add_argument(
        "--keep-clear", type=float, metavar="METRES", help="smallest distance between a robot's links in every frame of the motion"
    )
    parser.add_argument("--no-browser", action="store_true", help="print the address without opening a browser")
    options = parser.parse_args(arguments)
    try:
        page = open_page(
            options.model,
            host=options.host,
            port=options.port,
            packages=options.package,
            capsules=options.capsules,
            up=UPS.get(options.up),
            base_joint=options.base_joint,
            hold=options.hold,
            world=options.world,
            margin=options.margin,
            retarget=options.retarget,
            map=options.map,
            fps=options.fps,
            whole=options.whole,
            keep_clear=options.keep_clear,
        )
    except kinopt.KinoptError as error:
        print(error, file=sys.stderr)
        return 1
    for note in page.notes:
        print(note, file=sys.stderr)
    page.scene.announce(browser=not options.no_browser)
    page.scene.wait()
    return 0


if __name__ == "__main__":
    sys.exit(main())
