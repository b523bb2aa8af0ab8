"""The problems of notebook 2, sampled from a fixed seed. Lengths are in metres, angles in radians."""

import numpy as np

from problem import model

SEED = 20261121
HUMANOID_TIPS = ["head/tip", "left_hand/tip", "right_hand/tip", "left_foot/tip", "right_foot/tip"]
NAO_TIPS = ["head", "left_hand", "right_hand", "left_sole", "right_sole"]
ARMS = {"panda": "tool", "ur5e": "flange", "iiwa14": "flange"}


def listed(array):
    return [float(v) for v in np.asarray(array).ravel()]


def point(frame, target, metres=1.0):
    return {"task": "point", "frame": frame, "target": listed(target), "weights": {"metres": metres}}


def pose(frame, placement, metres, radians, shift=(0, 0, 0)):
    return {"task": "pose", "frame": frame, "target": listed(placement[:3, 3] + np.array(shift)),
            "rotation": listed(placement[:3, :3]), "weights": {"metres": metres, "radians": radians}}


def posture(reference, weight):
    return {"task": "posture", "reference": listed(reference), "weights": {"joint units": weight}}


def centring(weight):
    return {"task": "centring", "weights": {"ratio": weight}}


def unit(rng):
    vector = rng.normal(size=3)
    return vector / np.linalg.norm(vector)


class Draw:
    """Samples problems of one kind. Each kind has its own random stream, so that kinds are independent."""

    def __init__(self, number, kind):
        self.rng = np.random.default_rng([SEED, number])
        self.kind, self.all = kind, []

    def add(self, name, tasks, start):
        own = sum(s["model"] == name for s in self.all) + 1
        self.all.append({"name": f"{self.kind}, {name} {own}", "kind": self.kind, "model": name,
                         "tasks": tasks, "start": listed(start)})

    def start(self, shape, k):
        """Alternates between rest and random starts. Rest is singular in both rigs."""
        return shape.rest() if k % 2 == 0 else shape.sample(self.rng, 0.8)


def five_tips():
    draw, body = Draw(1, "five tips"), model("humanoid")
    for k in range(26):
        q = body.sample(draw.rng, 0.7)
        tasks = [point(tip, body.place(tip, q)[:3, 3]) for tip in HUMANOID_TIPS]
        draw.add("humanoid", tasks, draw.start(body, k))
    return draw.all


def five_tips_out_of_reach():
    draw, body = Draw(2, "five tips out of reach"), model("humanoid")
    for k in range(26):
        q = body.sample(draw.rng, 0.7)
        centre, far = np.array([0, 0, 1.0]), draw.rng.uniform(1.2, 2.0)
        tasks = [point(tip, centre + far * (body.place(tip, q)[:3, 3] - centre)) for tip in HUMANOID_TIPS]
        draw.add("humanoid", tasks, draw.start(body, k))
    return draw.all


def five_tips_with_posture():
    draw = Draw(3, "five tips with posture")
    for k in range(36):
        name, tips = [("humanoid", HUMANOID_TIPS), ("nao", NAO_TIPS)][k % 3 == 2]
        body = model(name)
        q = body.sample(draw.rng, 0.7)
        tasks = [point(tip, body.place(tip, q)[:3, 3], draw.rng.uniform(0.5, 2.0)) for tip in tips]
        tasks.append(posture(body.rest(), draw.rng.uniform(0.01, 0.1)))
        draw.add(name, tasks, draw.start(body, k))
    return draw.all


def viewing_rays():
    draw = Draw(4, "viewing ray")
    for k in range(32):
        name, tip = [("robot-arm", "gripper/tip"), ("humanoid", "left_hand/tip")][k % 4 == 3]
        rig = model(name)
        at = rig.place(tip, rig.sample(draw.rng, 0.8))[:3, 3]
        eye = at + 3 * unit(draw.rng)
        # Every other ray is out of the tip's reach.
        beside = np.cross(unit(draw.rng), at - eye) * (0.0 if k % 2 == 0 else 0.6)
        tasks = [{"task": "ray", "frame": tip, "eye": listed(eye + beside), "through": listed(at + beside),
                  "weights": {"metres": 1.0}}]
        if name == "humanoid":
            rest = rig.rest()
            tasks += [point(other, rig.place(other, rest)[:3, 3]) for other in HUMANOID_TIPS if other != tip]
        if k % 8 >= 4:
            tasks.append(posture(rig.rest(), draw.rng.uniform(0.02, 0.1)))
        draw.add(name, tasks, rig.sample(draw.rng, 0.8) if name == "robot-arm" else rig.rest())
    return draw.all


def poses():
    draw = Draw(5, "pose")
    for k in range(30):
        name = ["panda", "ur5e", "iiwa14"][k % 3]
        arm = model(name)
        target = arm.place(ARMS[name], arm.sample(draw.rng, 0.95))
        draw.add(name, [pose(ARMS[name], target, 1.0, draw.rng.uniform(0.1, 0.5))], arm.sample(draw.rng, 0.9))
    return draw.all


def beyond(shape, rng):
    """Every variable 0.2 to 0.6 beyond one of its limits, or at any value without limits."""
    side = rng.integers(2, size=len(shape.variables))
    excess = rng.uniform(0.2, 0.6, size=len(side))
    outside = np.where(side == 0, shape.lower - excess, shape.upper + excess)
    return np.where(np.isfinite(outside), outside, shape.sample(rng))


def poses_at_limits():
    """Poses of configurations beyond all limits: at the minimum some limits are active."""
    draw = Draw(6, "pose with limits active")
    for k in range(40):
        name = ["panda", "iiwa14", "oblique", "nao"][k % 4]
        tip = {"oblique": "tip", "nao": "left_hand"}.get(name) or ARMS[name]
        arm = model(name)
        target = arm.place(tip, beyond(arm, draw.rng))
        draw.add(name, [pose(tip, target, 1.0, draw.rng.uniform(0.1, 0.5))], arm.sample(draw.rng, 0.9))
    return draw.all


def poses_out_of_reach():
    draw = Draw(7, "pose out of reach")
    for k in range(30):
        name = ["panda", "ur5e", "iiwa14"][k % 3]
        arm = model(name)
        target = arm.place(ARMS[name], arm.sample(draw.rng, 0.9))
        away = unit(draw.rng) * draw.rng.uniform(1.2, 3.0)
        radians = draw.rng.uniform(0.1, 0.5)
        draw.add(name, [pose(ARMS[name], target, 1.0, radians, away)], arm.sample(draw.rng, 0.9))
    return draw.all


def two_arms():
    draw, robot = Draw(8, "two arms"), model("baxter")
    for _ in range(12):
        q = robot.sample(draw.rng, 0.9)
        tasks = [pose(tip, robot.place(tip, q), 1.0, 0.3, 0.4 * unit(draw.rng)) for tip in ("left_tool", "right_tool")]
        draw.add("baxter", tasks, robot.sample(draw.rng, 0.9))
    return draw.all


def looks():
    """The head looks at a point, the hands have a given distance, and the feet are on a plane."""
    draw, body = Draw(9, "look, distance, plane"), model("humanoid")
    for k in range(24):
        seen = np.array([0, 0, 1.6]) + draw.rng.uniform(1.0, 3.0) * unit(draw.rng)
        tasks = [
            {"task": "look-at", "frame": "head", "axis": [0.0, 1.0, 0.0], "target": listed(seen), "weights": {"radians": 0.4}},
            {"task": "distance", "frame": "left_hand/tip", "other": "right_hand/tip",
             "distance": float(draw.rng.uniform(0.1, 2.5)), "weights": {"metres": 1.0}},
        ]
        normal = np.array([0, 0, 1.0]) + 0.2 * unit(draw.rng)
        for foot in ("left_foot/tip", "right_foot/tip"):
            tasks.append({"task": "plane", "frame": foot, "point": [0.0, 0.0, float(draw.rng.uniform(0, 0.3))],
                          "normal": listed(normal), "weights": {"metres": 1.0}})
        tasks.append(posture(body.rest(), draw.rng.uniform(0.02, 0.1)))
        draw.add("humanoid", tasks, draw.start(body, k))
    return draw.all


def orientations():
    draw = Draw(10, "orientation with centring")
    for k in range(24):
        name = ["iiwa14", "ur5e", "baxter"][k % 3]
        frame = {"baxter": "left_tool"}.get(name) or ARMS[name]
        arm = model(name)
        turn = arm.place(frame, arm.sample(draw.rng, 0.9))
        task = {"task": "orientation", "frame": frame, "rotation": listed(turn[:3, :3]), "weights": {"radians": 1.0}}
        draw.add(name, [task, centring(draw.rng.uniform(0.05, 0.3))], arm.sample(draw.rng, 0.9))
    return draw.all


def all_statements():
    kinds = (five_tips, five_tips_out_of_reach, five_tips_with_posture, viewing_rays, poses, poses_at_limits,
             poses_out_of_reach, two_arms, looks, orientations)
    return [statement for kind in kinds for statement in kind()]
