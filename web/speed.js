// Timings of the package in Node for the queries that `benches/src/bin/web_questions.rs` times natively; `web/speed`
// prints both.
import { Drag, Problem } from "kinopt";
import { humanoid, pinned } from "./tests/humanoid.js";
import { configuration, pandaArm, random } from "./tests/panda.js";

/** Rounds of each query; the fastest counts. */
const ROUNDS = 6;
const POSES = 2000;
const FRAMES = 300;

/** Microseconds of the fastest round by query; `ask` frees its result. */
function fastest(count, begin, ask) {
    const best = new Float64Array(count).fill(Infinity);
    for (let round = 0; round < ROUNDS; round += 1) {
        const state = begin();
        for (let k = 0; k < count; k += 1) {
            const given = ask.given?.(k);
            const begun = process.hrtime.bigint();
            const answer = ask.solve(state, k, given);
            best[k] = Math.min(best[k], Number(process.hrtime.bigint() - begun) / 1e3);
            ask.ended?.(answer);
        }
    }
    return best.sort();
}

function print(name, best) {
    const mean = best.reduce((sum, value) => sum + value) / best.length;
    console.log([name, best[best.length >> 1], mean, best[Math.floor(0.99 * best.length)]].join("\t"));
}

for (const search of ["first", "start"]) {
    const arm = pandaArm({ search });
    const draw = random(1);
    const goals = Array.from({ length: POSES }, () => arm.baseFromTool(configuration(arm, draw)));
    const starts = Array.from({ length: POSES }, () => configuration(arm, draw));
    let reached = 0;
    const best = fastest(POSES, () => arm, {
        solve: (own, k) => own.solve(goals[k], starts[k]),
        ended(solution) {
            reached += solution.reached;
            solution.free();
        },
    });
    print(`a Panda's pose, ${search} (${reached} of ${ROUNDS * POSES} reached)`, best);
}

const rig = humanoid();
const rest = rig.model.neutral();
const pins = pinned(rig, rest);
const from = pins.find(({ name }) => name === "left_hand").target;
print("a frame of the humanoid's drag", fastest(FRAMES, () => new Drag(new Problem(rig.model, pins), rest), {
    given(frame) {
        const turn = (2 * Math.PI * frame) / FRAMES;
        const down = 1 - Math.cos(turn);
        return { left_hand: [from[0] + 0.1 * Math.sin(turn), from[1] - 0.15 * down, from[2] - 0.1 * down] };
    },
    solve: (drag, _frame, targets) => drag.advance(targets),
    ended: (solution) => solution.free(),
}));
for (const [name, method] of [["linear", "lbs"], ["dual quaternions", "dqs"]]) {
    print(`its skin, ${name}`, fastest(FRAMES, () => rig.posing(method), { solve: (skin) => skin.deform(rest) }));
}
