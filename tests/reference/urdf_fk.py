"""Writes urdf_fk.json: where Pinocchio puts the links of the URDF files of this repository.

Run from the repository's root: `pip install pin==4.1.0 numpy`, then `python tests/reference/urdf_fk.py`.
"""

import datetime
import json
import xml.etree.ElementTree as xml

import numpy as np
import pinocchio as pin

SEED = 20261121
CONFIGURATIONS = 3
FILES = [
    "models/adept_cobra_s600.urdf",
    "models/aldebaran_nao.urdf",
    "models/franka_panda.urdf",
    "models/kuka_iiwa14.urdf",
    "models/rethink_baxter.urdf",
    "models/universal_ur10e.urdf",
    "models/universal_ur5e.urdf",
    "tests/reference/oblique.urdf",
]


def configuration(model, names, mimics, rng):
    """Random values by joint name within the limits, followers set by hand."""
    values = {}
    for name in names:
        joint = model.joints[model.getJointId(name)]
        if joint.shortname() == "JointModelMimic":
            continue
        if joint.nq == 2:  # continuous: cosine and sine
            values[name] = rng.uniform(-4.0, 4.0)
        else:
            low, high = model.lowerPositionLimit[joint.idx_q], model.upperPositionLimit[joint.idx_q]
            values[name] = rng.uniform(low, high)
    for name, (master, ratio, offset) in mimics.items():
        values[name] = ratio * values[master] + offset
    return values


def place(model, values):
    q = pin.neutral(model)
    for name, value in values.items():
        joint = model.joints[model.getJointId(name)]
        if joint.shortname() == "JointModelMimic":
            continue
        q[joint.idx_q : joint.idx_q + joint.nq] = (
            [np.cos(value), np.sin(value)] if joint.nq == 2 else [value]
        )
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    links = {}
    for index, frame in enumerate(model.frames):
        if frame.type == pin.FrameType.BODY:
            at = data.oMf[index]
            x, y, z, w = pin.Quaternion(at.rotation).coeffs()
            links[frame.name] = [float(v) for v in (*at.translation, w, x, y, z)]
    return links


def main():
    rng = np.random.default_rng(SEED)
    robots = []
    for file in FILES:
        model = pin.buildModelFromUrdf(file, mimic=True)
        joints = xml.parse(file).getroot().findall("joint")
        moving = [j.get("name") for j in joints if j.get("type") != "fixed"]
        mimics = {
            j.get("name"): (m.get("joint"), float(m.get("multiplier", 1)), float(m.get("offset", 0)))
            for j in joints
            if (m := j.find("mimic")) is not None
        }
        cases = []
        for _ in range(CONFIGURATIONS):
            values = configuration(model, moving, mimics, rng)
            # The order of the file, as our configurations have it.
            cases.append({"q": [values[name] for name in moving], "links": place(model, values)})
        robots.append({"file": file, "joints": moving, "cases": cases})
    provenance = {
        "tool": "Pinocchio (PyPI package pin)",
        "version": pin.__version__,
        "date": datetime.date.today().isoformat(),
        "seed": SEED,
        "script": "tests/reference/urdf_fk.py",
        "units": "q in radians and metres; links as x, y, z in metres and quaternion w, x, y, z, root link at the origin",
    }
    with open("tests/reference/urdf_fk.json", "w") as out:
        json.dump({"provenance": provenance, "robots": robots}, out, indent=None, separators=(",", ":"))
        out.write("\n")


main()
