//! Look-up of start configurations for a goal.

use std::f64::consts::TAU;

use super::candidates::Candidates;
use super::table::{CellRow, PER_CELL};
use super::with_tool::TooledAtlas;
use crate::simd_ik::lane::LaneScalar;
use crate::simd_ik::links::Links;
use crate::simd_ik::trigonometry::{ROUNDER, rough_atan2};
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};

impl TooledAtlas {
    /// Writes the start configurations for a goal to `candidates`, best first. `candidates` must be empty.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn look_up<V: LaneScalar>(
        &self,
        links: &Links,
        goal_from_first: &Placement<f64>,
        candidates: &mut Candidates,
    ) {
        self.look_up_at::<V>(links, goal_from_first, [0; 4], candidates);
    }

    /// Writes the start configurations of the cell at an offset from the goal's cell, best first.
    ///
    /// `candidates` must be empty; it stays so if the table has no such cell.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn look_up_at<V: LaneScalar>(
        &self,
        links: &Links,
        goal_from_first: &Placement<f64>,
        cell_offset: [i8; 4],
        candidates: &mut Candidates,
    ) {
        let c = V::Four::constant;
        let atlas = &*self.atlas;
        let n = atlas.joints;
        let mut pose = goal_from_first.inverse();
        let Some(last) = links.links.last() else {
            return;
        };
        pose.translation -= pose.rotation.x * last.along_x + pose.rotation.y * last.along_y;
        let pose = self.to_atlas(pose);
        let key = atlas.key(&pose);
        let Some(cell) = atlas.cell_at_offset(&key, cell_offset) else {
            return;
        };
        let count = usize::from(atlas.counts[cell]);
        if count == 0 {
            return;
        }
        let (_, h) = atlas.direction_frame(cell);
        let (roll_y, roll_x) = atlas.roll_parts(&key, h);
        let (mut y, mut x) = (V::Four::zero(), V::Four::zero());
        if atlas.lead_turns {
            y.set_lane(0, pose.translation.y);
            x.set_lane(0, pose.translation.x);
        }
        y.set_lane(1, roll_y);
        x.set_lane(1, roll_x);
        let angles = rough_atan2(y, x);
        let shift = if atlas.lead_turns {
            angles.lane(0)
        } else {
            key.shift
        };
        let roll = if atlas.last_turns {
            angles.lane(1)
        } else {
            0.0
        };
        let (centre, _) = atlas.direction_frame(cell);
        let across = centre.cross(h);

        let stride = n + 5 + 4 * n;
        let Some(rows) = atlas.rows.get(cell * stride..(cell + 1) * stride) else {
            return;
        };
        let (q_rows, rest) = rows.split_at(n);
        let (key_rows, slopes) = rest.split_at(5);
        let row = |row: &CellRow| V::Four::from_singles(row);
        let axis = Vector3::<V::Four>::constant(key.axis)
            - Vector3::new(row(&key_rows[2]), row(&key_rows[3]), row(&key_rows[4]));
        let delta = [
            c(key.position[0]) - row(&key_rows[0]),
            c(key.position[1]) - row(&key_rows[1]),
            axis.dot(Vector3::constant(h)),
            axis.dot(Vector3::constant(across)),
        ];
        // Bit mask of the two joints that the key factors out, as a cheap test per joint.
        let reduced = 1_u32 << atlas.lead | 1 << (n - 1);
        let mut score = V::Four::zero();
        let joint_rows = links.links.iter().zip(q_rows).zip(slopes.chunks_exact(4));
        for (i, ((link, q_row), slope)) in joint_rows.enumerate() {
            let mut step = row(&slope[0]) * delta[0];
            for k in 1..4 {
                step = row(&slope[k]).mul_add(delta[k], step);
            }
            let mut q = row(q_row) + step;
            if reduced >> i & 1 != 0 {
                let leads = i == atlas.lead;
                let (correction, turns) = match leads {
                    true => (shift, atlas.lead_turns),
                    false => (roll, atlas.last_turns),
                };
                q += c(correction);
                if turns {
                    let middle = atlas.middles[usize::from(!leads)];
                    let turns = (q - c(middle)).mul_add(c(1.0 / TAU), c(ROUNDER)) - c(ROUNDER);
                    q = turns.mul_add(c(-TAU), q);
                }
            }
            if link.kind.slides() {
                q *= c(self.links_per_atlas_length);
            }
            let excess = (c(link.lower) - q)
                .max(q - c(link.upper))
                .max(V::Four::zero());
            score = step.mul_add(step, excess.mul_add(c(4.0), score));
            for s in 0..PER_CELL {
                candidates.q[i][s] = q.lane(s);
            }
        }
        // Sorting network for four slots; empty slots come last.
        let mut keys = [(0.0, 0u8); PER_CELL];
        for (s, key) in keys.iter_mut().enumerate() {
            let score = if s < count {
                score.lane(s)
            } else {
                f64::INFINITY
            };
            *key = (score, s as u8);
        }
        for (a, b) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
            if keys[b].0 < keys[a].0 {
                keys.swap(a, b);
            }
        }
        candidates.order = keys.map(|key| key.1);
        candidates.count = count;
    }
}
