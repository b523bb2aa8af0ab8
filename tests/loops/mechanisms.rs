//! Mechanisms with loops, and their closed forms.

use kinopt::model::{JointId, Limits, Loop, Model, ModelBuilder};
use kinopt::spatial::{Placement, Vector3};

/// Any angle.
pub(crate) const TURNS: Limits = Limits {
    lower: -4.0,
    upper: 4.0,
};

pub(crate) fn along_x(length: f64) -> Placement<f64> {
    Placement::translation(Vector3::new(length, 0.0, 0.0))
}

/// Four links in a plane: ground, crank, coupler, rocker. With it a point off the coupler.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FourBar {
    pub(crate) ground: f64,
    pub(crate) crank: f64,
    pub(crate) coupler: f64,
    pub(crate) rocker: f64,
}

impl FourBar {
    /// The crank turns all the way round (Grashof: shortest + longest < the others together).
    pub(crate) const CRANK_ROCKER: Self = Self {
        ground: 0.4,
        crank: 0.12,
        coupler: 0.35,
        rocker: 0.3,
    };

    /// Adds its joints `crank`, `coupler` and `rocker`, the frame `pen` 0.1 m beside the coupler's middle, and the
    /// loop `pin`.
    pub(crate) fn add_to(&self, builder: &mut ModelBuilder, on: Option<JointId>) -> [JointId; 3] {
        let z = Vector3::new(0.0, 0.0, 1.0);
        let crank = builder.revolute("crank", on, along_x(0.0), z, TURNS);
        let coupler = builder.revolute("coupler", Some(crank), along_x(self.crank), z, TURNS);
        let rocker = builder.revolute("rocker", on, along_x(self.ground), z, TURNS);
        let ends = [
            builder.frame("coupler end", Some(coupler), along_x(self.coupler)),
            builder.frame("rocker end", Some(rocker), along_x(self.rocker)),
        ];
        let pen = Vector3::new(self.coupler / 2.0, 0.1, 0.0);
        builder.frame("pen", Some(coupler), Placement::translation(pen));
        builder.close(Loop::connect("pin", ends));
        [crank, coupler, rocker]
    }

    pub(crate) fn model(&self) -> Model {
        let mut builder = Model::builder("four-bar");
        self.add_to(&mut builder, None);
        builder.build().unwrap()
    }

    /// K₁ cos θ₄ − K₂ cos θ₂ + K₃ − cos(θ₂ − θ₄), which is zero where the loop is closed with the crank at θ₂ and
    /// the rocker at θ₄ (Freudenstein 1954).
    pub(crate) fn freudenstein(&self, crank: f64, rocker: f64) -> f64 {
        let Self {
            ground: g,
            crank: a,
            coupler: b,
            rocker: c,
        } = *self;
        let (k1, k2) = (g / a, g / c);
        let k3 = (a * a - b * b + c * c + g * g) / (2.0 * a * c);
        k1 * rocker.cos() - k2 * crank.cos() + k3 - (crank - rocker).cos()
    }
}
