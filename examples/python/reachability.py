"""Reachability map of a robot's tool: reachable positions, share of orientations, and manipulability. A job for Ray.

    python reachability.py models/franka_panda.urdf --into reachability --picture reachability.png

Positions on a grid around the base times orientations are targets in Parquet files. Every worker holds the arm and
solves one file at a time. A worker that is killed is started again with its file. If the whole job is killed, the same
command continues with the remaining files. It needs ``pip install 'kinopt[ray]' matplotlib``.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

import kinopt
import kinopt.ray

Floats = NDArray[np.float64]


class Reachability(kinopt.ray.SolveArm):
    """Solutions with an additional column: the best manipulability of the solutions from several starts."""

    def __init__(self, robot: kinopt.Robot, arm: kinopt.Arm, tip: str, starts: int) -> None:
        super().__init__(arm)
        self.jacobian = kinopt.Jacobian(robot, [tip])
        self.neutral = robot.neutral()
        self.columns = [robot.joint_names.index(name) for name in arm.joint_names]
        self.others = robot.random_configuration(starts - 1, seed=1)[:, self.columns]

    def __call__(self, targets: pa.Table) -> pa.Table:
        answers = super().__call__(targets)
        reached = answers["reached"].to_numpy()
        best = np.full(len(reached), np.nan)
        best[reached] = self.manipulability(kinopt.ray.numbers(answers, "q")[reached])
        wanted = kinopt.ray.numbers(targets, self.target, (4, 4))[reached]
        for start in self.others:
            again = self.arm.solve_batch(wanted, start)
            better = np.where(again.reached, self.manipulability(again.q), 0.0)
            best[reached] = np.maximum(best[reached], better)
        return answers.append_column("manipulability", kinopt.ray.column(best))

    def manipulability(self, q: Floats) -> Floats:
        """Yoshikawa's measure, sqrt(det(J J^T)), of arm configurations of shape (N, dof): shape (N,)."""
        whole = np.tile(self.neutral, (len(q), 1))
        whole[:, self.columns] = q
        jacobian = self.jacobian.at(whole)[..., self.columns]
        product = jacobian @ np.swapaxes(jacobian, -1, -2)
        return np.asarray(np.sqrt(np.maximum(np.linalg.det(product), 0.0)))


def grid(reach: float, step: float) -> Floats:
    """Points of a grid within reach of the origin, shape (N, 3), metres."""
    along = np.arange(-np.floor(reach / step), np.floor(reach / step) + 1) * step
    points = np.stack(np.meshgrid(along, along, along, indexing="ij"), axis=-1).reshape(-1, 3)
    return np.asarray(points[np.linalg.norm(points, axis=1) <= reach])


def orientations(directions: int, turns: int) -> Floats:
    """Rotations with z axes distributed over the sphere, each rotated about z: shape (directions * turns, 3, 3)."""
    height = 1 - 2 * (np.arange(directions) + 0.5) / directions
    round_ = np.pi * (1 + 5**0.5) * np.arange(directions)
    flat = np.sqrt(1 - height**2)
    z = np.stack([flat * np.cos(round_), flat * np.sin(round_), height], axis=1)[:, None]
    x = np.cross(np.where(np.abs(z[..., 2:]) < 0.9, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), z)
    x /= np.linalg.norm(x, axis=-1, keepdims=True)
    turn = (2 * np.pi / turns * np.arange(turns))[:, None]
    x = np.cos(turn) * x + np.sin(turn) * np.cross(z, x)
    z = np.broadcast_to(z, x.shape)
    return np.stack([x, np.cross(z, x), z], axis=-1).reshape(-1, 3, 3)


def poses(points: Floats, turned: Floats) -> Floats:
    """Every point with every orientation: shape (points * orientations, 4, 4)."""
    targets = np.zeros((len(points), len(turned), 4, 4))
    targets[..., :3, :3] = turned
    targets[..., :3, 3] = points[:, None]
    targets[..., 3, 3] = 1.0
    return targets.reshape(-1, 4, 4)


def draw(points: Floats, share: Floats, best: Floats, step: float, picture: Path) -> None:
    """Draws sections of the map: at y = 0, and the horizontal one with the largest reach."""
    import matplotlib.pyplot as plt

    side = np.unique(points[:, 0])
    place = np.round((points - side[0]) / step).astype(int)
    heights = [share[place[:, 2] == row].sum() for row in range(len(side))]
    level = int(np.argmax(heights))
    slices = [
        (place[:, 1] == len(side) // 2, 2, "z", "across y = 0"),
        (place[:, 2] == level, 1, "y", f"at z = {side[level]:.2f} m"),
    ]
    figure, axes = plt.subplots(2, 2, figsize=(11, 9.5), layout="constrained", sharex=True)
    edge = side[0] - step / 2
    for column, (inside, up, name, where) in enumerate(slices):
        maps = [
            (share, f"orientations reached {where}", "viridis", 1.0),
            (best, f"best manipulability {where}", "magma", np.nanmax(best)),
        ]
        for axis, (values, title, colours, most) in zip(axes[:, column], maps):
            image = np.full((len(side), len(side)), np.nan)
            shown = inside & (share > 0)
            image[place[shown, up], place[shown, 0]] = values[shown]
            drawn = axis.imshow(
                image, cmap=colours, vmin=0, vmax=most, origin="lower", extent=[edge, -edge, edge, -edge]
            )
            axis.set(title=title, xlabel="x, m", ylabel=f"{name}, m")
            axis.plot(0, 0, "k+")
            figure.colorbar(drawn, ax=axis, shrink=0.8)
    figure.savefig(picture, dpi=120)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("urdf", type=Path)
    options.add_argument("--base", default="base")
    options.add_argument("--tip", default="flange")
    options.add_argument("--step", type=float, default=0.1, help="between positions, metres")
    options.add_argument("--directions", type=int, default=20, help="of the tool's z axis")
    options.add_argument("--turns", type=int, default=4, help="about it")
    options.add_argument("--starts", type=int, default=8, help="solutions whose best manipulability is kept")
    options.add_argument("--workers", type=int, help="one for each core if not said")
    options.add_argument("--into", type=Path, default=Path("reachability"), help="folder of targets and answers")
    options.add_argument("--picture", type=Path, default=Path("reachability.png"))
    given = options.parse_args()

    robot = kinopt.Robot.from_urdf(given.urdf)
    arm = kinopt.Arm(robot, given.base, given.tip)
    anywhere = robot.random_configuration(20_000, seed=1)[:, [robot.joint_names.index(name) for name in arm.joint_names]]
    reach = np.linalg.norm(arm.base_from_tool(anywhere)[:, :3, 3], axis=1).max()
    points = grid(reach, given.step)
    turned = orientations(given.directions, given.turns)
    into = given.into / f"{given.step}-{given.directions}-{given.turns}-{given.starts}"
    if not (into / "all-targets").exists():
        number = np.repeat(np.arange(len(points)), len(turned))
        targets = kinopt.ray.table(target=poses(points, turned), position=number)
        kinopt.ray.write_blocks(targets, into / "targets", rows=4096)
        (into / "all-targets").touch()

    solver = Reachability(robot, arm, given.tip, given.starts)
    answers = kinopt.ray.solve_files(into / "targets", into / "answers", solver, workers=given.workers)
    table = answers.to_table(columns=["position", "reached", "manipulability"])
    reached = table["reached"].to_numpy().reshape(len(points), len(turned))
    best = table["manipulability"].to_numpy().reshape(reached.shape)
    share = reached.mean(axis=1)
    best = np.where(reached, best, -np.inf).max(axis=1)
    top = int(np.argmax(best))
    print(f"{len(points)} positions x {len(turned)} orientations, {reached.sum()} poses reached of {reached.size}")
    print(f"positions with any orientation reached: {(share > 0).sum()}, with every one: {(share == 1).sum()}")
    print(f"best manipulability {best[top]:.3f} at {points[top].round(3).tolist()} m")
    draw(points, share, best, given.step, given.picture)
    print(f"drawn: {given.picture}")


if __name__ == "__main__":
    main()
