//! Dragging to where a body rests: for a single pose, and for the steps of a path.

use super::drag::{BETTER, Drag};
use super::{Solution, Workspace};
use crate::clock::is_past;
use crate::solver::{Counts, Termination};

/// A frame that was cut at its steps creeps where its cost is not below this share of the last one's.
const CREEPS: f64 = 0.5;
/// So many frames in a row: the end is flat, and another way may be shorter.
const CREEPING: usize = 2;

/// What some frames came to.
#[derive(Clone, Copy, Debug, Default)]
struct Frames {
    frames: usize,
    iterations: usize,
    counts: Counts,
    ended: Ended,
}

impl std::ops::AddAssign for Frames {
    fn add_assign(&mut self, next: Self) {
        self.frames += next.frames;
        self.iterations += next.iterations;
        self.counts += next.counts;
        self.ended = next.ended;
    }
}

/// What ended some frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Ended {
    /// There were no more, or no more time.
    #[default]
    Spent,
    /// As far as was wanted.
    Done,
    /// Its cost hardly falls.
    Creeping,
}

/// A way that was left for another one.
struct Standing {
    x: Vec<f64>,
    q: Vec<f64>,
    misses: usize,
    cost: f64,
    solution: Solution,
}

impl Drag {
    /// Where the body comes to from where it stands, on its own way, without a search elsewhere: for a single
    /// pose, and for targets that are far apart. At first joints move as far as their limits let them, which
    /// keeps a symmetric body symmetric; where that misses, or creeps towards a flat end, the way is gone again
    /// in steps of a frame, and the nearer end counts. Either goes on for so many frames at most, until the
    /// body rests on its targets or where it comes no nearer to them. The solution's steps and evaluations are
    /// those of all frames, which count as one attempt; a time limit is for all of them. At least one frame is computed. Allocates.
    pub fn settle(&mut self, frames: usize) -> &Solution {
        let frames = frames.max(1);
        if self.motion.is_some() {
            return self.follow(frames);
        }
        let deadline = self.solver.stopping().deadline();
        let late = || is_past(deadline);
        let start = (self.x.clone(), self.q.clone());
        let mut all = self.stride(frames, true, &late);
        if !self.workspace.solution.reached && !late() {
            let (strides, creeping) = (all.frames, all.ended == Ended::Creeping);
            let mut first = self.standing();
            (self.x, self.q) = start;
            self.misses = 0;
            all += self.go_on(frames, &late, |drag, _| {
                drag.is_at_rest().then_some(Ended::Done)
            });
            if !self.workspace.solution.reached {
                let second = self.standing();
                if creeping && !late() {
                    // Neither way is short: the first one to its end after all.
                    self.stand(first);
                    all += self.stride(frames - strides, false, &late);
                    first = self.standing();
                }
                let nearer = second.cost < BETTER * first.cost;
                let back = first.solution.reached || !nearer;
                self.stand(if back { first } else { second });
            }
        }
        self.total(all)
    }

    /// Goes on to the targets as they are now, in steps of a frame, at most so many: until they are reached
    /// and no joint is catching up, or the body rests, or its cost hardly falls any more. For paths whose
    /// steps are judged one by one. The solution's steps and evaluations are those of all frames; a time
    /// limit is for all of them. At least one frame is computed.
    pub fn follow(&mut self, frames: usize) -> &Solution {
        let frames = frames.max(1);
        let deadline = self.solver.stopping().deadline();
        let late = || is_past(deadline);
        let all = self.go_on(frames, &late, |drag, last_cost| {
            if drag.is_speed_limited() {
                return None;
            }
            let there = drag.workspace.solution.reached || drag.is_at_rest();
            let flat = drag.is_cut() && drag.workspace.searched_cost() >= BETTER * last_cost;
            (there || flat).then_some(Ended::Done)
        });
        self.total(all)
    }

    /// Frames whose joints move as far as their limits let them, until the body rests, or where that is
    /// asked for creeps.
    fn stride(&mut self, frames: usize, up_to_creeping: bool, late: &dyn Fn() -> bool) -> Frames {
        let max_move = self.max_move;
        self.set_max_move(f64::INFINITY);
        let mut creeping = 0;
        let done = self.go_on(frames, late, |drag, last_cost| {
            let slow = drag.is_cut() && drag.workspace.searched_cost() > CREEPS * last_cost;
            creeping = if slow { creeping + 1 } else { 0 };
            match drag.is_at_rest() {
                true => Some(Ended::Done),
                false => (up_to_creeping && creeping >= CREEPING).then_some(Ended::Creeping),
            }
        });
        self.set_max_move(max_move);
        done
    }

    /// Frames until they are ended by what is asked of each with the cost before it, or it is late.
    fn go_on(
        &mut self,
        frames: usize,
        late: &dyn Fn() -> bool,
        mut ended: impl FnMut(&Self, f64) -> Option<Ended>,
    ) -> Frames {
        let (mut done, mut last_cost) = (Frames::default(), f64::INFINITY);
        for _ in 0..frames {
            self.advance();
            let solution = &self.workspace.solution;
            done.frames += 1;
            done.iterations += solution.iterations;
            done.counts += solution.counts;
            if let Some(ended) = ended(self, last_cost) {
                done.ended = ended;
                break;
            }
            if late() {
                break;
            }
            last_cost = self.workspace.searched_cost();
        }
        done
    }

    /// Whether the last frame was cut at its steps before it reached.
    fn is_cut(&self) -> bool {
        let solution = &self.workspace.solution;
        !solution.reached && solution.termination == Termination::IterationLimit
    }

    /// Keeps where the body stands, to come back to it.
    fn standing(&self) -> Standing {
        Standing {
            x: self.x.clone(),
            q: self.q.clone(),
            misses: self.misses,
            cost: self.workspace.searched_cost(),
            solution: self.workspace.solution.clone(),
        }
    }

    fn stand(&mut self, left: Standing) {
        (self.x, self.q, self.misses) = (left.x, left.q, left.misses);
        self.workspace.solution = left.solution;
        self.touches = true;
    }

    /// The last frame's solution, as that of all of them.
    fn total(&mut self, all: Frames) -> &Solution {
        let Workspace { solution, .. } = &mut self.workspace;
        (solution.iterations, solution.counts) = (all.iterations, all.counts);
        (solution.attempts, solution.agreeing) = (1, solution.agreeing.min(1));
        self.solution()
    }
}
