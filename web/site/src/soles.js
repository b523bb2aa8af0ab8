// What a robot stands on: points of its feet, in each foot's own coordinates.
import * as THREE from "three";

/** The eight corners of a shape, in its own coordinates; of what is round only its middle, of a mesh none. */
function corners({ kind, size, radius, length }) {
    // Of a cylinder the square within its rim.
    const rim = radius / Math.SQRT2;
    const half = { box: () => size.map((side) => 0.5 * side), cylinder: () => [rim, rim, 0.5 * length] }[kind]?.();
    if (!half) return kind === "mesh" ? [] : [new THREE.Vector3()];
    const signs = [-1, 1];
    return signs.flatMap((x) => signs.flatMap((y) => signs.map((z) => new THREE.Vector3(x * half[0], y * half[1], z * half[2]))));
}

/** Points by foot: where the links begin that are fixed to it, and the corners of what they bump into things with. */
export function soles(robot, limbs) {
    const names = robot.model.frameNames;
    const at = new Map(names.map((name, k) => [name, new THREE.Matrix4().fromArray(limbs.places, 16 * k)]));
    const points = limbs.feet.map((foot) => {
        const own = limbs.chain(foot).join();
        const fixed = names.filter((name) => limbs.chain(name).join() === own);
        const footFromWorld = at.get(foot).clone().invert();
        const found = fixed.flatMap((name) => {
            const footFromLink = footFromWorld.clone().multiply(at.get(name));
            const shapes = robot.shapes(name, true).flatMap((shape) => {
                const linkFromShape = new THREE.Matrix4().fromArray(shape.linkFromShape);
                return corners(shape).map((corner) => corner.applyMatrix4(linkFromShape));
            });
            return [new THREE.Vector3(), ...shapes].map((point) => point.applyMatrix4(footFromLink).toArray());
        });
        return [foot, found];
    });
    return Object.fromEntries(points);
}
