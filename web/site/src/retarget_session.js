// A person's movement on a robot: live, frame after frame as it plays, or as a whole that was solved before.
import { ForwardKinematics, retarget, RetargetFollower } from "kinopt";
import { shapesOf } from "./robot_shapes.js";

/** Frames a second. */
const FPS = 30;
/** Frames that one answer catches up with at most; what is missed beyond is left out. */
const BEHIND = 15;
/** A foot of a person of this height, metres, stands where it is slower than this, m/s. */
const [TALL, STANDS] = [1.75, 0.25];

export class RetargetSession {
    constructor(robot, names, capture) {
        this.drawn = shapesOf(robot, names);
        this.robot = robot;
        this.capture = capture;
        this.clip = capture.clip;
        this.frames = Math.floor(this.clip.duration * FPS + 0.5) + 1;
        this.kinematics = new ForwardKinematics(robot.model);
        const { stride, up } = new RetargetFollower(robot, this.clip, undefined, { fps: FPS });
        const heights = this.#places(0).filter((_, k) => k % 3 === (up === "y" ? 1 : 2));
        /** How tall the person is in the robot's steps, metres; a small robot's feet are slower when they still walk. */
        const tall = stride * (Math.max(...heights) - Math.min(...heights));
        this.options = { fps: FPS, contactSpeed: (STANDS * tall) / TALL };
        this.follower = new RetargetFollower(robot, this.clip, undefined, this.options);
        /** Where the person is drawn: beside the robot, as large as its steps are. */
        this.aside = -tall;
        this.#step(0);
    }

    describe() {
        const { notes } = this.follower;
        return {
            kind: "movement",
            up: "z",
            room: 1.6,
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

    /** Follows to a time: every frame on the way, as a live source would bring them. */
    play({ seconds }) {
        const frame = Math.min(Math.floor(seconds * FPS), this.frames - 1);
        const begun = performance.now();
        const ahead = (frame - this.frame + this.frames) % this.frames;
        const steps = this.movement ? Math.min(ahead, 1) : Math.min(ahead, BEHIND);
        for (let left = steps - 1; left >= 0; left -= 1) this.#step((frame - left + this.frames) % this.frames);
        const solved = performance.now() - begun;
        return { ...this.show(), solved, steps, reached: true, limits: [], words: "" };
    }

    #places(frame) {
        return this.capture.armature.places(this.clip.sample(this.clip.start + frame / FPS, "hold"));
    }

    #step(frame) {
        this.frame = frame;
        this.person = this.#places(frame);
        const { movement } = this;
        const width = this.robot.model.configurationLen;
        this.q = movement ? movement.subarray(frame * width, (frame + 1) * width) : this.follower.step(this.person);
    }

    /** Goes by a movement that was solved as a whole, or live without one. */
    follow({ movement }) {
        this.movement = movement;
        this.#step(this.frame);
        return this.show();
    }

    /** Solves the whole movement; `tell` hears how many frames are done. */
    whole(tell) {
        const options = { ...this.options, whole: true, progress: (done, total) => tell({ done, total }) };
        const found = retarget(this.robot, this.clip, undefined, options);
        return { movement: found.q.slice(), meanError: found.meanError, slip: found.slip };
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
