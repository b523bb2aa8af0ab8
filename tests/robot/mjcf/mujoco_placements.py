"""Placements, ranges, masses and loops of the files in this folder according to MuJoCo, for the tests.

    pip install mujoco==4.0.0 && python tests/robot/mjcf/mujoco_placements.py > tests/robot/mjcf/mujoco_placements.json
"""

import json
from pathlib import Path

import mujoco
import numpy as np

FILES = Path(__file__).parent / "files"


def named(model, kind, i, placement):
    name = mujoco.mj_id2name(model, kind, i)
    return name, placement[0].tolist() + placement[1].tolist()


def of_file(path, random):
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    configurations = []
    for _ in range(4):
        # A step in the tangent space from the file's configuration: quaternions keep unit length.
        q = model.qpos0.copy()
        mujoco.mj_integratePos(model, q, random.normal(size=model.nv), 1.0)
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        bodies = [
            named(model, mujoco.mjtObj.mjOBJ_BODY, i, (data.xpos[i], data.xmat[i]))
            for i in range(model.nbody)
        ]
        sites = [
            named(model, mujoco.mjtObj.mjOBJ_SITE, i, (data.site_xpos[i], data.site_xmat[i]))
            for i in range(model.nsite)
        ]
        configurations.append({"q": q.tolist(), "bodies": bodies, "sites": sites})
    data.qpos[:] = model.qpos0
    mujoco.mj_kinematics(model, data)
    joints = [
        {
            "name": mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, i),
            "type": ["free", "ball", "slide", "hinge"][model.jnt_type[i]],
            "address": int(model.jnt_qposadr[i]),
            "range": model.jnt_range[i].tolist() if model.jnt_limited[i] else None,
        }
        for i in range(model.njnt)
    ]
    # Connect: the anchor in either body. Weld: the anchor in the second body, and its pose in the first.
    loops = [
        {
            "weld": bool(model.eq_type[i] == mujoco.mjtEq.mjEQ_WELD),
            "sites": bool(model.eq_objtype[i] == mujoco.mjtObj.mjOBJ_SITE),
            "data": model.eq_data[i][:10].tolist(),
        }
        for i in range(model.neq)
        if model.eq_type[i] != mujoco.mjtEq.mjEQ_JOINT and model.eq_active0[i]
    ]
    inertials = [
        {
            "mass": float(model.body_mass[i]),
            "centre": model.body_ipos[i].tolist(),
            # The trace and the determinant are the same in any axes, principal or not.
            "moments": model.body_inertia[i].tolist(),
        }
        for i in range(model.nbody)
    ]
    return {
        "file": path.name,
        "joints": joints,
        "configurations": configurations,
        "loops": loops,
        "inertials": inertials,
    }


random = np.random.default_rng(13)
files = [of_file(FILES / name, random) for name in ("walker.xml", "gripper.xml")]
print(json.dumps({"mujoco": mujoco.__version__, "files": files}))
