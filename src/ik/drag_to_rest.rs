//! Repeated frames of a drag until it is at rest.

use super::drag::{BETTER, Drag};
use super::{Solution, Workspace};
use crate::clock::is_past;
use crate::solver::{Counts, Termination};

/// Ratio of successive costs above which a frame that was cut short makes slow progress.
const CREEPS: f64 = 0.5;
/// Number of consecutive slow frames after which the cost counts as flat, so another motion may be shorter.
const CREEPING: usize = 2;

/// Statistics of several frames.
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

/// Reason why frames ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Ended {
    /// The number of frames or the time was exhausted.
    #[default]
    Spent,
    /// The requested state was reached.
    Done,
    /// The cost decreased too slowly.
    Creeping,
}

/// State at the end of a motion, stored while another motion is tried.
struct Standing {
    x: Vec<f64>,
    q: Vec<f64>,
    misses: usize,
    cost: f64,
    solution: Solution,
}

impl Drag {
    /// Moves to the targets until the drag is at rest, in at most `frames` frames per motion. Use it for a single pose,
    /// or for targets that are far apart. There is no global search.
    ///
    /// The first motion has no displacement bound per frame, which keeps a symmetric model symmetric. If it does not
    /// reach, or makes slow progress, a second motion with the usual bound starts again from the beginning. The end
    /// with the lower cost counts. Each motion ends when the targets are reached or the cost no longer decreases.
    ///
    /// The iterations and evaluations of the solution are those of all frames, which count as one attempt. The time
    /// limit applies to all frames together. At least one frame is computed. This method allocates.
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
                    // Both motions are slow, so the first one is continued to its end.
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

    /// Moves towards the current targets in steps of a frame, at most `frames`. The motion ends when the targets are
    /// reached and no joint is catching up. It also ends when the drag is at rest, or the cost hardly decreases. Use it
    /// for paths whose steps are checked one by one.
    ///
    /// The iterations and evaluations of the solution are those of all frames. The time limit applies to all frames
    /// together. At least one frame is computed.
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

    /// Computes frames without a displacement bound until the drag is at rest. With `up_to_creeping` set, slow progress
    /// ends them too.
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

    /// Computes frames until `ended` returns a reason or the time is over. `ended` receives the drag and the cost of
    /// the previous frame.
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

    /// Returns whether the last frame was cut short before it reached.
    fn is_cut(&self) -> bool {
        let solution = &self.workspace.solution;
        !solution.reached && solution.termination == Termination::IterationLimit
    }

    /// Stores the current state.
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

    /// Returns the solution of the last frame with the statistics of all frames.
    fn total(&mut self, all: Frames) -> &Solution {
        let Workspace { solution, .. } = &mut self.workspace;
        (solution.iterations, solution.counts) = (all.iterations, all.counts);
        (solution.attempts, solution.agreeing) = (1, solution.agreeing.min(1));
        self.solution()
    }
}
