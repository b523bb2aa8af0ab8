//! Enabled and disabled collision pairs.

use super::CollisionModel;
use kinopt_kinematics::model::{FrameId, FrameRef, UnknownName};
use kinopt_robot::robot::Srdf;

impl CollisionModel {
    /// The model with the collision pair of two links disabled, so that they may collide.
    ///
    /// [`World::allow_collision`](crate::collision::World::allow_collision) allows the collision of a link and an obstacle.
    ///
    /// # Errors
    /// Returns an error if a link has no shapes. The error lists the links with shapes.
    pub fn with_ignored<'a>(
        mut self,
        a: impl Into<FrameRef<'a>>,
        b: impl Into<FrameRef<'a>>,
    ) -> Result<Self, UnknownName> {
        let pair = self.pair(a.into(), b.into())?;
        self.pairs.retain(|other| *other != pair);
        self.allow_planes(pair, true);
        Ok(self)
    }

    /// The model with the collision pair of two links enabled, even if a file or a sampling disabled it. A link paired
    /// with itself is ignored.
    ///
    /// # Errors
    /// As [`with_ignored`](Self::with_ignored).
    pub fn with_checked<'a>(
        mut self,
        a: impl Into<FrameRef<'a>>,
        b: impl Into<FrameRef<'a>>,
    ) -> Result<Self, UnknownName> {
        let pair = self.pair(a.into(), b.into())?;
        self.allow_planes(pair, false);
        let have_shapes = pair.iter().all(|link| self.links.contains(link));
        let differ = pair[0] != pair[1] && have_shapes;
        if let (Err(at), true) = (self.pairs.binary_search(&pair), differ) {
            self.pairs.insert(at, pair);
        }
        Ok(self)
    }

    /// The model without the pairs that an SRDF file disables. Links without shapes are ignored.
    #[must_use]
    pub fn with_srdf(mut self, srdf: &Srdf) -> Self {
        for disabled in &srdf.disabled_pairs {
            let pair = ordered(disabled.links);
            self.pairs.retain(|other| *other != pair);
            self.allow_planes(pair, true);
        }
        self
    }

    /// True if the collision pair of two links is enabled.
    ///
    /// # Errors
    /// As [`with_ignored`](Self::with_ignored).
    pub fn is_checked<'a>(
        &self,
        a: impl Into<FrameRef<'a>>,
        b: impl Into<FrameRef<'a>>,
    ) -> Result<bool, UnknownName> {
        let pair = self.pair(a.into(), b.into())?;
        Ok(self.pairs.binary_search(&pair).is_ok() || self.is_plane_checked(pair))
    }

    fn pair(&self, a: FrameRef<'_>, b: FrameRef<'_>) -> Result<[FrameId; 2], UnknownName> {
        let hint = "a world's `allow_collision` allows collisions of obstacles";
        let link = |link| self.link(link).map_err(|unknown| unknown.with_note(hint));
        Ok(ordered([link(a)?, link(b)?]))
    }
}

fn ordered([a, b]: [FrameId; 2]) -> [FrameId; 2] {
    [a.min(b), a.max(b)]
}
