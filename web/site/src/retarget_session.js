// A subject's motion on a robot: online, frame by frame, or solved as a whole before.
import { ForwardKinematics, retarget, RetargetFollower } from "kinopt";
import { shapesOf } from "./robot_shapes.js";

/** Frames per second. */
const FPS = 30;
/** Largest number of frames that one request processes; earlier ones are skipped. */
const MAX_CATCH_UP_FRAMES = 15;
/** Height of a subject, metres, and the speed below which its feet are in contact, m/s. */
const [REFERENCE_HEIGHT, CONTACT_SPEED] = [1.75, 0.25];

export class RetargetSession {
    constructor(robot, names, capture) {
        this.drawn = shapesOf(robot, names);
        this.robot = robot;
        this.capture = capture;
        this.clip = capture.clip;
        this.frames = Math.floor(this.clip.duration * FPS + 0.5) + 1;
        this.kinematics = new ForwardKinematics(robot.model);
        const { stride, up } = new RetargetFollower(robot, this.clip, undefined, { fps: FPS });
        const heights = this.#jointPositions(0).filter((_, k) => k % 3 === (up === "y" ? 1 : 2));
        /** Height of the subject at the robot's scale, metres; the feet of a small robot are slower while walking. */
        const tall = stride * (Math.max(...heights) - Math.min(...heights));
        this.options = { fps: FPS, contactSpeed: (CONTACT_SPEED * tall) / REFERENCE_HEIGHT };
        this.follower = new RetargetFollower(robot, this.clip, undefined, this.options);
        /** Offset of the drawn subject, next to the robot and at the robot's scale. */
        this.aside = -tall;
        this.#step(0);
    }

    describe() {
        const { notes } = this.follower;
        return {
            kind: "movement",
            up: "z",
            distanceFactor: 1.6,
            from: [0.1, -1, 0.18],
            handles: [],
            pins: [],
            boxes: [],
            shapes: this.drawn.shapes,
            sticks: this.drawn.sticks,
            gaps: this.drawn.gaps,
            parents: this.capture.armature.parents,
            seconds: this.clip.duration,
            notes: [...this.robot.repairs, ...this.drawn.notes, ...this.capture.notes, ...notes],
        };
    }

    /** Advances to a time, through every frame, as from a live source. */
    play({ seconds }) {
        const frame = Math.min(Math.floor(seconds * FPS), this.frames - 1);
        const begun = performance.now();
        const ahead = (frame - this.frame + this.frames) % this.frames;
        const steps = this.movement ? Math.min(ahead, 1) : Math.min(ahead, MAX_CATCH_UP_FRAMES);
        for (let left = steps - 1; left >= 0; left -= 1) this.#step((frame - left + this.frames) % this.frames);
        const solved = performance.now() - begun;
        return { ...this.show(), solved, steps, reached: true, limits: [], words: "" };
    }

    #jointPositions(frame) {
        return this.capture.armature.places(this.clip.sample(this.clip.start + frame / FPS, "hold"));
    }

    #step(frame) {
        this.frame = frame;
        this.person = this.#jointPositions(frame);
        const { movement } = this;
        const width = this.robot.model.configurationLen;
        this.q = movement ? movement.subarray(frame * width, (frame + 1) * width) : this.follower.step(this.person);
    }

    /** Uses a motion that was solved as a whole, or the online retargeter without one. */
    follow({ movement }) {
        this.movement = movement;
        this.#step(this.frame);
        return this.show();
    }

    /** Solves the whole motion; `tell` receives the number of finished frames. */
    whole(report) {
        const options = { ...this.options, whole: true, progress: (done, total) => report({ done, total }) };
        const retargeted = retarget(this.robot, this.clip, undefined, options);
        const { limbs, slip } = retargeted.report;
        const means = Object.values(limbs).map(({ mean }) => mean);
        const meanAngle = means.reduce((sum, mean) => sum + mean, 0) / Math.max(means.length, 1);
        return { movement: retargeted.q.slice(), meanAngle, slip };
    }

    rest() {
        return this.show();
    }

    skin() {
        return this.show();
    }

    show() {
        const links = Float32Array.from(this.kinematics.place(this.q));
        const { stride, up } = this.follower;
        const person = new Float32Array(this.person.length);
        for (let k = 0; k < person.length; k += 3) {
            const [x, y, z] = this.person.subarray(k, k + 3);
            const [across, high] = up === "y" ? [-z, y] : [y, z];
            person.set([stride * x + this.aside, stride * across, stride * high], k);
        }
        const [x, y] = this.q;
        return { links, person, places: new Float32Array(), ground: [x + 0.5 * this.aside, y], posed: 0 };
    }
}
