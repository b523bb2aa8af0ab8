"""Decisions of `Arm.reachability` for small arms next to independent ones: closed form and brute force.

Run: python benches/reachability/brute_force.py [--poses N]

Planar arm of three revolute joints with limits, poses in its plane: the wrist is given by the pose, and the law of cosines gives
both elbow solutions. UR5e with three free joints, positions only: the published Denavit-Hartenberg table gives the distance of the
nearest of 10^6 configurations, and Gauss-Newton steps within the limits refine the 20 nearest ones.
"""

import argparse
import math

import numpy as np

import kinopt

LINKS = (0.5, 0.4, 0.2)
LIMITS = ((-2.0, 2.5), (-2.2, 0.4), (-1.0, 1.9))
#: Goals closer than this to the border of the reach are left out, metres or radians.
BORDER = 1e-4
#: Denavit-Hartenberg table of Universal Robots' UR5e: a, d (metres) and alpha of each joint.
UR5E = ((0, 0.1625, math.pi / 2), (-0.425, 0, 0), (-0.3922, 0, 0), (0, 0.1333, math.pi / 2), (0, 0.0997, -math.pi / 2), (0, 0.0996, 0))
HELD = {"wrist_1": -1.0, "wrist_2": 1.2, "wrist_3": 0.4}


def planar_arm():
    parts = ['<robot name="planar"><link name="l0"/>']
    for i, (lower, upper) in enumerate(LIMITS):
        x = LINKS[i - 1] if i else 0.0
        parts.append(f'<joint name="j{i}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/><origin xyz="{x} 0 0"/>'
                     f'<axis xyz="0 0 1"/><limit lower="{lower}" upper="{upper}" effort="1" velocity="1"/></joint><link name="l{i + 1}"/>')
    parts.append(f'<joint name="end" type="fixed"><parent link="l3"/><child link="tool"/><origin xyz="{LINKS[2]} 0 0"/></joint>'
                 '<link name="tool"/></robot>')
    return kinopt.Arm(kinopt.Robot.from_urdf_text("".join(parts)), "l0", "tool")


def planar_slack(x, y, angle):
    """Largest margin to the limits of both elbow solutions, radians; negative if no solution is within the limits."""
    x, y = x - LINKS[2] * math.cos(angle), y - LINKS[2] * math.sin(angle)
    a, b = LINKS[:2]
    cosine = (x * x + y * y - a * a - b * b) / (2 * a * b)
    if abs(cosine) > 1:
        return 1 - abs(cosine)
    best = -math.inf
    for elbow in (math.acos(cosine), -math.acos(cosine)):
        shoulder = math.atan2(y, x) - math.atan2(b * math.sin(elbow), a + b * math.cos(elbow))
        margin = math.inf
        for value, (lower, upper) in zip((shoulder, elbow, angle - shoulder - elbow), LIMITS):
            turns = [value + 2 * math.pi * k for k in range(-2, 3)]
            margin = min(margin, max(min(v - lower, upper - v) for v in turns))
        best = max(best, margin)
    return best


def planar(poses, rng):
    arm = planar_arm()
    counts = {True: [0, 0], False: [0, 0], None: [0, 0]}
    boxes = []
    for _ in range(poses):
        radius, direction, angle = sum(LINKS) * math.sqrt(rng.uniform()), *rng.uniform(-math.pi, math.pi, 2)
        x, y = radius * math.cos(direction), radius * math.sin(direction)
        slack = planar_slack(x, y, angle)
        if abs(slack) < BORDER:
            continue
        answer = arm.reachability(kinopt.placement([x, y, 0], rpy=[0, 0, angle]))
        counts[answer.reachable][int(slack > 0)] += 1
        boxes.append(answer.boxes)
    return counts, boxes


def ur5e_positions(q):
    """Positions of the flange in the base for joint values of shape (N, 6), and their derivatives (N, 3, 6)."""
    pose = np.broadcast_to(np.eye(4), (len(q), 4, 4)).copy()
    axes, origins = [], []
    for i, (a, d, alpha) in enumerate(UR5E):
        axes.append(pose[:, :3, 2].copy())
        origins.append(pose[:, :3, 3].copy())
        c, s, ca, sa = np.cos(q[:, i]), np.sin(q[:, i]), math.cos(alpha), math.sin(alpha)
        link = np.zeros((len(q), 4, 4))
        link[:, 0] = np.stack([c, -s * ca, s * sa, a * c], axis=1)
        link[:, 1] = np.stack([s, c * ca, -c * sa, a * s], axis=1)
        link[:, 2, 1], link[:, 2, 2], link[:, 2, 3], link[:, 3, 3] = sa, ca, d, 1.0
        pose = pose @ link
    at = pose[:, :3, 3]
    return at, np.stack([np.cross(axis, at - origin) for axis, origin in zip(axes, origins)], axis=2)


def least_distance(goal, q, lower, upper):
    """Least distance to the goal, metres, after Gauss-Newton steps of the first three joints within the limits."""
    for _ in range(40):
        at, jacobian = ur5e_positions(q)
        jacobian = jacobian[:, :, :3]
        damped = np.einsum("nij,nik->njk", jacobian, jacobian) + 1e-9 * np.eye(3)
        step = np.linalg.solve(damped, np.einsum("nij,ni->nj", jacobian, goal - at)[..., None])[..., 0]
        q[:, :3] = np.clip(q[:, :3] + np.clip(step, -0.3, 0.3), lower, upper)
    return np.linalg.norm(ur5e_positions(q)[0] - goal, axis=1).min()


def three_of_six(poses, rng):
    robot = kinopt.models.ur5e()
    names = kinopt.Arm(robot, "base", "flange").joint_names
    locked = {name: value for name, value in zip(names[3:], HELD.values())}
    limits = {names[0]: (-2.0, 1.0), names[1]: (-2.2, 0.3), names[2]: (-1.0, 2.4)}
    arm = kinopt.Arm(robot, "base", "flange", goal="position", locked=locked, joint_limits=limits)
    lower, upper = np.array(list(limits.values())).T
    steps = np.stack(np.meshgrid(*(np.linspace(*limit, 100) for limit in limits.values()), indexing="ij"), axis=-1).reshape(-1, 3)
    grid = np.hstack([steps, np.tile(list(HELD.values()), (len(steps), 1))])
    at = ur5e_positions(grid)[0]
    free = arm.base_from_tool(grid[::50_000, : len(arm.joint_names)] if len(arm.joint_names) == 3 else grid[::50_000])
    assert np.abs(free[:, :3, 3] - at[::50_000]).max() < 1e-9, "the model differs from the published table"
    counts = {True: [0, 0], False: [0, 0], None: [0, 0]}
    boxes = []
    radius, centre = np.linalg.norm(at - at.mean(axis=0), axis=1).max(), at.mean(axis=0)
    for _ in range(poses):
        direction = rng.normal(size=3)
        goal = centre + radius * direction / np.linalg.norm(direction) * rng.uniform() ** (1 / 3)
        order = np.argpartition(np.square(at - goal).sum(axis=1), 20)[:20]
        distance = least_distance(goal, grid[order].copy(), lower, upper)
        if 1e-9 < distance < BORDER:
            continue
        answer = arm.reachability(kinopt.placement(goal))
        counts[answer.reachable][int(distance < 1e-6)] += 1
        boxes.append(answer.boxes)
    return counts, boxes


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poses", type=int, default=10_000)
    chosen = parser.parse_args()
    print("| arm | goals | reachable, both | unreachable, both | undecided | reachable by kinopt alone | unreachable by kinopt alone "
          "| median boxes of unreachable |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    rng = np.random.default_rng(5)
    for name, (counts, boxes) in (("planar, three joints", planar(chosen.poses, rng)),
                                  ("UR5e, three free joints, positions", three_of_six(chosen.poses // 20, rng))):
        searched = [count for count in boxes if count]
        print(f"| {name} | {len(boxes)} | {counts[True][1]} | {counts[False][0]} | {sum(counts[None])} | {counts[True][0]} | "
              f"{counts[False][1]} | {int(np.median(searched)) if searched else 0} |", flush=True)


if __name__ == "__main__":
    main()
