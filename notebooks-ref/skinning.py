"""Writes tests/reference/skinning.json: skinned vertices of the shipped rigs, by NumPy and SciPy.

All values are computed from the rigs' files in double precision, without kinopt. `notebooks-ref/run` runs this
script.
"""

import json

import numpy as np
import scipy
from scipy.spatial.transform import Rotation

import fixtures
from models import FILES, REPOSITORY

SEED = 20261121
POSES = 3
VERTICES = 120
RIGS = [FILES["humanoid"], FILES["robot-arm"]]


def read_vertices(path):
    """Positions of a binary PLY with three floats per vertex."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode().splitlines()
    assert "format binary_little_endian 1.0" in header, path
    start = next(k for k, line in enumerate(header) if line.startswith("element vertex"))
    assert header[start + 1 : start + 4] == [f"property float {axis}" for axis in "xyz"], path
    assert header[start + 4].startswith("element face"), path
    count = int(header[start].split()[2])
    return np.frombuffer(data, "<f4", 3 * count, end).reshape(count, 3).astype(float)


def read_weights(path):
    """A vertices × columns table of a binary DMAT, which is stored by columns."""
    first, second, values = path.read_bytes().split(b"\n", 2)
    assert first.split() == [b"0", b"0"], path
    columns, rows = map(int, second.split())
    return np.frombuffer(values, "<f8", columns * rows).reshape(columns, rows).T


def transforms(bones, q):
    """T_i = T_parent T̂_i R_x(θ₃) R_z(θ₂) R_x(θ₁) T̂_i⁻¹ (rest → posed), 4 × 4 each."""
    out = []
    for bone, (first, bend, second) in zip(bones, q):
        turn = np.eye(4)
        # Upper case selects moving axes, so the second twist comes first.
        turn[:3, :3] = Rotation.from_euler("XZX", [second, bend, first]).as_matrix()
        rest = np.array(bone["rest_T"])
        parent = np.eye(4) if bone["parent_id"] < 0 else out[bone["parent_id"]]
        out.append(parent @ rest @ turn @ np.linalg.inv(rest))
    return np.array(out)


def linear_blend(vertices, weights, matrices):
    blended = np.einsum("vb,bij->vij", weights, matrices)
    homogeneous = np.column_stack([vertices, np.ones(len(vertices))])
    return np.einsum("vij,vj->vi", blended, homogeneous)[:, :3]


def product(a, b):
    """Hamilton product of quaternions w, x, y, z, row by row."""
    w, v = a[..., :1], a[..., 1:]
    s, u = b[..., :1], b[..., 1:]
    real = w * s - np.sum(v * u, axis=-1, keepdims=True)
    return np.concatenate([real, w * u + s * v + np.cross(v, u)], axis=-1)


def dual_quaternions(vertices, weights, matrices):
    """q̂ = Σ ±w q̂_j / ‖Σ ±w r_j‖, then p' = r p r* + 2 d r*."""
    real = Rotation.from_matrix(matrices[:, :3, :3]).as_quat(scalar_first=True)
    shift = np.column_stack([np.zeros(len(matrices)), matrices[:, :3, 3]])
    dual = 0.5 * product(shift, real)
    pivots = real[np.argmax(weights, axis=1)]
    signed = np.where(pivots @ real.T < 0, -weights, weights)
    real, dual = signed @ real, signed @ dual
    norm = np.linalg.norm(real, axis=1, keepdims=True)
    real, dual = real / norm, dual / norm
    conjugate = real * [1, -1, -1, -1]
    points = np.column_stack([np.zeros(len(vertices)), vertices])
    # The dual component along the real one is no motion; it vanishes with the real component.
    moved = product(product(real, points), conjugate) + 2 * product(dual, conjugate)
    return moved[:, 1:]


def rig(path, rng):
    folder = (REPOSITORY / path).parent
    document = json.loads((REPOSITORY / path).read_text())
    bones = document["bones"]
    vertices = read_vertices(folder / document["model"]["file"])
    table = read_weights(folder / document["weights"]["file"])
    weights = np.zeros((len(vertices), len(bones)))
    for index, bone in enumerate(bones):
        if bone["weight_id"] >= 0:
            weights[:, index] = table[:, bone["weight_id"]]
    # Half of the vertices are those with the most influences, half are random.
    crowded = np.argsort(-np.count_nonzero(weights, axis=1), kind="stable")[: VERTICES // 2]
    anywhere = rng.choice(len(vertices), VERTICES // 2, replace=False)
    chosen = np.unique(np.concatenate([crowded, anywhere]))
    low = np.radians(np.clip([bone["xzx_min"] for bone in bones], -180, 180))
    high = np.radians(np.clip([bone["xzx_max"] for bone in bones], -180, 180))
    poses = []
    for _ in range(POSES):
        q = rng.uniform(low, high)
        matrices = transforms(bones, q)
        pose = {"q": q.ravel().tolist()}
        for name, skin in [("lbs", linear_blend), ("dqs", dual_quaternions)]:
            posed = skin(vertices, weights, matrices)
            pose[name] = {
                "positions": posed[chosen].round(9).ravel().tolist(),
                "centroid": posed.mean(axis=0).tolist(),
                "spread": float(np.sqrt(np.mean(np.sum((posed - posed.mean(axis=0)) ** 2, axis=1)))),
            }
        poses.append(pose)
    return {"file": path, "vertices": chosen.tolist(), "poses": poses}


def main():
    rng = np.random.default_rng(SEED)
    fixtures.write(
        "skinning.json", "NumPy and SciPy (scipy.spatial.transform.Rotation)",
        f"numpy {np.__version__}, scipy {scipy.__version__}", SEED, "skinning.py",
        "q in radians, three a bone; positions x, y, z in the rig's unit, to nine decimals, for "
        "the vertices listed; centroid and spread (root mean square distance from it) of all vertices",
        rigs=[rig(path, rng) for path in RIGS])


if __name__ == "__main__":
    main()
