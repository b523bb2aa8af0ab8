//! Tracking of whole paths on one branch, if there is one.

use super::QueryError;
use super::arm::Arm;
use super::follower::{Follower, Jump, LONG_STEP};
use crate::ik::Solution;
use crate::spatial::Placement;

/// Number of solutions beyond the end of a branch that are tried as starts of a backward path.
const OTHER_SOLUTIONS: usize = 16;
/// Attraction of a backward path to the known one, tried in order, in radians of each joint per radian of path.
///
/// A strong one meets sooner; a weak one avoids limits better.
const PULLS: [f64; 3] = [0.3, 0.1, 0.03];
/// Largest number of backward steps in all, as a multiple of the path's length.
const LOOK_BACK: usize = 32;
/// Largest difference of a joint at which two paths meet, radians.
const MEETING: f64 = 0.25 * LONG_STEP;

/// Joint path along targets, and its jumps.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Track {
    /// One solution per target, reached or not.
    pub solutions: Vec<Solution>,
    /// Steps in which a joint moves farther than 0.2 rad, in order.
    pub jumps: Vec<Jump>,
}

impl Track {
    /// Returns true if every target is reached without a jump.
    #[cfg(feature = "collision")]
    fn is_whole(&self) -> bool {
        self.jumps.is_empty() && self.solutions.iter().all(|solution| solution.reached)
    }
}

impl Arm {
    /// Follows a path: every step continues from the one before on the same branch, whatever the arm's search.
    ///
    /// The first target, if the start is far from it, is solved as by [`solve`](Self::solve). If the branch ends,
    /// mostly at a limit that the null space reached, the arm looks for another joint path through the steps before. If
    /// there is none, it stays on its branch at the closest pose to each target, until a target is reached again. If
    /// jumps are [enabled](super::ArmBuilder::with_global_search_on_miss), it jumps to the nearest solution instead and
    /// reports that in [`Track::jumps`].
    ///
    /// An arm with a [checker](Self::with_checker) makes only collision-free motions. If it misses a target, it takes
    /// the path of the same arm without a checker, provided that path is complete and free.
    ///
    /// # Errors
    /// Returns the errors of [`solve`](Self::solve), for the first invalid target.
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

    /// Follows a checked path, from the configuration of a follower.
    fn follow<'a>(
        &'a self,
        follower: &mut Follower<'a>,
        base_from_tools: &[Placement<f64>],
    ) -> Result<Track, QueryError> {
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
            // A branch ends at a jump or at its first unreached target.
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

    /// Track of the arm without its checker, if it is complete and collision-free.
    #[cfg(feature = "collision")]
    fn plain_if_free(
        &self,
        targets: &[Placement<f64>],
        start: &[f64],
    ) -> Result<Option<Track>, QueryError> {
        let mut plain = self.clone();
        plain.collisions = None;
        let track = plain.follow(&mut plain.follower(start)?, targets)?;
        let Some(first) = track.solutions.first().filter(|_| track.is_whole()) else {
            return Ok(None);
        };
        // For a start far from the path no motion is checked, as for single solutions.
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

    /// Looks for another joint path to the end of a branch at `step`. Returns true if there is one, with the new path
    /// in the track.
    ///
    /// From solutions at that step it goes back along the path, attracted to the joint path already found, until the
    /// two meet.
    fn go_round(
        &self,
        targets: &[Placement<f64>],
        step: usize,
        track: &mut Track,
        back_left: &mut usize,
    ) -> Result<bool, QueryError> {
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

    /// Steps from `other` back to the meeting with the track; `None` if they do not meet.
    fn way_back(
        &self,
        targets: &[Placement<f64>],
        step: usize,
        other: &Solution,
        pull: f64,
        track: &Track,
        back_left: &mut usize,
    ) -> Result<Option<Vec<Solution>>, QueryError> {
        let mut follower = self.follower(&other.q)?;
        follower.set_configuration(&targets[step], &other.q);
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
            // The path continues from the known one, without a jump.
            let joins = || self.longest_move(&known.q, next).1 <= LONG_STEP;
            if meets && joins() && self.goes_free(&known.q, next)? {
                return Ok(Some(way));
            }
            if !self.goes_free(&solution.q, next)? {
                break;
            }
            follower.set_configuration(target, &solution.q);
            way.push(solution);
        }
        Ok(None)
    }

    /// Returns true if the motion between two configurations is collision-free.
    #[cfg(feature = "collision")]
    fn goes_free(&self, from: &[f64], to: &[f64]) -> Result<bool, QueryError> {
        Ok(self.in_the_way(from, to)?.is_none())
    }

    /// Returns true: without collision checks every motion is free.
    #[cfg(not(feature = "collision"))]
    #[allow(
        clippy::unused_self,
        clippy::unnecessary_wraps,
        reason = "as the one that looks"
    )]
    fn goes_free(&self, _: &[f64], _: &[f64]) -> Result<bool, QueryError> {
        Ok(true)
    }

    /// A follower that has made the last two steps of a track.
    fn follower_at(
        &self,
        targets: &[Placement<f64>],
        step: usize,
        track: &Track,
    ) -> Result<Follower<'_>, QueryError> {
        let first = step.saturating_sub(2);
        let mut follower = self.follower(&track.solutions[first].q)?;
        follower.set_ease(&track.solutions[0].q);
        for (target, solution) in targets[first..=step].iter().zip(&track.solutions[first..]) {
            follower.set_configuration(target, &solution.q);
        }
        follower.set_steps(step + 1);
        Ok(follower)
    }
}
