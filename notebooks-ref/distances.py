"""Writes tests/reference/distances.json: distances of convex shapes by coal.

The shapes are spheres, capsules, cylinders, boxes and hulls of points. Some hulls are as flat as a tenth of a
millimetre. Shapes have random positions, equal positions, or equal axes.

coal runs with tight tolerances. A distance counts if it is certified: support functions written here give an
equal gap between both shapes along coal's direction, and no other tested direction has a wider gap.
`notebooks-ref/run` runs this script.
"""

import importlib.metadata

import coal
import numpy as np
from scipy.spatial.transform import Rotation

import fixtures

SEED = 20261123
PAIRS = 400
# Largest difference between the gap along coal's direction and coal's distance, metres.
CERTIFIED = 1e-11
OTHERS = 1000


def length(rng):
    return rng.uniform(1e-4, 1e-3) if rng.integers(10) == 0 else rng.uniform(0.05, 1.0)


def sphere(rng):
    radius = length(rng)
    return {"sphere": [radius]}, coal.Sphere(radius), lambda u: radius


def capsule(rng):
    radius, along = length(rng), length(rng)
    return {"capsule": [radius, along]}, coal.Capsule(radius, along), lambda u: radius + 0.5 * along * abs(u[2])


def cylinder(rng):
    radius, along = length(rng), length(rng)
    reach = lambda u: radius * np.hypot(u[0], u[1]) + 0.5 * along * abs(u[2])
    return {"cylinder": [radius, along]}, coal.Cylinder(radius, along), reach


def box(rng):
    size = np.array([length(rng) for _ in range(3)])
    return {"box": size.tolist()}, coal.Box(*size), lambda u: 0.5 * np.abs(u) @ size


def convex(rng):
    points = rng.uniform(-0.6, 0.6, (rng.integers(4, 16), 3))
    corners = coal.StdVec_Vec3s()
    for point in points:
        corners.append(point)
    return {"convex": points.tolist()}, coal.Convex.convexHull(corners, True, "Qt"), lambda u: (points @ u).max()


KINDS = [sphere, capsule, cylinder, box, convex]


def placed(rng, size):
    return Rotation.random(random_state=rng).as_matrix(), rng.uniform(-size, size, 3)


def pair(rng, index):
    shapes = [KINDS[kind](rng) for kind in rng.integers(len(KINDS), size=2)]
    first = placed(rng, 1.0)
    second = {0: first, 1: (first[0], first[1] + 0.3 * first[0][:, 0]), 2: (first[0], first[1] + 1.2 * first[0][:, 2]),
              3: (np.eye(3), first[1])}.get(index % 8) or placed(rng, 1.5)
    return shapes, (first, second)


def main():
    rng = np.random.default_rng(SEED)
    request = coal.DistanceRequest()
    request.enable_signed_distance = True
    request.gjk_tolerance = request.epa_tolerance = 1e-14
    request.gjk_max_iterations = request.epa_max_iterations = 1000
    found, left_out = [], 0
    for index in range(PAIRS):
        shapes, places = pair(rng, index)
        result = coal.DistanceResult()
        transforms = [coal.Transform3s(*place) for place in places]
        distance = coal.distance(shapes[0][1], transforms[0], shapes[1][1], transforms[1], request, result)
        gap = lambda u: -sum(shape[2](place[0].T @ (sign * u)) + sign * u @ place[1]
                             for shape, place, sign in zip(shapes, places, (1, -1)))
        # A wider gap along any other direction contradicts coal's distance.
        axes = np.concatenate([place[0].T for place in places])
        others = [*axes, *-axes, *Rotation.random(OTHERS, random_state=rng).as_matrix()[:, 0]]
        normal = np.array(result.normal)
        certified = abs(np.linalg.norm(normal) - 1) < 1e-12 and abs(gap(normal) - distance) < CERTIFIED
        if not certified or max(map(gap, others)) > distance + CERTIFIED:
            left_out += 1
            continue
        found.append({"shapes": [shape[0] for shape in shapes],
                      "rotations": [place[0].ravel().tolist() for place in places],
                      "translations": [place[1].tolist() for place in places],
                      "distance": distance})
    fixtures.write("distances.json", "coal", importlib.metadata.version("coal"), SEED, "distances.py", "metres",
                   left_out=left_out, pairs=found)


if __name__ == "__main__":
    main()
