// Arms, robots and solutions in `console.log` of Node and in `JSON.stringify`.
import { Arm, Robot, Solution } from "./kinopt.js";

const INSPECT = Symbol.for("nodejs.util.inspect.custom");

/** Joints with units and limits; JSON has no infinity, so a missing limit is null. */
const jointsOf = (names, units, lower, upper) => names.map((name, k) => ({
    name,
    unit: units[k],
    lower: Number.isFinite(lower[k]) ? lower[k] : null,
    upper: Number.isFinite(upper[k]) ? upper[k] : null,
}));

/** One line for each joint: name, limits, unit. */
function table(joints) {
    const width = Math.max(...joints.map(({ name }) => name.length));
    const limits = ({ lower, upper }) => lower === null && upper === null
        ? "without limits"
        : `[${lower?.toFixed(3) ?? "-inf"}, ${upper?.toFixed(3) ?? "inf"}]`;
    return joints.map((joint) => `  ${joint.name.padEnd(width)}  ${limits(joint)} ${joint.unit}`.trimEnd());
}

const count = (number, word) => `${number} ${word}${number === 1 ? "" : "s"}`;

/** Adds both methods to a class: `toObject` has the fields of JSON, `toLines` the text of `console.log`. */
function describe(type, toObject, toLines) {
    const hidden = (value) => ({ value, configurable: true, writable: true });
    Object.defineProperties(type.prototype, {
        toJSON: hidden(function () {
            return toObject(this);
        }),
        [INSPECT]: hidden(function () {
            // An object that was freed has no content.
            return this.__wbg_ptr ? toLines(toObject(this)).join("\n") : `${type.name} (freed)`;
        }),
    });
}

describe(
    Arm,
    (arm) => ({
        robot: arm.robotName,
        base: arm.base ?? null,
        tip: arm.tip,
        joints: jointsOf(arm.jointNames, arm.jointUnits, arm.lower, arm.upper),
    }),
    ({ robot, base, tip, joints }) => [`Arm of ${robot} from ${base ?? "the world"} to ${tip}, ${count(joints.length, "joint")}`, ...table(joints)],
);

describe(
    Robot,
    (robot) => {
        const model = robot.model;
        const joints = jointsOf(model.coordinateNames, model.coordinateUnits, model.lower, model.upper);
        model.free();
        return { name: robot.name, joints };
    },
    ({ name, joints }) => [`Robot ${name}, ${count(joints.length, "coordinate")}`, ...table(joints)],
);

describe(
    Solution,
    (solution) => ({
        reached: solution.reached,
        positionError: solution.positionError ?? null,
        orientationError: solution.orientationError ?? null,
        q: Array.from(solution.q),
        activeLimits: solution.activeLimits,
        explanation: solution.explain(),
    }),
    ({ q, explanation }) => [`Solution: ${explanation}`, `  q: [${q.map((value) => value.toFixed(4)).join(", ")}]`],
);
