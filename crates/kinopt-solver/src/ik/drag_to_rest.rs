//! Repeated frames of a drag until it is at rest.

use super::drag::{Drag, MAX_ACCEPTED_COST_RATIO};
use super::{Solution, Workspace};
use crate::solver::{Counts, Termination};
use kinopt_kinematics::clock::is_past;

/// Ratio of successive costs above which a frame that was cut short makes slow progress.
const MIN_SLOW_COST_RATIO: f64 = 0.5;
/// Number of consecutive slow frames after which the cost counts as flat, so another motion may be shorter.
const MAX_SLOW_FRAMES: usize = 2;

/// Statistics of several frames.
#[derive(Clone, Copy, Debug, Default)]
struct FrameTotals {
    frames: usize,
    iterations: usize,
    counts: Counts,
    stop_reason: StopReason,
}

impl std::ops::AddAssign for FrameTotals {
    fn add_assign(&mut self, next: Self) {
        self.frames += next.frames;
        self.iterations += next.iterations;
        self.counts += next.counts;
        self.stop_reason = next.stop_reason;
    }
}

/// Reason why frames ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum StopReason {
    /// The number of frames or the time was exhausted.
    #[default]
    Exhausted,
    /// The requested state was reached.
    Done,
    /// The cost decreased too slowly.
    Slow,
}

/// State at the end of a motion, stored while another motion is tried.
struct DragState {
    x: Vec<f64>,
    q: Vec<f64>,
    unreached_frames: usize,
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
        let is_late = || is_past(deadline);
        let start = (self.x.clone(), self.q.clone());
        let mut totals = self.advance_unbounded(frames, true, &is_late);
        if !self.workspace.solution.reached && !is_late() {
            let (frames_used, is_slow) = (totals.frames, totals.stop_reason == StopReason::Slow);
            let mut first = self.save_state();
            (self.x, self.q) = start;
            self.unreached_frames = 0;
            totals += self.advance_until(frames, &is_late, |drag, _| {
                drag.is_at_rest().then_some(StopReason::Done)
            });
            if !self.workspace.solution.reached {
                let second = self.save_state();
                if is_slow && !is_late() {
                    // Both motions are slow, so the first one is continued to its end.
                    self.restore_state(first);
                    totals += self.advance_unbounded(frames - frames_used, false, &is_late);
                    first = self.save_state();
                }
                let second_is_better = second.cost < MAX_ACCEPTED_COST_RATIO * first.cost;
                let use_first = first.solution.reached || !second_is_better;
                self.restore_state(if use_first { first } else { second });
            }
        }
        self.total(totals)
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
        let is_late = || is_past(deadline);
        let totals = self.advance_until(frames, &is_late, |drag, last_cost| {
            if drag.is_speed_limited() {
                return None;
            }
            let is_arrived = drag.workspace.solution.reached || drag.is_at_rest();
            let is_flat = drag.is_cut()
                && drag.workspace.searched_cost() >= MAX_ACCEPTED_COST_RATIO * last_cost;
            (is_arrived || is_flat).then_some(StopReason::Done)
        });
        self.total(totals)
    }

    /// Computes frames without a displacement bound until the drag is at rest. With `stop_when_slow` set, slow progress
    /// ends them too.
    fn advance_unbounded(
        &mut self,
        frames: usize,
        stop_when_slow: bool,
        is_late: &dyn Fn() -> bool,
    ) -> FrameTotals {
        let max_move = self.max_move;
        self.set_max_move(f64::INFINITY);
        let mut slow_frames = 0;
        let totals = self.advance_until(frames, is_late, |drag, last_cost| {
            let is_slow =
                drag.is_cut() && drag.workspace.searched_cost() > MIN_SLOW_COST_RATIO * last_cost;
            slow_frames = if is_slow { slow_frames + 1 } else { 0 };
            match drag.is_at_rest() {
                true => Some(StopReason::Done),
                false => {
                    (stop_when_slow && slow_frames >= MAX_SLOW_FRAMES).then_some(StopReason::Slow)
                }
            }
        });
        self.set_max_move(max_move);
        totals
    }

    /// Computes frames until `stop_reason` returns a reason or the time is over. `stop_reason` receives the drag and
    /// the cost of the previous frame.
    fn advance_until(
        &mut self,
        frames: usize,
        is_late: &dyn Fn() -> bool,
        mut stop_reason: impl FnMut(&Self, f64) -> Option<StopReason>,
    ) -> FrameTotals {
        let (mut totals, mut last_cost) = (FrameTotals::default(), f64::INFINITY);
        for _ in 0..frames {
            self.advance();
            let solution = &self.workspace.solution;
            totals.frames += 1;
            totals.iterations += solution.iterations;
            totals.counts += solution.counts;
            if let Some(stop_reason) = stop_reason(self, last_cost) {
                totals.stop_reason = stop_reason;
                break;
            }
            if is_late() {
                break;
            }
            last_cost = self.workspace.searched_cost();
        }
        totals
    }

    /// Returns whether the last frame was cut short before it reached.
    fn is_cut(&self) -> bool {
        let solution = &self.workspace.solution;
        !solution.reached && solution.termination == Termination::IterationLimit
    }

    /// Stores the current state.
    fn save_state(&self) -> DragState {
        DragState {
            x: self.x.clone(),
            q: self.q.clone(),
            unreached_frames: self.unreached_frames,
            cost: self.workspace.searched_cost(),
            solution: self.workspace.solution.clone(),
        }
    }

    fn restore_state(&mut self, state: DragState) {
        (self.x, self.q, self.unreached_frames) = (state.x, state.q, state.unreached_frames);
        self.workspace.solution = state.solution;
        self.may_collide = true;
    }

    /// Returns the solution of the last frame with the statistics of all frames.
    fn total(&mut self, totals: FrameTotals) -> &Solution {
        let Workspace { solution, .. } = &mut self.workspace;
        (solution.iterations, solution.counts) = (totals.iterations, totals.counts);
        (solution.attempts, solution.agreeing) = (1, solution.agreeing.min(1));
        self.solution()
    }
}
