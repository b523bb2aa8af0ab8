//! Whole paths, on one branch from end to end where there is one.

use super::arm::Arm;
use super::follower::{Follower, Jump, LONG_STEP};
use super::{QueryError, Reply};
use crate::ik::Solution;
use crate::spatial::Placement;

/// How many solutions beyond the end of a branch are tried as places to come from.
const OTHER_SOLUTIONS: usize = 16;
/// How strongly the way back is drawn to the way known, one after another: radians of each joint a
/// radian of path. A strong pull meets sooner, a weak one keeps clear of limits.
const PULLS: [f64; 3] = [0.3, 0.1, 0.03];
/// Steps that are gone back at most, in all, as a multiple of the path's length.
const LOOK_BACK: usize = 32;
/// Two ways meet where no joint differs by more than this, radians.
const MEETING: f64 = 0.25 * LONG_STEP;

/// A path of solutions, and where it is broken.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Track {
    /// One a target, reached or not.
    pub solutions: Vec<Solution>,
    /// The steps in which a joint moves further than 0.2 rad, in order.
    pub jumps: Vec<Jump>,
}

impl Track {
    /// Whether every target is reached without a jump.
    #[cfg(feature = "collision")]
    fn is_whole(&self) -> bool {
        self.jumps.is_empty() && self.solutions.iter().all(|solution| solution.reached)
    }
}

impl Arm {
    /// Follows a path: every step goes on from the one before on the same branch, whatever the
    /// arm's search; the first, if the start is far from it, is [`solve`](Self::solve)'s. Where the
    /// branch ends (in a limit, mostly, that the null space ran into), the arm looks for another way
    /// through the steps before. Where there is none it stays on its branch, at the nearest place to
    /// each target, until that reaches again; if it is
    /// [asked](super::ArmBuilder::with_global_search_on_miss) to, it jumps to the nearest solution
    /// instead and says so in [`Track::jumps`]. An arm that [keeps clear](Self::with_checker) of something takes
    /// only ways that are free, and where it misses what it would not without anything to keep clear of, takes that
    /// way if it is free from end to end.
    ///
    /// # Errors
    /// As [`solve`](Self::solve); the error names the first bad target.
    pub fn track(
        &self,
        base_from_tools: &[Placement<f64>],
        start: &[f64],
    ) -> Result<Track, QueryError> {
        let mut follower = self.follower(start)?;
        for (query, target) in base_from_tools.iter().enumerate() {
            self.check_query(query, target, start)?;
        }
        let track = self.follow(&mut follower, base_from_tools)?;
        #[cfg(feature = "collision")]
        if let (true, false) = (self.keeps_clear(), track.is_whole())
            && let Some(plain) = self.plain_if_free(base_from_tools, start)?
        {
            return Ok(plain);
        }
        Ok(track)
    }

    /// Follows a path that was checked, from where a follower stands.
    fn follow<'a>(
        &'a self,
        follower: &mut Follower<'a>,
        base_from_tools: &[Placement<f64>],
    ) -> Reply<Track> {
        let mut track = Track::default();
        track.solutions.reserve(base_from_tools.len());
        let mut back_left = LOOK_BACK * base_from_tools.len();
        let mut missing = false;
        for (step, target) in base_from_tools.iter().enumerate() {
            let mut solution = Solution::default();
            let jump = if step == 0 {
                let jump = follower.begin(*target, &mut solution)?;
                follower.set_ease(&solution.q);
                jump
            } else {
                follower.advance(*target, &mut solution)?
            };
            let reached = solution.reached;
            track.solutions.push(solution);
            // A branch ends where it is left or first misses.
            let ends = jump.is_some() || !reached && !missing;
            missing = !reached;
            if ends && self.go_round(base_from_tools, step, &mut track, &mut back_left)? {
                *follower = self.follower_at(base_from_tools, step, &track)?;
                missing = false;
            } else {
                track.jumps.extend(jump);
            }
        }
        Ok(track)
    }

    /// The track of an arm that keeps clear of nothing, where it is whole and its way is free.
    #[cfg(feature = "collision")]
    fn plain_if_free(&self, targets: &[Placement<f64>], start: &[f64]) -> Reply<Option<Track>> {
        let mut plain = self.clone();
        plain.collisions = None;
        let track = plain.follow(&mut plain.follower(start)?, targets)?;
        let Some(first) = track.solutions.first().filter(|_| track.is_whole()) else {
            return Ok(None);
        };
        // From a start that is far from the path no way is asked, as it is not for solutions.
        let near = self.longest_move(start, &first.q).1 <= LONG_STEP;
        let mut last = if near { start } else { &first.q };
        for solution in &track.solutions {
            if !self.goes_free(last, &solution.q)? {
                return Ok(None);
            }
            last = &solution.q;
        }
        Ok(Some(track))
    }

    /// Looks for another way to the end of a branch at `step`: from solutions there it goes back
    /// along the path, drawn to the way already found, until it meets that. Whether it does; the
    /// track then holds the new way.
    fn go_round(
        &self,
        targets: &[Placement<f64>],
        step: usize,
        track: &mut Track,
        back_left: &mut usize,
    ) -> Reply<bool> {
        let Some(last) = step.checked_sub(1) else {
            return Ok(false);
        };
        let others =
            self.other_solutions(&targets[step], &track.solutions[last].q, OTHER_SOLUTIONS)?;
        let first = Some(track.solutions[step].clone()).filter(|first| first.reached);
        for pull in PULLS {
            for other in first.iter().chain(&others) {
                let way = self.way_back(targets, step, other, pull, track, back_left)?;
                if let Some(way) = way {
                    let meeting = step - way.len();
                    track.solutions.truncate(meeting + 1);
                    track.solutions.extend(way.into_iter().rev());
                    track.jumps.retain(|jump| jump.step <= meeting);
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// The steps from `other` back to where they meet the track; none if they do not.
    fn way_back(
        &self,
        targets: &[Placement<f64>],
        step: usize,
        other: &Solution,
        pull: f64,
        track: &Track,
        back_left: &mut usize,
    ) -> Reply<Option<Vec<Solution>>> {
        let mut follower = self.follower(&other.q)?;
        follower.stand_at(&targets[step], &other.q);
        let mut way = vec![other.clone()];
        for (target, known) in targets.iter().zip(&track.solutions).take(step).rev() {
            if *back_left == 0 {
                break;
            }
            *back_left -= 1;
            let mut solution = Solution::default();
            if !follower.try_branch(target, Some((&known.q, pull)), &mut solution) {
                break;
            }
            let meets = self.longest_move(&known.q, &solution.q).1 <= MEETING;
            let next = way.last().map_or(&*other.q, |next| &next.q);
            // The way goes on from the one known, and no step of it is a jump.
            let joins = || self.longest_move(&known.q, next).1 <= LONG_STEP;
            if meets && joins() && self.goes_free(&known.q, next)? {
                return Ok(Some(way));
            }
            if !self.goes_free(&solution.q, next)? {
                break;
            }
            follower.stand_at(target, &solution.q);
            way.push(solution);
        }
        Ok(None)
    }

    /// Whether nothing is in the way between two configurations.
    #[cfg(feature = "collision")]
    fn goes_free(&self, from: &[f64], to: &[f64]) -> Reply<bool> {
        Ok(self.in_the_way(from, to)?.is_none())
    }

    /// Nothing is.
    #[cfg(not(feature = "collision"))]
    #[allow(
        clippy::unused_self,
        clippy::unnecessary_wraps,
        reason = "as the one that looks"
    )]
    fn goes_free(&self, _: &[f64], _: &[f64]) -> Reply<bool> {
        Ok(true)
    }

    /// A follower that has come along the last two steps of a track.
    fn follower_at(
        &self,
        targets: &[Placement<f64>],
        step: usize,
        track: &Track,
    ) -> Reply<Follower<'_>> {
        let first = step.saturating_sub(2);
        let mut follower = self.follower(&track.solutions[first].q)?;
        follower.set_ease(&track.solutions[0].q);
        for (target, solution) in targets[first..=step].iter().zip(&track.solutions[first..]) {
            follower.stand_at(target, &solution.q);
        }
        follower.set_steps(step + 1);
        Ok(follower)
    }
}
