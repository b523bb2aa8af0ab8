// The drags of `posing.py` by CCDIKSolver of three.js: one chain of two bones for each hand and foot.
//
//     npm install three
//     node benches/rivals/python/posing_three.mjs CHARACTER.glb DRAGS.json OUT.json
//
// DRAGS.json is written by `posing.py --json`. OUT.json has the positions and the local rotations of all bones for each
// drag. A drag of another bone than a hand or a foot moves the hips and lets the feet stay.

import { readFileSync, writeFileSync } from "node:fs";
import { basename } from "node:path";
import { Bone, Skeleton, SkinnedMesh, Vector3 } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { CCDIKSolver } from "three/addons/animation/CCDIKSolver.js";

const ITERATIONS = 100;

const [file, drags, out] = process.argv.slice(2);
globalThis.self ??= globalThis;
const bytes = readFileSync(file);
const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
const { scene } = await new GLTFLoader().parseAsync(buffer, "");
const report = JSON.parse(readFileSync(drags))[basename(file)];

// GLTFLoader removes characters that its property paths do not allow, such as ":".
const key = (name) => name.replace(/[\s[\].:/]/g, (letter) => (/\s/.test(letter) ? "_" : ""));
const all = [];
scene.traverse((thing) => thing.isBone && all.push(thing));
const named = (name) => all.find((bone) => bone.name === key(name));
const rest = all.map((bone) => ({ bone, q: bone.quaternion.clone(), p: bone.position.clone() }));

const limbs = [...report.legs, ...report.arms];
const goals = limbs.map(() => new Bone());
const bones = [...all, ...goals];
goals.forEach((goal) => scene.add(goal));
const mesh = new SkinnedMesh();
mesh.bind(new Skeleton(bones));
const index = (name) => bones.indexOf(named(name));
const chains = limbs.map(([upper, lower, end], k) => ({
    target: bones.indexOf(goals[k]),
    effector: index(end),
    links: [{ index: index(lower) }, { index: index(upper) }],
    iteration: ITERATIONS,
}));
const solver = new CCDIKSolver(mesh, chains);

const results = report.rows.map((row) => {
    rest.forEach(({ bone, q, p }) => {
        bone.quaternion.copy(q);
        bone.position.copy(p);
    });
    scene.updateMatrixWorld(true);
    const at = (name) => named(name).getWorldPosition(new Vector3());
    limbs.forEach(([, , end], k) => goals[k].position.copy(at(end)));
    const target = new Vector3(...row.target);
    const dragged = limbs.findIndex(([, , end]) => end === row.bone);
    if (dragged >= 0) {
        goals[dragged].position.copy(target);
    } else if (row.bone === report.hips) {
        const hips = named(report.hips);
        hips.position.copy(hips.parent.worldToLocal(target.clone()));
    }
    scene.updateMatrixWorld(true);
    solver.update();
    scene.updateMatrixWorld(true);
    const positions = {};
    const rotations = {};
    for (const name of report.names) {
        const bone = named(name);
        if (!bone) continue;
        positions[name] = bone.getWorldPosition(new Vector3()).toArray();
        rotations[name] = { rotation: bone.quaternion.toArray(), translation: bone.position.toArray() };
    }
    return { bone: row.bone, positions, rotations };
});
writeFileSync(out, JSON.stringify(results));
