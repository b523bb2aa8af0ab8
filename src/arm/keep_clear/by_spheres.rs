//! Many configurations at once, eight in lanes.

use crate::arm::arm::Arm;
use crate::arm::{PoseOutcome, QueryError, Reply};
use crate::collision::in_lanes::CHECKED;

impl Arm {
    /// Which configurations of the arm, one after another in `q`, are surely clear: the spheres that cover its links come nowhere
    /// nearer than the margin. Eight are checked at once in SIMD lanes, which is some twenty times as fast as
    /// [`collisions`](Self::collisions); where the spheres stick out of the shapes, one that is not clear by them may still be free. Links
    /// that stand so near each other that their spheres nearly always meet, as a wrist's, are told apart by their shapes.
    /// Where there are no spheres, or what they cannot say is asked (an attached obstacle), the shapes decide.
    ///
    /// # Errors
    /// An arm without a [checker](Self::with_checker), of which it is not known what it touches; slices of the wrong length, or a configuration that is not finite.
    pub fn clear_by_spheres(&self, q: &[f64], clear: &mut [bool]) -> Result<(), QueryError> {
        self.check_length("q", q.len(), self.joint_count() * clear.len())?;
        self.check_finite("q", q)?;
        if !self.keeps_clear() {
            return Err(QueryError::NothingToKeepClearOf);
        }
        clear.fill(true);
        self.for_each_touching(q, false, |place| clear[place] = false)
    }

    /// Takes back that attempts reached which touch something.
    pub(in crate::arm) fn take_back_touching(
        &self,
        q: &[f64],
        outcomes: &mut [PoseOutcome],
    ) -> Reply<()> {
        self.for_each_touching(q, true, |place| outcomes[place].reached = false)
    }

    /// Visits the configurations, by place, that are not surely clear by their spheres, nor where `by_shapes` by the exact check.
    pub(super) fn for_each_touching(
        &self,
        q: &[f64],
        by_shapes: bool,
        mut each: impl FnMut(usize),
    ) -> Reply<()> {
        let Some(kept) = &self.collisions else {
            return Ok(());
        };
        self.with_room(kept, |_, room| {
            let n = self.joint_count();
            for (group, several) in q.chunks(CHECKED * n).enumerate() {
                let by_spheres = kept.free_by_spheres(self, room, several)?;
                for (lane, q) in several.chunks_exact(n).enumerate() {
                    let is_free = match by_spheres >> lane & 1 != 0 {
                        true => kept.close_are_apart(self, room, q)?,
                        false => by_shapes && kept.is_free_by_shapes(self, room, q)?,
                    };
                    if !is_free {
                        each(group * CHECKED + lane);
                    }
                }
            }
            Ok(())
        })
    }
}
