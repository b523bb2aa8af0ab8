"""Compares kinopt's distances and gradients with coal's on many random pairs: ``python many_distances.py [PAIRS]``.

The pairs are those of distances.py, and triangles, including needles. Of every eight pairs one has equal
positions, one nearly touches or overlaps along an axis, and one has equal axes. The environment needs kinopt's
wheel and coal.

The comparison covers three values:

- The distance.
- The gap between both shapes along the reported direction, by support functions written here. It equals the
  distance only for a correct gradient.
- The distance of the reported points along that direction.

If coal's distance differs from the gap along its own direction, it is counted separately. The reference is then
the gap along kinopt's direction.
"""

import sys

import coal
import kinopt
import numpy as np

import distances

ENOUGH = 1e-9


def triangle(rng):
    points = rng.uniform(-0.6, 0.6, (3, 3))
    if rng.integers(3) == 0:
        points[2] = points[0] + rng.uniform(0.0, 1.0) * (points[1] - points[0]) + rng.uniform(-1e-4, 1e-4, 3)
    corners, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for point in points:
        corners.append(point)
    for face in ((0, 1, 2), (0, 2, 1)):
        faces.append(coal.Triangle(*face))
    return {"triangle": points}, coal.Convex(corners, faces), lambda u: (points @ u).max()


ADDERS = {
    "sphere": lambda world, name, told, at: world.add_sphere(name, *told, at),
    "capsule": lambda world, name, told, at: world.add_capsule(name, *told, at),
    "cylinder": lambda world, name, told, at: world.add_cylinder(name, *told, at),
    "box": lambda world, name, told, at: world.add_box(name, told, at),
    "convex": lambda world, name, told, at: world.add_convex(name, told, at),
    "triangle": lambda world, name, told, at: world.add_mesh(name, told, [[0, 1, 2]], at),
}


def homogeneous(place):
    at = np.eye(4)
    at[:3, :3], at[:3, 3] = place
    return at


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
    distances.KINDS.append(triangle)
    rng = np.random.default_rng(14)
    request = coal.DistanceRequest()
    request.enable_signed_distance = True
    request.gjk_tolerance = request.epa_tolerance = 1e-14
    request.gjk_max_iterations = request.epa_max_iterations = 1000
    worst = {"distance": 0.0, "gap along the direction": 0.0, "points": 0.0, "direction": 0.0}
    uncertified = apart = deep = wrong = 0
    for index in range(count):
        shapes, places = distances.pair(rng, index)
        result = coal.DistanceResult()
        transforms = [coal.Transform3s(*place) for place in places]
        theirs = coal.distance(shapes[0][1], transforms[0], shapes[1][1], transforms[1], request, result)
        gap = lambda u: -sum(shape[2](place[0].T @ (sign * u)) + sign * u @ place[1]
                             for shape, place, sign in zip(shapes, places, (1, -1)))
        world = kinopt.World()
        for name, shape, place in zip("ab", shapes, places):
            (kind, told), = shape[0].items()
            ADDERS[kind](world, name, told, homogeneous(place))
        ours = world.separation("a", "b")
        # Direction from the first to the second shape, as in coal.
        normal = np.asarray(ours.normal)
        other = np.array(result.normal)
        sound = abs(np.linalg.norm(other) - 1) < 1e-9 and abs(gap(other) - theirs) < ENOUGH
        uncertified += not sound
        # The penetration depth is the shorter of two separations.
        truth = max(theirs, gap(normal)) if sound else gap(normal)
        off = {"distance": abs(ours.distance - truth), "gap along the direction": abs(gap(normal) - ours.distance),
               "points": abs((np.asarray(ours.on_second) - np.asarray(ours.on_first)) @ normal - ours.distance)}
        apart += ours.distance > 0
        deep += ours.distance < 0
        if sound and ours.distance > 1e-3:
            off["direction"] = np.linalg.norm(normal - other)
        if max(off["distance"], off["gap along the direction"], off["points"]) > ENOUGH:
            wrong += 1
            if wrong < 10:
                print(index, [next(iter(shape[0])) for shape in shapes], theirs, ours.distance, off)
        for what, value in off.items():
            worst[what] = max(worst[what], value)
    print(f"{count} pairs, {apart} apart, {deep} deep; {uncertified} where coal's direction does not bear its distance out; "
          f"{wrong} of ours are more than {ENOUGH} off")
    print(worst)


if __name__ == "__main__":
    main()
