"""PyRoki and cuRobo for gpu_batches.py, with the settings of their authors."""

from __future__ import annotations

import json
import os
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from gpu_answers import BATCHES, TIP, Answers

# Without this JAX would allocate most of the GPU's memory.
os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")

# Seeds of the first solves, number of kept seeds, and steps of both phases, as in PyRoki's benchmark/ik_benchmark.py.
BEAM = {"seeds": 64, "kept": 4, "first": 6, "then": 10}
# Number of starts for PyRoki's example with collisions, which has one start. The best collision-free solution counts.
CLEAR_STARTS = 32


def quaternion(matrices: np.ndarray) -> np.ndarray:
    """Quaternions w, x, y, z."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(matrices).as_quat()[:, [3, 0, 1, 2]]


class PyRoki:
    """PyRoki's robot, capsules and costs."""

    def __init__(self, curobo: Path, folder: Path, worlds: dict) -> None:
        import jax.numpy as jnp
        import pyroki as pk
        import yourdfpy

        meshes = curobo / "curobo/content/assets/robot/franka_description"
        urdf = yourdfpy.URDF.load(str(folder / "panda.urdf"), mesh_dir=str(meshes), load_meshes=False,
                                  build_collision_scene_graph=True, load_collision_meshes=True)
        self.robot = pk.Robot.from_urdf(urdf)
        ignored = json.loads((folder / "spheres.json").read_text())["ignored"]
        pairs = tuple((first, second) for first, others in ignored.items() for second in others)
        pairs += (("panda_link3", "panda_link5"),)  # These capsules overlap in nine of ten configurations.
        self.shapes = pk.collision.RobotCollision.from_urdf(urdf, user_ignore_pairs=pairs)
        self.tip = jnp.array(self.robot.links.names.index(TIP))
        self.world = [
            pk.collision.Sphere.from_center_and_radius(worlds["spheres_at"], worlds["spheres_radius"]),
            pk.collision.Capsule.from_radius_height(*worlds["capsules_size"].T, worlds["capsules_at"], worlds["capsules_turn"]),
        ]

    def distance(self, q):
        """Smallest distance of the capsules to each other and to the world, metres."""
        import jax.numpy as jnp

        told = [self.shapes.compute_self_collision_distance(self.robot, q).min()]
        told += [self.shapes.compute_world_collision_distance(self.robot, q, one).min() for one in self.world]
        return jnp.stack(told).min()

    def starts(self, count: int):
        """Roberts' sequence over the limits, as in PyRoki's benchmark."""
        import jax.numpy as jnp

        number = self.robot.joints.num_actuated_joints
        root = 1.5
        for _ in range(100):
            root -= (root ** (number + 1) - root - 1) / ((number + 1) * root**number - 1)
        spread, _ = jnp.modf(jnp.arange(count)[:, None] * (1 - root ** -(1.0 + jnp.arange(number)))[None])
        lower, upper = self.robot.joints.lower_limits, self.robot.joints.upper_limits
        return lower + spread * (upper - lower)

    def pose(self, wxyz, at):
        import jaxlie

        return jaxlie.SE3.from_rotation_and_translation(jaxlie.SO3(wxyz), at)

    def plain(self, wxyz, at):
        """IK-Beam of PyRoki's benchmark: a few steps from many seeds, then more from the best ones."""
        import jax
        import jax.numpy as jnp
        import jaxls
        import pyroki as pk

        def solve(start, damping, steps):
            variable = self.robot.joint_var_cls(0)
            costs = [pk.costs.pose_cost_analytic_jac(self.robot, variable, self.pose(wxyz, at), self.tip, pos_weight=10.0, ori_weight=5.0),
                     pk.costs.limit_cost(self.robot, variable, weight=50.0)]
            found, summary = jaxls.LeastSquaresProblem(costs, [variable]).analyze().solve(
                initial_vals=jaxls.VarValues.make([variable.with_value(start)]), verbose=False, linear_solver="dense_cholesky",
                termination=jaxls.TerminationConfig(max_iterations=steps, early_termination=False),
                trust_region=jaxls.TrustRegionConfig(lambda_initial=damping), return_summary=True)
            return found[variable], summary

        many = jax.vmap(solve, in_axes=(0, 0, None))
        first, summary = many(self.starts(BEAM["seeds"]), jnp.full(BEAM["seeds"], 10.0), BEAM["first"])
        best = jnp.argsort(summary.cost_history[:, -1])[:BEAM["kept"]]
        last, summary = many(first[best], summary.lambda_history[:, -1][best], BEAM["then"])
        costs = summary.cost_history[jnp.arange(BEAM["kept"]), summary.iterations]
        return last[jnp.argmin(costs)]

    def clear(self, wxyz, at):
        """PyRoki's example with collisions (_solve_ik_with_collision.py) from many starts; returns the best
        collision-free solution.
        """
        import jax
        import jax.numpy as jnp
        import jaxlie
        import jaxls
        import pyroki as pk

        def solve(start):
            variable = self.robot.joint_var_cls(0)
            costs = [pk.costs.pose_cost(self.robot, variable, target_pose=self.pose(wxyz, at), target_link_index=self.tip,
                                        pos_weight=5.0, ori_weight=1.0),
                     pk.costs.limit_cost(self.robot, joint_var=variable, weight=100.0),
                     pk.costs.rest_cost(variable, rest_pose=jnp.array(variable.default_factory()), weight=0.01),
                     pk.costs.self_collision_cost(self.robot, robot_coll=self.shapes, joint_var=variable, margin=0.02, weight=5.0)]
            costs += [pk.costs.world_collision_cost(self.robot, self.shapes, variable, one, 0.05, 10.0) for one in self.world]
            found = jaxls.LeastSquaresProblem(costs, [variable]).analyze().solve(
                initial_vals=jaxls.VarValues.make([variable.with_value(start)]), verbose=False, linear_solver="dense_cholesky")
            return found[variable]

        def badness(q):
            off = jaxlie.SE3(self.robot.forward_kinematics(q)[self.tip]).inverse() @ self.pose(wxyz, at)
            return jnp.linalg.norm(off.log()) + 1e3 * (self.distance(q) < 0)

        found = jax.vmap(solve)(self.starts(CLEAR_STARTS))
        return found[jnp.argmin(jax.vmap(badness)(found))]


def capsules_touch(curobo: Path, folder: Path, worlds: dict, configurations: np.ndarray) -> np.ndarray:
    """Flags configurations that are in collision by PyRoki's capsules."""
    import jax

    return np.array(jax.jit(jax.vmap(PyRoki(curobo, folder, worlds).distance))(configurations) <= 0)


def by_pyroki(curobo: Path, folder: Path, questions: dict) -> None:
    import jax
    import jaxls
    from loguru import logger

    logger.disable("jaxls")
    logger.disable("pyroki")
    about = {"jax": jax.__version__, "jaxls": jaxls.__version__, "device": str(jax.devices()[0].device_kind)}
    answers = Answers(folder, "pyroki", about)
    asked = PyRoki(curobo, folder, questions)
    jobs = [("PyRoki, IK-Beam", "plain", batch, asked.plain) for batch in BATCHES.get("plain", ())]
    jobs += [(f"PyRoki's example, {CLEAR_STARTS} starts", "rounds", batch, asked.clear) for batch in BATCHES.get("rounds", ())]

    def compiled(job):
        _, _, batch, solve = job
        begun = time.perf_counter()
        example = [jax.ShapeDtypeStruct((batch, wide), np.float32) for wide in (4, 3)]
        return jax.jit(jax.vmap(solve)).lower(*example).compile(), time.perf_counter() - begun

    with ThreadPoolExecutor(len(jobs)) as pool:  # XLA compiles without the GIL.
        ready = list(pool.map(compiled, jobs))
    for (name, kind, batch, _), (program, prepared) in zip(jobs, ready):
        targets = questions[f"{kind}_targets"]
        turns = quaternion(targets[:, :3, :3]).astype(np.float32)

        def call(given, preparing):
            if preparing:
                return jax.block_until_ready([jax.device_put(turns[given]), jax.device_put(targets[given, :3, 3].astype(np.float32))])
            return jax.block_until_ready(program(*given))

        answers.take(name, kind, batch, len(targets), prepared, call, np.asarray)


def by_curobo(curobo: Path, folder: Path, questions: dict) -> None:
    import torch
    import warp
    import yaml
    from curobo import __version__
    from curobo.inverse_kinematics import InverseKinematics, InverseKinematicsCfg
    from curobo.types import GoalToolPose, Pose

    about = {"cuRobo": __version__, "torch": torch.__version__, "warp": warp.__version__, "device": torch.cuda.get_device_name()}
    answers = Answers(folder, "curobo", about)
    told = (curobo / "curobo/content/configs/robot/franka.yml").read_text()
    boxes = zip(questions["boxes_at"], questions["boxes_turn"], questions["boxes_size"])
    boxes = [(f"box {index}", [*map(float, at), *map(float, turn)], list(map(float, size))) for index, (at, turn, size) in enumerate(boxes)]

    def solver(kind: str, batch: int, own: bool):
        robot = yaml.safe_load(told)["robot_cfg"]
        settings = {"robot": robot, "use_cuda_graph": True, "max_batch_size": batch}
        if kind == "plain":
            robot["kinematics"]["collision_link_names"] = None  # As in cuRobo's benchmark of plain poses.
            settings["self_collision_check"] = False
        else:
            settings["scene_model"] = {"cuboid": {name: {"pose": pose, "dims": size} for name, pose, size in boxes}}
        if own:  # As in cuRobo's benchmark/ik_benchmark.py for the Panda.
            settings |= {"optimizer_configs": ["ik/lbfgs_ik.yml"], "num_seeds": 2 if kind == "plain" else 8,
                         "optimizer_collision_activation_distance": 0.0025}
        return InverseKinematics(InverseKinematicsCfg.create(**settings))

    names = {True: "cuRobo, its benchmark's settings", False: "cuRobo, defaults"}
    jobs = [(names[own], kind, batch, own) for own in names for kind in ("plain", "boxes") for batch in BATCHES.get(kind, ())]
    jobs.sort(key=lambda job: job[2] > 1_000)  # A GPU fault ends the process, as happened with 10 000 poses at once.
    for name, kind, batch, own in jobs:
        begun = time.perf_counter()
        targets = questions[f"{kind}_targets"]
        turns = quaternion(targets[:, :3, :3])

        def goals(block):
            at, turn = (torch.tensor(one[block], device="cuda", dtype=torch.float32) for one in (targets[:, :3, 3], turns))
            made = GoalToolPose.from_poses({TIP: Pose(position=at, quaternion=turn)}, num_goalset=1)
            torch.cuda.synchronize()
            return made

        asked = solver(kind, batch, own)
        asked.config.exit_early = False
        for _ in range(3):  # As in cuRobo's benchmark: warm-up of all stages with their graphs
            asked.solve_pose(goals(np.arange(batch)))
        asked.config.exit_early = True
        torch.cuda.synchronize()
        prepared = time.perf_counter() - begun

        def call(given, preparing):
            if preparing:
                return goals(given)
            result = asked.solve_pose(given)
            torch.cuda.synchronize()
            return result

        def fetch(result):
            found = result.js_solution
            chosen = [found.joint_names.index(f"panda_joint{number}") for number in range(1, 8)]
            q = found.position.view(batch, -1)[:, chosen].double().cpu().numpy()
            return np.where(result.success.view(batch, 1).cpu().numpy(), q, np.nan)

        answers.take(name, kind, batch, len(targets), prepared, call, fetch)
        asked.destroy()
        asked = None
        torch.cuda.empty_cache()
