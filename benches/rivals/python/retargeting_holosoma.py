"""``holosoma-retargeting`` (PyPI, Apache-2.0): its retargeter on its own climbing captures, and the measures of its
evaluator.

The evaluator accepts any movement of the G1 among its boxes. FOLDER has the unpacked package. Both run inside it,
because their paths are relative, and write scaled scenes there.
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import os
import sys
import time
import types
from pathlib import Path

import numpy as np

HEIGHT, PERSON, EVERY = 1.32, 1.78, 4
ROBOT = "models/g1/g1_29dof_spherehand.urdf"


class Holosoma:
    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        sys.path.insert(0, str(self.folder.parent))
        # Only other kinds of captures need these large packages, so empty modules replace them during the import.
        stand_ins = [name for name in ("torch", "smplx") if importlib.util.find_spec(name) is None]
        for name in stand_ins:
            sys.modules[name] = types.ModuleType(name)
            sys.modules[name].Tensor = type("Tensor", (), {})
        with self._inside():
            from holosoma_retargeting.evaluation import eval_retargeting  # noqa: F401
            from holosoma_retargeting.examples import robot_retarget  # noqa: F401
        for name in stand_ins:
            del sys.modules[name]

    @contextlib.contextmanager
    def _inside(self):
        before = Path.cwd()
        os.chdir(self.folder)
        try:
            with contextlib.redirect_stdout(io.StringIO()):
                yield
        finally:
            os.chdir(before)

    def task(self, capture: np.ndarray) -> str | None:
        """Name of the task with this capture, or None."""
        for file in sorted((self.folder / "demo_data/climb").glob("*/*.npy")):
            own = np.load(file, mmap_mode="r")
            if own.shape == capture.shape and np.allclose(own, capture, atol=1e-6):
                return file.parent.name
        return None

    def retarget(self, task: str, frames: int | None) -> tuple[np.ndarray, float]:
        """Runs the program with the settings of its README, at its rate for captures. The seconds are those of its
        solver.
        """
        from holosoma_retargeting.config_types.retargeting import RetargetingConfig
        from holosoma_retargeting.config_types.robot import RobotConfig
        from holosoma_retargeting.examples import robot_retarget as program

        found: dict = {}
        solve = program.InteractionMeshRetargeter.retarget_motion

        def timed(own, human_joint_motions, **rest):
            for name in ("object_poses", "object_poses_augmented", "foot_sticking_sequences"):
                rest[name] = rest[name][:frames]
            begun = time.process_time()
            found["q"] = solve(own, human_joint_motions[:frames], **rest)[0]
            found["seconds"] = time.process_time() - begun

        program.InteractionMeshRetargeter.retarget_motion = timed
        try:
            with self._inside(), contextlib.redirect_stderr(io.StringIO()):
                program.main(RetargetingConfig(
                    data_path=Path("demo_data/climb"), task_type="climbing", task_name=task, data_format="mocap",
                    robot_config=RobotConfig(robot_type="g1", robot_urdf_file=ROBOT), save_dir=Path("results")))
        finally:
            program.InteractionMeshRetargeter.retarget_motion = solve
        return found["q"], found["seconds"]

    def measures(self, task: str, q: np.ndarray, scale: float, places: np.ndarray) -> dict[str, float]:
        """Measures of the evaluator for configurations in its model's order. Its boxes are scaled like the movement;
        ``places`` are the capture's positions at the same frames.
        """
        with self._inside():
            from holosoma_retargeting.config_types.data_type import MotionDataConfig
            from holosoma_retargeting.config_types.robot import RobotConfig
            from holosoma_retargeting.evaluation import eval_retargeting as evaluation

            told = RobotConfig(robot_type="g1", robot_urdf_file=ROBOT)
            motion = MotionDataConfig(data_format="mocap", robot_type="g1")
            own = evaluation.create_task_constants(told, motion, object_name="multi_boxes",
                                                   object_dir=f"demo_data/climb/{task}")
            scales = (scale,) * 3
            boxes = evaluation.create_scaled_multi_boxes_xml(f"{own.OBJECT_DIR}/box_assets.xml", scales)
            scene = f"{own.OBJECT_DIR}/g1_29dof_spherehand_w_multi_boxes.xml"
            own.SCENE_XML_FILE = evaluation.create_new_scene_xml_file(scene, scales, boxes)
            judge = evaluation.RetargetingEvaluator(
                ROBOT, own.OBJECT_URDF_FILE, "multi_boxes", own.DEMO_JOINTS, own.JOINTS_MAPPING, False, own)
            deep, depths = judge.evaluate_penetration(q)
            person = scale * places
            stands = evaluation.extract_foot_sticking_sequence_velocity(
                person, own.DEMO_JOINTS, ["LeftToeBase", "RightToeBase"])
            slides, _ = judge.detect_foot_sliding(q, stands)
            # The evaluator's loop over frames never poses the robot, so each frame is posed and evaluated separately.
            kept = []
            for row, joints in zip(q, person):
                if judge.detect_demo_contact(joints):
                    judge._get_robot_link_positions(row, [])
                    kept.append(judge.evaluate_terrain_contact_precision(joints[None], row[None]))
        return {"deep": 100 * deep, "deepest": 1e3 * max(depths, default=0.0), "slides": 100 * float(slides),
                "kept": 100 * float(np.mean(kept)) if kept else 100.0}
