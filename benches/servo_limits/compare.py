"""Servoing a Panda at 1 kHz within the maker's velocity, acceleration and jerk limits: four controllers in one run.

- kinopt: ``Arm.servo`` with the limits of ``models/franka_panda_limits.yaml``
- kinopt, velocity limits only
- kinopt with velocity limits, then ruckig (PyPI) on its output
- pink (PyPI ``pin-pink``) with velocity and acceleration limits

Run from the project's root: ``python benches/servo_limits/compare.py [--plot docs/servo-limits.png]``. Needs the Python package,
``pip install ruckig pin-pink quadprog matplotlib``.
"""

import argparse
import time

import numpy as np

import kinopt

STEP = 0.001
START = np.array([0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])
MODEL = "models/franka_panda.urdf"


def arm_with_limits():
    robot = kinopt.Robot.from_urdf(MODEL).with_joint_limits("models/franka_panda_limits.yaml")
    return kinopt.Arm(robot, "base", "flange")


ARM = arm_with_limits()
FIRST = ARM.base_from_tool(START)
VELOCITY, ACCELERATION, JERK = ARM.velocity_limits, ARM.acceleration_limits, ARM.jerk_limits


def moved(x=0.0, y=0.0, z=0.0):
    target = FIRST.copy()
    target[:3, 3] += (x, y, z)
    return target


def angle(t, rate):
    """Angle of a circle whose speed rises smoothly in the first second."""
    return rate * (t**4 * (2.5 - 3 * t + t * t)) if t < 1 else rate * (t - 0.5)


def circle(t):
    a = angle(t, 3.0)
    return moved(y=0.1 * np.sin(a), z=0.1 * (1 - np.cos(a)))


def noisy_circle(t):
    noise = np.random.default_rng(int(round(t / STEP))).normal(scale=1e-5, size=3)
    target = circle(t)
    target[:3, 3] += noise
    return target


def hand(t):
    """A hand path with 1 mm noise, held at 30 Hz."""
    k = np.floor(t * 30 + 1e-9)
    t = k / 30
    noise = np.random.default_rng(int(k)).normal(scale=1e-3, size=3)
    return moved(0.05 * np.sin(2.1 * t) + noise[0], 0.15 * np.sin(3.3 * t) + noise[1], 0.1 * np.sin(4.7 * t) + noise[2])


def pose_step(t):
    return moved(y=0.2, z=0.1) if t < 1.5 else FIRST


def reach(t):
    """Out of reach and back, at 0.3 m/s."""
    return moved(x=0.3 * (2 - abs(t - 2)))


COURSES = {
    "circle, 0.3 m/s": (circle, 5.0),
    "circle with 0.01 mm noise": (noisy_circle, 5.0),
    "hand path at 30 Hz": (hand, 5.0),
    "steps of 0.22 m": (pose_step, 3.0),
    "out of reach and back": (reach, 5.0),
}


class Kinopt:
    name = "kinopt"

    def __init__(self):
        self.servo = ARM.servo(START, STEP)

    def step(self, target):
        return self.servo.step(target).q


class KinoptVelocity(Kinopt):
    name = "kinopt, velocity limits only"

    def __init__(self):
        inf = np.full(7, np.inf)
        self.servo = ARM.servo(START, STEP, acceleration_limits=inf, jerk_limits=inf)


class Ruckig(KinoptVelocity):
    name = "kinopt, then ruckig"

    def __init__(self):
        import ruckig

        super().__init__()
        self.ruckig = ruckig.Ruckig(7, STEP)
        self.input, self.output = ruckig.InputParameter(7), ruckig.OutputParameter(7)
        self.input.current_position = START
        self.input.max_velocity, self.input.max_acceleration, self.input.max_jerk = VELOCITY, ACCELERATION, JERK

    def step(self, target):
        self.input.target_position = super().step(target)
        self.ruckig.update(self.input, self.output)
        self.output.pass_to_input(self.input)
        return np.array(self.output.new_position)


class Pink:
    name = "pink, velocity and acceleration limits"

    def __init__(self):
        import pinocchio
        import pink

        self.pink, self.pinocchio = pink, pinocchio
        model = pinocchio.buildModelFromUrdf(MODEL)
        fingers = [i for i in range(1, model.njoints) if "finger" in model.names[i]]
        self.model = pinocchio.buildReducedModel(model, fingers, pinocchio.neutral(model))
        self.configuration = pink.Configuration(self.model, self.model.createData(), START.copy())
        self.task = pink.tasks.FrameTask("flange", position_cost=1.0, orientation_cost=1.0, lm_damping=1e-6)
        self.limits = [
            pink.limits.ConfigurationLimit(self.model),
            pink.limits.VelocityLimit(self.model),
            pink.limits.AccelerationLimit(self.model, np.array(ACCELERATION)),
        ]

    def step(self, target):
        self.task.set_target(self.pinocchio.SE3(np.ascontiguousarray(target)))
        try:
            v = self.pink.solve_ik(self.configuration, [self.task], STEP, solver="quadprog", limits=self.limits)
        except self.pink.exceptions.PinkError:
            v = np.zeros(7)
        self.configuration.integrate_inplace(v, STEP)
        self.limits[2].set_last_integration(v, STEP)
        return self.configuration.q.copy()


def measure(controller, course, duration):
    count = int(round(duration / STEP))
    q, micros = np.empty((count + 1, 7)), np.empty(count)
    q[0] = START
    targets = np.array([course((k + 1) * STEP) for k in range(count)])
    for k, target in enumerate(targets):
        begin = time.perf_counter()
        q[k + 1] = controller.step(target)
        micros[k] = 1e6 * (time.perf_counter() - begin)
    v = np.diff(q, axis=0, prepend=q[:1]) / STEP
    a = np.diff(v, axis=0, prepend=0 * v[:1]) / STEP
    j = np.diff(a, axis=0, prepend=0 * a[:1]) / STEP
    rates = [(abs(x) / limit).max() for x, limit in ((v, VELOCITY), (a, ACCELERATION), (j, JERK))]
    tool = ARM.base_from_tool(q[1:])[:, :3, 3]
    error = targets[:, :3, 3] - tool
    moving = abs(v[1:]).max(1) > 1e-3
    reversals = (((v[1:] * v[:-1]) < 0) & (np.minimum(abs(v[1:]), abs(v[:-1])) > 0.1)).any(1).sum()
    return {
        "q": q,
        "acceleration": a,
        "tool": tool,
        "targets": targets[:, :3, 3],
        "rates": rates,
        "error": np.linalg.norm(error, axis=1),
        "reversals": int(reversals),
        "lag": lag(targets[:, :3, 3], tool),
        "micros": np.percentile(micros[moving], [50, 99]) if moving.any() else (0, 0),
    }


def lag(target, tool):
    """Delay that explains most of the error, milliseconds."""
    errors = []
    for shift in range(0, 150):
        errors.append(np.square(target[: len(target) - shift] - tool[shift:]).sum(1).mean())
    return 1e3 * STEP * int(np.argmin(errors))


def settled(result):
    """Time from the step to the last row farther than 1 mm from the pose, seconds."""
    rows = np.flatnonzero(result["error"][:1498] > 1e-3)
    return (rows[-1] + 1) * STEP if len(rows) else 0.0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--plot")
    arguments = parser.parse_args()
    results = {}
    print("multiples of the limits (at most 1 keeps them), error of the tool after the first 0.1 s, delay, reversals, microseconds a moving cycle\n")
    print("| course | controller | velocity | acceleration | jerk | largest error, mm | delay, ms | reversals | µs median | µs p99 |")
    print("|---|---|---:|---:|---:|---:|---:|---:|---:|---:|")
    for name, (course, duration) in COURSES.items():
        for kind in (Kinopt, KinoptVelocity, Ruckig, Pink):
            result = results[name, kind.name] = measure(kind(), course, duration)
            v, a, j = result["rates"]
            p50, p99 = result["micros"]
            print(
                f"| {name} | {kind.name} | {v:.3f} | {a:.3g} | {j:.3g} | {1e3 * result['error'][100:].max():.3f} | "
                f"{result['lag']:.0f} | {result['reversals']} | {p50:.1f} | {p99:.1f} |"
            )
    for kind in (Kinopt, KinoptVelocity, Ruckig, Pink):
        print(f"step: within 1 mm after {settled(results['steps of 0.22 m', kind.name]):.3f} s with {kind.name}")
    if arguments.plot:
        plot(results, arguments.plot)


def plot(results, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 2, figsize=(11, 7), layout="constrained")
    kinds = [kind.name for kind in (Kinopt, KinoptVelocity, Ruckig, Pink)]
    for name in kinds:
        circle_ = results["circle, 0.3 m/s", name]
        t = np.arange(len(circle_["error"])) * STEP
        axes[0, 0].semilogy(t, 1e3 * circle_["error"] + 1e-7, label=name)
        step = results["steps of 0.22 m", name]
        t = np.arange(len(step["error"])) * STEP
        axes[0, 1].semilogy(t, 1e3 * step["error"] + 1e-4, label=name)
        hand_ = results["hand path at 30 Hz", name]
        t = np.arange(len(hand_["acceleration"])) * STEP
        axes[1, 0].semilogy(t, (abs(hand_["acceleration"]) / ACCELERATION).max(1) + 1e-3, label=name, lw=0.7)
        far = results["out of reach and back", name]
        t = np.arange(len(far["q"])) * STEP
        axes[1, 1].plot(t, far["q"][:, 3], label=name)
    axes[0, 0].set(title="circle: error of the tool", xlabel="s", ylabel="mm")
    axes[0, 1].set(title="steps: error of the tool", xlabel="s", ylabel="mm")
    axes[1, 0].set(title="hand path at 30 Hz: acceleration, multiples of the limit", xlabel="s", ylabel="")
    axes[1, 0].axhline(1.0, color="black", lw=1)
    axes[1, 1].set(title="out of reach and back: elbow", xlabel="s", ylabel="rad")
    axes[0, 0].legend(fontsize=8)
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
