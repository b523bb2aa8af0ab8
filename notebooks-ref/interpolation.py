"""Writes tests/reference/interpolation.json: interpolants of kinopt, computed by SciPy.

`notebooks-ref/run` runs this script.
"""

import numpy as np
import scipy
from scipy.interpolate import BPoly, CubicHermiteSpline
from scipy.spatial.transform import Rotation, RotationSpline, Slerp

import fixtures

SEED = 20261121
PROPER = ["XZX", "XYX", "YXY", "YZY", "ZXZ", "ZYZ"]
TAIT_BRYAN = ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"]
SHARES = np.array([0.0, 0.01, 0.1, 0.25, 0.5, 0.65, 0.9, 1.0])


def wxyz(rotation):
    return rotation.as_quat(scalar_first=True).tolist()


def slerp(rng):
    """Arcs of all lengths up to half a turn, at several fractions."""
    cases = []
    for angle in [0.0, 1e-7, 1e-4, 1e-2, 0.3, 1.0, 2.0, 3.0, 3.14]:
        axis = rng.normal(size=3)
        start = Rotation.random(rng=rng)
        end = start * Rotation.from_rotvec(angle * axis / np.linalg.norm(axis))
        between = Slerp([0.0, 1.0], Rotation.concatenate([start, end]))
        cases.append(
            {"from": wxyz(start), "to": wxyz(end), "shares": SHARES.tolist(), "at": wxyz(between(SHARES))}
        )
    return cases


def hermite(rng):
    """Hermite splines at uneven times, with given rates at the keys."""
    cases = []
    for keys in [2, 3, 7]:
        times = np.cumsum(rng.uniform(0.05, 1.5, size=keys)) - 1.0
        values, rates = rng.normal(size=(keys, 3)), rng.normal(size=(keys, 3))
        spline = CubicHermiteSpline(times, values, rates)
        at = np.sort(rng.uniform(times[0], times[-1], size=12))
        cases.append(
            {
                "times": times.tolist(),
                "values": values.tolist(),
                "rates": rates.tolist(),
                "at": at.tolist(),
                "position": spline(at).tolist(),
                "rate": spline(at, 1).tolist(),
            }
        )
    return cases


def bezier(rng):
    """Cubic Bézier curves in space."""
    cases = []
    for _ in range(4):
        points = rng.normal(size=(4, 3))
        curve = BPoly(points[:, None, :], [0.0, 1.0])
        cases.append(
            {
                "points": points.tolist(),
                "at": SHARES.tolist(),
                "position": curve(SHARES).tolist(),
                "tangent": curve(SHARES, 1).tolist(),
            }
        )
    return cases


def rotation_spline(rng):
    """SciPy's spline differs from kinopt's, but about one axis both are the scalar Hermite cubic."""
    cases = []
    for keys in [2, 3, 6]:
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        times = np.cumsum(rng.uniform(0.2, 1.0, size=keys))
        angles = np.cumsum(rng.uniform(-1.0, 1.0, size=keys))
        rotations = Rotation.from_rotvec(angles[:, None] * axis)
        spline = RotationSpline(times, rotations)
        # At the last key SciPy's derivative is that of the last segment's end.
        at = np.sort(rng.uniform(times[0], times[-1], size=10))
        cases.append(
            {
                "times": times.tolist(),
                "rotations": wxyz(rotations),
                "rates": spline(times, 1).tolist(),
                "at": at.tolist(),
                "rotation": wxyz(spline(at)),
            }
        )
    return cases


def euler(rng):
    """Rotations from angles of every order, and angles from rotations."""
    cases = []
    for order in PROPER + TAIT_BRYAN:
        low, high = (0.05, np.pi - 0.05) if order in PROPER else (-1.5, 1.5)
        for _ in range(6):
            angles = rng.uniform(-np.pi, np.pi, size=3)
            angles[1] = rng.uniform(low, high)
            rotation = Rotation.from_euler(order, angles)
            cases.append(
                {
                    "order": order.lower(),
                    "angles": rotation.as_euler(order).tolist(),
                    "quaternion": wxyz(rotation),
                    "matrix": rotation.as_matrix().tolist(),
                    "rotation_vector": rotation.as_rotvec().tolist(),
                }
            )
    return cases


def polar(rng):
    """Polar decompositions of matrices without reflection."""
    cases = []
    for _ in range(6):
        matrix = rng.normal(size=(3, 3))
        matrix *= np.sign(np.linalg.det(matrix))
        rotation, stretch = scipy.linalg.polar(matrix)
        cases.append({"matrix": matrix.tolist(), "rotation": rotation.tolist(), "stretch": stretch.tolist()})
    return cases


def main():
    rng = np.random.default_rng(SEED)
    fixtures.write(
        "interpolation.json", "SciPy", scipy.__version__, SEED, "interpolation.py",
        "radians; quaternions w, x, y, z; matrices by rows; rates per unit of time, angular ones in the rotating "
        "frame's axes",
        slerp=slerp(rng), hermite=hermite(rng), bezier=bezier(rng), rotation_spline=rotation_spline(rng),
        euler=euler(rng), polar=polar(rng))


if __name__ == "__main__":
    main()
