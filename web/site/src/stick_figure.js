// A figure of sticks: one from each joint to its parent.
import * as THREE from "three";

export class StickFigure {
    constructor(parents, radius, material) {
        this.pairs = [...parents].flatMap((parent, bone) => (parent < 0 ? [] : [[parent, bone]]));
        this.radius = radius;
        this.sticks = new THREE.InstancedMesh(new THREE.CapsuleGeometry(1, 1, 4, 10), material, this.pairs.length);
        this.sticks.frustumCulled = false;
    }

    /** `places` has three numbers for each joint. */
    show(positions) {
        const [from, to, along, turned, matrix] = [...Array(3)].map(() => new THREE.Vector3()).concat(new THREE.Quaternion(), new THREE.Matrix4());
        const up = new THREE.Vector3(0, 1, 0);
        this.pairs.forEach(([parent, bone], k) => {
            from.fromArray(positions, 3 * parent);
            along.subVectors(to.fromArray(positions, 3 * bone), from);
            const length = along.length();
            turned.setFromUnitVectors(up, length > 0 ? along.divideScalar(length) : up);
            // The capsule has a length of three, with half a sphere at either end.
            matrix.compose(from.lerp(to, 0.5), turned, new THREE.Vector3(this.radius, (length + 2 * this.radius) / 3, this.radius));
            this.sticks.setMatrixAt(k, matrix);
        });
        this.sticks.instanceMatrix.needsUpdate = true;
    }
}
