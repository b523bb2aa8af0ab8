// The Panda of the project's models, and reachable poses.
import { readFileSync } from "node:fs";
import { Arm, Robot } from "kinopt";

export const model = (file) => new URL(`../../models/${file}`, import.meta.url);
export const text = (file) => readFileSync(model(file), "utf8");

export const panda = () => Robot.fromUrdf(text("franka_panda.urdf"), "franka_panda.urdf");
export const pandaArm = (options) => new Arm(panda(), "base", "flange", options);

/** Upper half of SplitMix64, from 0 to 1. */
export function random(seed) {
    let state = BigInt(seed);
    const whole = (value) => BigInt.asUintN(64, value);
    return () => {
        state = whole(state + 0x9e3779b97f4a7c15n);
        let z = whole((state ^ (state >> 30n)) * 0xbf58476d1ce4e5b9n);
        z = whole((z ^ (z >> 27n)) * 0x94d049bb133111ebn);
        return Number((z ^ (z >> 31n)) >> 11n) * 2 ** -53;
    };
}

export function configuration({ lower, upper }, draw) {
    return lower.map((low, k) => low + draw() * (upper[k] - low));
}
