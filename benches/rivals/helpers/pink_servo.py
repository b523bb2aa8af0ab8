"""pink compared with kinopt's servo, on the lines of `example servoing LINES FOLDER`.

    python benches/rivals/helpers/pink_servo.py FOLDER/franka_panda.json [--lines N] [--plot line.png]

pink solves one quadratic programme per control cycle: a FrameTask of equal gain with its configuration and
velocity limits, Levenberg-Marquardt damping 1e-2, solver DAQP. Its velocity is integrated.

Pinocchio's kinematics judges the joint values alone:

- Control cycles in which a joint exceeds its velocity limit or its range.
- The largest joint displacement in a cycle.
- The peak-to-peak velocity over the last 100 cycles at rest, and the tool's distance from its target there.
- The distance of the end from the start of the line.
"""

import argparse
import json
import pathlib
import time

import numpy as np
import pinocchio as pin
import pink
from pink.tasks import FrameTask

MODELS = pathlib.Path(__file__).resolve().parents[3] / "models"
WATCHED = 100


def placement(pose):
    x, y, z, qw, qx, qy, qz = pose
    return pin.SE3(pin.Quaternion(qw, qx, qy, qz).toRotationMatrix(), np.array([x, y, z]))


def by_pink(model, data, indices, document, line):
    q = pin.neutral(model)
    q[indices] = line["start"]
    configuration = pink.Configuration(model, data, q)
    task = FrameTask(document["tip"], position_cost=1.0, orientation_cost=0.3, lm_damping=1e-2)
    base = configuration.get_transform_frame_to_world(document["base"])
    way, micros = [], []
    for pose in line["targets"]:
        task.set_target(base * placement(pose))
        begun = time.perf_counter()
        try:
            velocity = pink.solve_ik(configuration, [task], document["tick"], solver="daqp", damping=1e-12)
        except Exception:  # No solution within its limits: the arm stops.
            velocity = np.zeros(model.nv)
        configuration.integrate_inplace(velocity, document["tick"])
        micros.append(1e6 * (time.perf_counter() - begun))
        way.append(configuration.q[indices].copy())
    return np.array(way), np.array(micros)


def seen(model, data, indices, document, line, way):
    tick, rest, out = document["tick"], document["rest"], document["way"]
    moves = np.abs(np.diff(np.vstack([line["start"], way]), axis=0))
    limits = np.array(document["velocity_limits"], dtype=float) * tick
    lower, upper = model.lowerPositionLimit[indices], model.upperPositionLimit[indices]
    chatter = 0.0
    for end in (out + rest, len(way)):
        speeds = np.diff(way[end - WATCHED : end], axis=0) / tick
        chatter = max(chatter, np.ptp(speeds, axis=0).max())

    def miss(k):
        q = pin.neutral(model)
        q[indices] = way[k]
        pin.framesForwardKinematics(model, data, q)
        frame = lambda name: data.oMf[model.getFrameId(name)]
        found = frame(document["base"]).actInv(frame(document["tip"]))
        return np.linalg.norm(found.translation - placement(line["targets"][k]).translation)

    return {
        "too fast": int((moves > limits).any(axis=1).sum()),
        "too fast by over 1e-9": int((moves > limits + 1e-9 * tick).any(axis=1).sum()),
        "out of range": int(((way < lower) | (way > upper)).any(axis=1).sum()),
        "longest move": float(moves.max()),
        "chatter": float(chatter),
        "miss out there": float(miss(out + rest - 1)),
        "miss at the end": float(miss(len(way) - 1)),
        "end from start": float(np.abs(way[-1] - way[0]).max()),
    }


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("file")
    parser.add_argument("--lines", type=int, default=20)
    parser.add_argument("--plot")
    arguments = parser.parse_args()
    document = json.loads(pathlib.Path(arguments.file).read_text())
    model = pin.buildModelFromUrdf(str(MODELS / f"{document['robot']}.urdf"))
    data = model.createData()
    indices = [model.joints[model.getJointId(name)].idx_q for name in document["joints"]]
    table = {"kinopt": [], "pink": []}
    micros = []
    for k, line in enumerate(document["lines"][: arguments.lines]):
        ways = {"kinopt": np.array(line["kinopt"])}
        ways["pink"], taken = by_pink(model, data, indices, document, line)
        micros.append(taken)
        for who, way in ways.items():
            table[who].append(seen(model, data, indices, document, line, way))
        if k == 0 and arguments.plot:
            plot(arguments.plot, document, ways)
    print(f"{document['robot']}: {len(table['pink'])} lines; pink {np.median(np.concatenate(micros)):.0f} us a tick")
    for who, rows in table.items():
        told = []
        for what in rows[0]:
            values = [row[what] for row in rows]
            whole = all(isinstance(value, int) for value in values)
            told.append(f"{what} {sum(values) if whole else f'{max(values):.1e}'}")
        print(f"  {who}: " + ", ".join(told))


def plot(path, document, ways):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 2, figsize=(11, 6), sharex=True, sharey="row")
    for column, (who, way) in enumerate(ways.items()):
        seconds = np.arange(len(way)) * document["tick"]
        axes[0, column].plot(seconds, way)
        axes[0, column].set_title(f"{who}: {document['robot']}, out of the workspace and back")
        axes[1, column].plot(seconds[1:], np.diff(way, axis=0) / document["tick"])
        axes[1, column].set_xlabel("seconds")
    axes[0, 0].set_ylabel("joints, rad")
    axes[1, 0].set_ylabel("speeds, rad/s")
    figure.tight_layout()
    figure.savefig(path, dpi=90)


if __name__ == "__main__":
    main()
