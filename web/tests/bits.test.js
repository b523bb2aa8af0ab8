// Double precision equals the native library's portable path bitwise: tests/golden/web.rs solves the same queries.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import { Drag, Problem } from "kinopt";
import { humanoid, pinned } from "./humanoid.js";
import { configuration, pandaArm, random } from "./panda.js";

const table = readFileSync(new URL("../../tests/golden/values/web.portable.tsv", import.meta.url), "utf8");
/** Hashes of the values of each field. */
const portable = new Map(table.split("\n").map((line) => line.split("\t")).map(([field, , hash]) => [field, hash]));

/** FNV-1a hash of the bits of numbers. */
function digest() {
    let value = 0xcbf29ce484222325n;
    return {
        doubles(numbers) {
            for (const byte of new Uint8Array(Float64Array.from(numbers).buffer)) {
                value = BigInt.asUintN(64, (value ^ BigInt(byte)) * 0x100000001b3n);
            }
        },
        text: () => value.toString(16).padStart(16, "0"),
    };
}

for (const search of ["first", "start"]) {
    test(`poses of the Panda, search ${search}`, () => {
        const arm = pandaArm({ search });
        const draw = random(11);
        const found = digest();
        for (let k = 0; k < 200; k += 1) {
            const target = arm.baseFromTool(configuration(arm, draw));
            found.doubles(arm.solve(target, configuration(arm, draw)).q);
        }
        assert.equal(found.text(), portable.get(`poses, ${search}`));
    });
}

test("a drag of the humanoid, out of reach at its end", () => {
    const rig = humanoid();
    const rest = rig.model.neutral();
    const pins = pinned(rig, rest);
    const from = pins.find(({ name }) => name === "left_hand").target;
    const drag = new Drag(new Problem(rig.model, pins), rest);
    const found = digest();
    for (let frame = 0; frame < 120; frame += 1) {
        const along = 0.01 * frame;
        const target = [from[0] - 0.25 * along, from[1] + 0.5 * along, from[2] + along];
        found.doubles(drag.advance({ left_hand: target }).q);
    }
    assert.equal(found.text(), portable.get("drag"));
});
