//! Search for a collision-free solution.

use super::{CollisionAvoidance, CollisionWorkspace};
use crate::arm::QueryError;
use crate::arm::arm::Arm;
use crate::arm::dispatch::Query;
use crate::arm::multi_solution::spent;
use crate::arm::workspace::{ArmWorkspace, Errors};
use crate::collision::simd_spheres::CHECKED;
use crate::ik::Solution;
use crate::search::SearchResult;
use crate::simd_ik::{self, PoseOutcome};
use crate::solver::Termination;

/// Largest number of solutions that are checked by shapes after their spheres collide.
pub(super) const LOOKED_AT: usize = 32;
/// Number of collision-free starts that suffices for a group of attempts; 2 and 8 measured slower on MotionBenchMaker.
const ENOUGH: usize = 4;
/// Number of cells of the atlas after which a single collision-free start suffices.
const CELLS: usize = 4;

impl Arm {
    /// Solves a query by a collision-free solution, if one is found.
    pub(in crate::arm) fn answer_clear_of(
        &self,
        kept: &CollisionAvoidance,
        query: &Query<'_>,
        solution: &mut Solution,
    ) -> Result<(SearchResult, Errors), QueryError> {
        let plain = kept.with_time_to_check(query);
        let (mut found, mut errors) = self.answer_anywhere(&plain, solution)?;
        self.with_room(kept, |workspace, room| {
            room.deadline = plain.deadline;
            let free = found.reached && kept.is_clear(self, room, &solution.q)?;
            if found.reached && !free {
                workspace.x.copy_from_slice(&solution.q);
                self.search_free(kept, workspace, room, query, &mut found)?;
                let free = found.reached;
                self.judge(workspace, &mut found);
                found.reached &= free;
                self.record_configuration(&found, workspace, solution);
                errors = workspace.errors;
            }
            if !found.reached {
                solution.set_collisions(kept.collisions(self, room, &solution.q)?);
            }
            Ok((found, errors))
        })
    }

    /// Searches attempts for a collision-free one, in the order of the search preference.
    ///
    /// The workspace's x becomes that one, or else the one of least penetration.
    fn search_free(
        &self,
        kept: &CollisionAvoidance,
        workspace: &mut ArmWorkspace,
        room: &mut CollisionWorkspace,
        query: &Query<'_>,
        found: &mut SearchResult,
    ) -> Result<(), QueryError> {
        workspace.aim(query.target);
        self.bound_moves(workspace, query.start);
        if kept.never_free {
            (found.reached, found.termination) = (false, Termination::Stationary);
            return Ok(());
        }
        if kept.is_late(query, 1) {
            (found.reached, found.termination) = (false, Termination::TimeLimit);
            return Ok(());
        }
        let before = (found.iterations, found.attempts);
        room.by_shapes = LOOKED_AT;
        let free = match self.options.search.compares() {
            true => {
                self.gather(workspace, query);
                self.first_free(kept, workspace, room, query, 0)?
            }
            false => self.lowest_free(kept, workspace, room, query)?,
        };
        found.iterations = before.0 + spent(&workspace.outcomes);
        found.attempts = before.1 + workspace.outcomes.len();
        found.reached = free.is_some();
        if let Some(place) = free {
            workspace.stand_at_found(place);
            found.termination = Termination::Reached;
            // Numbered after the attempts of the plain solution.
            found.number = before.1 + place;
            return Ok(());
        }
        let least = self.stand_least_deep(kept, workspace, room, query)?;
        // This search may make as many attempts as the plain solution.
        let left = (2 * self.attempts_at(query.target) as usize).saturating_sub(found.attempts);
        let (free, more) = self.free_along_freedom(kept, workspace, room, query, (least, left))?;
        found.attempts += more.attempts;
        found.iterations += more.iterations;
        if free {
            (found.reached, found.number) = (true, found.attempts - 1);
        }
        found.termination = match (free, query.is_late()) {
            (true, _) => Termination::Reached,
            (_, true) => Termination::TimeLimit,
            _ => Termination::Stationary,
        };
        Ok(())
    }

    /// Runs attempts in groups until one is collision-free.
    ///
    /// The first half at most begins at the atlas's configurations near the target; the numbered attempts follow.
    fn lowest_free(
        &self,
        kept: &CollisionAvoidance,
        workspace: &mut ArmWorkspace,
        room: &mut CollisionWorkspace,
        query: &Query<'_>,
    ) -> Result<Option<usize>, QueryError> {
        workspace.found.clear();
        workspace.outcomes.clear();
        workspace.order.clear();
        let wanted = self.attempts_at(query.target);
        let budget = self
            .options
            .iterations
            .map_or(usize::MAX, |most| most as usize);
        let about = wanted / 2;
        let (mut first, mut cells) = (0, Some(0));
        loop {
            let begun = workspace.outcomes.len();
            let made = begun as u32;
            if made >= wanted || spent(&workspace.outcomes) >= budget || kept.is_late(query, 1) {
                break;
            }
            match cells.filter(|_| made < about) {
                Some(from) => {
                    let most = (about - made) as usize;
                    cells = self.attempts_about(kept, workspace, room, query, (from, most))?;
                }
                None => {
                    // Groups grow, as finished lanes take further attempts, unless a deadline must be checked.
                    let more = query.deadline.map_or(first / 2, |_| 0);
                    let count = more.max(CHECKED as u32).min(wanted - made);
                    self.run_attempts(workspace, query, first, count);
                    first += count;
                }
            }
            let before = workspace.order.len();
            for place in begun..workspace.outcomes.len() {
                if workspace.outcomes[place].reached {
                    workspace.order.push((0.0, place));
                }
            }
            let free = self.first_free(kept, workspace, room, query, before)?;
            if free.is_some() {
                return Ok(free);
            }
        }
        Ok(None)
    }

    /// Runs at most `most` attempts from the atlas's configurations in cells around the target, from cell `from` on.
    ///
    /// Only starts whose spheres are collision-free run, as a start is close to its solution. Returns the next cell, if
    /// there are more.
    fn attempts_about(
        &self,
        kept: &CollisionAvoidance,
        workspace: &mut ArmWorkspace,
        room: &mut CollisionWorkspace,
        query: &Query<'_>,
        (from, most): (usize, usize),
    ) -> Result<Option<usize>, QueryError> {
        let n = self.joint_count();
        let Some(lanes) = self.lanes_within(&workspace.bounded_lanes) else {
            return Ok(None);
        };
        let (mut seeds, mut free) = (std::mem::take(&mut room.seeds), 0);
        seeds.clear();
        let mut next = Some(from);
        while free == 0 || free < ENOUGH && next.is_some_and(|cell| cell < from + CELLS) {
            // As many cells as fill the lanes.
            while let Some(cell) = next
                && seeds.len() < (free + CHECKED) * n
            {
                let more = lanes.neighbour_seeds(query.target, cell..cell + 1, &mut seeds);
                next = more.then_some(cell + 1);
            }
            let gathered = free..seeds.len() / n;
            if gathered.is_empty() {
                break;
            }
            for first in gathered.clone().step_by(CHECKED) {
                if kept.is_late(query, 2) {
                    next = None;
                    break;
                }
                let group = first..(first + CHECKED).min(gathered.end);
                let bits =
                    kept.free_by_spheres(self, room, &seeds[group.start * n..group.end * n])?;
                for place in group {
                    if bits >> (place - first) & 1 != 0 {
                        seeds.copy_within(place * n..(place + 1) * n, free * n);
                        free += 1;
                    }
                }
            }
            seeds.truncate(free * n);
            if kept.is_late(query, 2) {
                break;
            }
        }
        let free = free.min(most);
        seeds.truncate(free * n);
        let begun = workspace.outcomes.len();
        let end = begun + free;
        workspace.found.resize(end * n, 0.0);
        workspace.outcomes.resize(end, PoseOutcome::default());
        room.targets.clear();
        room.targets.resize(free, *query.target);
        lanes.run(simd_ik::Work {
            targets: &room.targets,
            starts: &seeds,
            search: simd_ik::Prefer::Start,
            attempts: simd_ik::Attempts::UpTo(1),
            deadline: query.deadline,
            q: &mut workspace.found[begun * n..],
            outcomes: &mut workspace.outcomes[begun..],
        });
        for q in workspace.found[begun * n..].chunks_exact_mut(n) {
            lanes.unwrap_towards(query.start, q);
        }
        room.seeds = seeds;
        Ok(next)
    }

    /// Index of the first collision-free solution in the workspace's order, from `from` on.
    ///
    /// Solutions are checked by spheres, and by shapes as long as more such checks are allowed.
    fn first_free(
        &self,
        kept: &CollisionAvoidance,
        workspace: &ArmWorkspace,
        room: &mut CollisionWorkspace,
        query: &Query<'_>,
        from: usize,
    ) -> Result<Option<usize>, QueryError> {
        let mut several = std::mem::take(&mut room.several);
        let mut first = None;
        for group in workspace.order[from..].chunks(CHECKED) {
            if kept.is_late(query, 2) {
                break;
            }
            several.clear();
            for (_, place) in group {
                several.extend_from_slice(workspace.found_at(*place));
            }
            let by_spheres = kept.free_by_spheres(self, room, &several)?;
            for (lane, (_, place)) in group.iter().enumerate() {
                let q = workspace.found_at(*place);
                let free = if by_spheres >> lane & 1 != 0 {
                    kept.close_are_apart(self, room, q)?
                } else if room.by_shapes > 0 && !kept.is_late(query, 2) {
                    room.by_shapes -= 1;
                    kept.is_free_by_shapes(self, room, q)?
                } else {
                    false
                };
                if free {
                    first = Some(*place);
                    break;
                }
            }
            if first.is_some() {
                break;
            }
        }
        room.several = several;
        Ok(first)
    }

    /// Removes solutions in collision from the workspace's order, and those for whose check there is no time.
    ///
    /// Returns true if all were checked.
    pub(in crate::arm) fn drop_touching(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
    ) -> Result<bool, QueryError> {
        let Some(kept) = &self.collisions else {
            return Ok(true);
        };
        let mut taken = workspace.clear_room.take();
        let room = taken.get_or_insert_with(|| kept.room());
        room.deadline = query.deadline;
        let mut order = std::mem::take(&mut workspace.order);
        let mut free = Vec::with_capacity(order.len());
        let mut all = true;
        for (distance, place) in order.drain(..) {
            if kept.is_late(query, 1) {
                all = false;
                break;
            }
            if kept.is_clear(self, room, workspace.found_at(place))? {
                free.push((distance, place));
            }
        }
        all &= !query.is_late();
        room.deadline = None;
        workspace.order = free;
        workspace.clear_room = taken;
        Ok(all)
    }
}
