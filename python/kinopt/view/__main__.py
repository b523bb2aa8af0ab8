"""`python -m kinopt.view MODEL`: a page on which a robot or a character is dragged."""

from __future__ import annotations

import argparse
import sys
import webbrowser
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
    parser.add_argument("--host", default="127.0.0.1", help="who may look: 0.0.0.0 lets other machines in")
    parser.add_argument("--port", type=int, default=8080, help="the first port to try")
    parser.add_argument(
        "--package", action="append", default=[], metavar="DIR", help="where packages of meshes are"
    )
    parser.add_argument("--capsules", action="store_true", help="draw no meshes but capsules")
    parser.add_argument(
        "--up", choices=("y", "z"), help="the way up; z for robots and rigs, y for scenes and captures"
    )
    parser.add_argument(
        "--base-joint",
        choices=get_args(BaseJoint),
        metavar="KIND",
        help=f"what a robot's root moves on: {', '.join(get_args(BaseJoint))}",
    )
    parser.add_argument(
        "--hold", action="append", default=[], metavar="FRAME", help="pin a frame: a robot's feet on a free base"
    )
    parser.add_argument(
        "--world", metavar="FILE", help="obstacles that a robot, or a rig with a skin, keeps clear of: .json, or MoveIt's .yaml"
    )
    parser.add_argument("--margin", type=float, default=0.0, metavar="METRES", help="how far; 0 unless said")
    parser.add_argument(
        "--retarget", metavar="SOURCE", help="a person's movement that the model does: .npy, .bvh, .glb; they are shown beside it"
    )
    parser.add_argument(
        "--map", metavar="FILE|NAME", help="which joint drives which frame: .json, or cmu, lafan1, mixamo or smpl; guessed unless said"
    )
    parser.add_argument("--fps", type=float, metavar="N", help="frames a second of the movement")
    parser.add_argument("--whole", action="store_true", help="solve the movement as a whole, not frame by frame")
    parser.add_argument(
        "--keep-clear", type=float, metavar="METRES", help="keep a robot's links so far apart in every frame of the movement"
    )
    parser.add_argument("--no-browser", action="store_true", help="print the address and open no browser")
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
    print(f"{page.scene.url}  (Ctrl-C ends it)", flush=True)
    if not options.no_browser:
        webbrowser.open(page.scene.url)
    page.scene.wait()
    return 0


if __name__ == "__main__":
    sys.exit(main())
