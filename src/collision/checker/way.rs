//! Whether the way between two configurations is free, by a bound on how far anything moves: not by samples and hope.

use super::{Checker, CheckerWorkspace};
use crate::kinematics::KinematicsError;
use crate::search::Collision;

/// So near to the margin nothing is told apart from touching, metres.
const RESOLUTION: f64 = 1e-6;

/// How much of a way is free.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Way {
    /// The share of the way from its begin that is surely free: 1 where all is.
    pub free: f64,
    /// What ends it.
    pub blocked_by: Option<Collision>,
}

impl Checker {
    /// How much of the way from one configuration to another is free, on which all joints move evenly
    /// ([`Model::interpolate`](crate::Model::interpolate)).
    ///
    /// Conservative advancement (Mirtich 1996, "Impulse-based dynamic simulation", ch. 3): where the nearest pair is d beyond the
    /// margin, nothing comes to it before d of motion is used up, and the motion of any place of any part is bounded by what
    /// the joints turn times how far they reach. A way that comes within a micrometre of the margin counts as blocked.
    ///
    /// # Errors
    /// Configurations of the wrong length or not finite, or a quaternion of length zero.
    pub fn way(
        &self,
        workspace: &mut CheckerWorkspace,
        from: &[f64],
        to: &[f64],
    ) -> Result<Way, KinematicsError> {
        // Checks both.
        workspace.place(to)?;
        workspace.place(from)?;
        let model = self.model.model();
        let bound = self.scene.motion_bound();
        let motion = bound.of(model, (from, to), &mut workspace.bound);
        // Lengths and numbers were checked.
        let motion = motion.unwrap_or(f64::INFINITY);
        let mut between = std::mem::take(&mut workspace.between);
        between.resize(from.len(), 0.0);
        // Two parts may come towards each other.
        let whole = 2.0 * motion;
        let mut free = 0.0;
        let way = loop {
            let reached = model.interpolate(from, to, free, &mut between);
            debug_assert!(reached.is_ok(), "both ends were checked");
            let left = self.margin + RESOLUTION + whole * (1.0 - free);
            let nearest = match self.nearest(workspace, &between, left) {
                Ok(Some(nearest)) => nearest,
                Ok(None) => {
                    break Ok(Way {
                        free: 1.0,
                        blocked_by: None,
                    });
                }
                Err(error) => break Err(error),
            };
            let room = nearest.distance - self.margin;
            // Not a number where the motion has no bound.
            let share = room / whole;
            if room.is_nan() || share.is_nan() || room < RESOLUTION {
                break Ok(Way {
                    free,
                    blocked_by: Some(nearest),
                });
            }
            free += share;
            if free >= 1.0 {
                break Ok(Way {
                    free: 1.0,
                    blocked_by: None,
                });
            }
        };
        workspace.between = between;
        way
    }
}
