// Materials and texture coordinates of a glTF file, by three.js; the library reads its geometry.
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { managerOf } from "./dropped_urls.js";
import { extension } from "./files.js";

const TRIANGLES = 4;

/** Materials of a scene with this number of vertices and corners; undefined if parts of the file cannot be matched. */
export async function sceneLook(files, vertices, corners) {
    const name = Object.keys(files).find((file) => ["glb", "gltf"].includes(extension(file)));
    if (!name) return undefined;
    const { manager, forget } = managerOf(files);
    try {
        const bytes = files[name];
        const data = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
        const { parser } = await new GLTFLoader(manager).parseAsync(data, "");
        return await look(parser, vertices, corners);
    } finally {
        forget();
    }
}

/** Nodes in the library's order of bones: parents before children, else as in the file. */
function order(nodes) {
    const below = new Set(nodes.flatMap(({ children = [] }) => children));
    const ready = nodes.map((_, index) => index).filter((index) => !below.has(index));
    const ordered = [];
    while (ready.length > 0) {
        ready.sort((a, b) => a - b);
        const index = ready.shift();
        ordered.push(nodes[index]);
        ready.push(...(nodes[index].children ?? []));
    }
    return ordered;
}

async function look(parser, vertices, corners) {
    const { nodes, meshes, accessors } = parser.json;
    const materials = new Map();
    const [uv, groups] = [new Float32Array(2 * vertices), []];
    let [vertex, corner] = [0, 0];
    for (const { mesh } of order(nodes)) {
        const blocks = new Set();
        for (const { attributes, indices, material, mode = TRIANGLES } of mesh === undefined ? [] : meshes[mesh].primitives) {
            if (mode !== TRIANGLES) return undefined;
            const count = accessors[attributes.POSITION].count;
            const cornerCount = indices === undefined ? count : accessors[indices].count;
            const materialKey = material ?? -1;
            if (!materials.has(materialKey)) {
                const loaded = await (materialKey < 0 ? undefined : parser.getDependency("material", materialKey));
                materials.set(materialKey, { loaded, index: materials.size });
            }
            groups.push({ start: corner, count: cornerCount, materialIndex: materials.get(materialKey).index });
            corner += cornerCount;
            // Parts of one mesh may share their vertices.
            const key = JSON.stringify(attributes);
            if (blocks.has(key)) continue;
            blocks.add(key);
            if (attributes.TEXCOORD_0 !== undefined) {
                const textureCoordinates = await parser.getDependency("accessor", attributes.TEXCOORD_0);
                for (let k = 0; k < count && vertex + k < vertices; k += 1) uv.set([textureCoordinates.getX(k), textureCoordinates.getY(k)], 2 * (vertex + k));
            }
            vertex += count;
        }
    }
    if (vertex !== vertices || corner !== corners) return undefined;
    return { uv, groups, materials: [...materials.values()].map(({ loaded }) => loaded) };
}
