// Support of a standing body: corners of its soles, support polygon and centre of mass, seen from above.
import { ForwardKinematics } from "kinopt";

export class Support {
    /**
     * `soles` are the contact points of the feet by frame, in the frame's coordinates, and `masses` those of tasks.
     */
    constructor(model, soles, masses) {
        this.soles = soles;
        this.feet = Object.keys(soles);
        this.masses = masses;
        this.kinematics = new ForwardKinematics(model, [...this.feet, ...Object.keys(masses)]);
    }

    /** Centre of mass `[x, y]`, and corners of the soles by foot, at a configuration. */
    at(q) {
        const placements = this.kinematics.place(q);
        const corners = {};
        this.feet.forEach((foot, k) => (corners[foot] = this.soles[foot].map((point) => moved(placements, k, point))));
        let [x, y, total] = [0, 0, 0];
        Object.values(this.masses).forEach(([mass, ...centre], k) => {
            const at = moved(placements, this.feet.length + k, centre);
            [x, y, total] = [x + mass * at[0], y + mass * at[1], total + mass];
        });
        return { centre: [x / total, y / total], corners };
    }
}

/** A point in the coordinates of the frame with index `k`, in the world. */
function moved(placements, k, [x, y, z]) {
    const m = placements.subarray(16 * k, 16 * k + 16);
    return [0, 1, 2].map((row) => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row]);
}

const turn = ([ax, ay], [bx, by], [cx, cy]) => (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);

/** Convex hull of points seen from above, counter-clockwise, by Andrew's monotone chain. */
export function hull(points) {
    const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    const chain = (list) => {
        const side = [];
        for (const point of list) {
            while (side.length > 1 && turn(side.at(-2), side.at(-1), point) <= 0) side.pop();
            side.push(point);
        }
        return side.slice(0, -1);
    };
    return [...chain(sorted), ...chain(sorted.reverse())];
}

/** True if a point is inside a counter-clockwise hull. */
export const contains = (polygon, point) => polygon.every((corner, k) => turn(corner, polygon[(k + 1) % polygon.length], point) >= 0);

/** Mean of points, seen from above. */
export const middle = (points) => [0, 1].map((axis) => points.reduce((sum, point) => sum + point[axis], 0) / points.length);
