//! Mechanisms with loops, and their closed-form solutions.

use kinopt::model::{FrameId, JointId, Limits, Loop, Model, ModelBuilder};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::random::Random;

/// Wide range for rotations.
pub(crate) const ROTATION_LIMITS: Limits = Limits {
    lower: -4.0,
    upper: 4.0,
};

pub(crate) fn along_x(length: f64) -> Placement<f64> {
    Placement::translation(Vector3::new(length, 0.0, 0.0))
}

/// Planar four-bar linkage: ground, crank, coupler, rocker, and a point off the coupler.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FourBar {
    pub(crate) ground: f64,
    pub(crate) crank: f64,
    pub(crate) coupler: f64,
    pub(crate) rocker: f64,
}

impl FourBar {
    /// The crank rotates fully (Grashof: shortest + longest < sum of the others).
    pub(crate) const CRANK_ROCKER: Self = Self {
        ground: 0.4,
        crank: 0.12,
        coupler: 0.35,
        rocker: 0.3,
    };

    /// Adds the joints `crank`, `coupler` and `rocker`, the frame `pen` 0.1 m off the coupler's middle, and the loop
    /// `pin`.
    pub(crate) fn add_to(&self, builder: &mut ModelBuilder, on: Option<JointId>) -> [JointId; 3] {
        let z = Vector3::new(0.0, 0.0, 1.0);
        let crank = builder.revolute("crank", on, along_x(0.0), z, ROTATION_LIMITS);
        let coupler = builder.revolute(
            "coupler",
            Some(crank),
            along_x(self.crank),
            z,
            ROTATION_LIMITS,
        );
        let rocker = builder.revolute("rocker", on, along_x(self.ground), z, ROTATION_LIMITS);
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

    /// K₁ cos θ₄ − K₂ cos θ₂ + K₃ − cos(θ₂ − θ₄). It is zero if the loop is closed with the crank at θ₂ and the rocker
    /// at θ₄ (Freudenstein 1954).
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

/// Stewart platform: six prismatic legs between a ground and a free platform, each on a universal joint below and a
/// ball joint above.
pub(crate) struct Stewart {
    pub(crate) model: Model,
    pub(crate) platform: FrameId,
    pub(crate) slides: Vec<JointId>,
    /// Revolute joints of the universal joints.
    pub(crate) hinges: Vec<JointId>,
    /// Anchor points below and above.
    pub(crate) anchors: Vec<[Vector3<f64>; 2]>,
}

impl Stewart {
    pub(crate) fn new() -> Self {
        let mut builder = Model::builder("stewart");
        let base = builder.free("platform", None, along_x(0.0), [Limits::new(-2.0, 2.0); 3]);
        let platform = builder.frame("platform", Some(base), along_x(0.0));
        let on_circle = |radius: f64, degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            Vector3::new(radius * cos, radius * sin, 0.0)
        };
        let [x, y, z] = Vector3::UNITS;
        let (mut slides, mut hinges, mut anchors) = (Vec::new(), Vec::new(), Vec::new());
        for leg in 0..6 {
            let pair = 120.0 * f64::from(leg / 2);
            let side = if leg % 2 == 0 { -1.0 } else { 1.0 };
            let below = on_circle(0.5, pair + side * 15.0);
            let above = on_circle(0.3, pair + side * 45.0);
            let tilt = Limits::new(-1.5, 1.5);
            let at = Placement::translation(below);
            let first = builder.revolute(format!("leg {leg}/x"), None, at, x, tilt);
            let second =
                builder.revolute(format!("leg {leg}/y"), Some(first), along_x(0.0), y, tilt);
            let name = format!("leg {leg}");
            let slide =
                builder.prismatic(&name, Some(second), along_x(0.0), z, Limits::new(0.2, 1.5));
            let ends = [
                builder.frame(format!("{name}/end"), Some(slide), along_x(0.0)),
                platform,
            ];
            let places = [along_x(0.0), Placement::translation(above)];
            builder.close(Loop::connect(name, ends).at(places));
            slides.push(slide);
            hinges.extend([first, second]);
            anchors.push([below, above]);
        }
        Self {
            model: builder.build().unwrap(),
            platform,
            slides,
            hinges,
            anchors,
        }
    }

    /// Leg lengths for a pose of the platform: closed-form inverse kinematics.
    pub(crate) fn lengths(&self, platform: &Placement<f64>) -> Vec<f64> {
        let ends = self.anchors.iter();
        ends.map(|[below, above]| (platform.apply(*above) - *below).norm())
            .collect()
    }

    /// A pose well within the legs' range.
    pub(crate) fn pose(random: &mut Random) -> Placement<f64> {
        let mut within = |size: f64| random.within(-size, size);
        let turn = Vector3::new(within(0.3), within(0.3), within(0.4));
        let at = Vector3::new(within(0.12), within(0.12), 0.7 + within(0.15));
        Placement::new(rotation_exp(turn), at)
    }
}

/// Gripper without coupled joints: a prismatic joint pushes rods that rotate a parallelogram on either side, whose
/// coupler is the finger.
pub(crate) struct Gripper;

impl Gripper {
    /// Distances: the arms' pivots from the middle, along the arms, between the arms of a side, to the rod's hole. Then
    /// the rods' length.
    pub(crate) const SIZES: [f64; 5] = [0.03, 0.06, 0.02, 0.025, 0.055];

    pub(crate) fn model() -> Model {
        let [out, arm, between, hole, rod] = Self::SIZES;
        let mut builder = Model::builder("gripper");
        let z = Vector3::new(0.0, 0.0, 1.0);
        let at = |x: f64, y: f64| Placement::translation(Vector3::new(x, y, 0.0));
        let push = builder.prismatic(
            "push",
            None,
            at(0.0, 0.0),
            Vector3::UNITS[1],
            Limits::new(-0.1, 0.06),
        );
        for (side, s) in [("left", -1.0), ("right", 1.0)] {
            // At zero the arms point sideways.
            let turn = Limits::new(-1.4, 1.4);
            let mut add = |name: &str, on, placement| {
                let axis = z * s;
                builder.revolute(format!("{side} {name}"), on, placement, axis, turn)
            };
            let crank = add("crank", None, at(s * out, 0.0));
            let second = add("second", None, at(s * out, between));
            let finger = add("finger", Some(crank), at(s * arm, 0.0));
            let link = builder.revolute(
                format!("{side} rod"),
                Some(push),
                at(0.0, 0.0),
                z * s,
                Limits::new(-3.0, 3.0),
            );
            let mut frame = |name: &str, on, placement| {
                builder.frame(format!("{side} {name}"), Some(on), placement)
            };
            let holes = [
                frame("finger hole", finger, at(0.0, between)),
                frame("second end", second, at(s * arm, 0.0)),
            ];
            let pins = [
                frame("rod end", link, at(s * rod, 0.0)),
                frame("crank hole", crank, at(s * hole, 0.0)),
            ];
            frame("tip", finger, at(0.0, 0.08));
            builder.close(Loop::connect(format!("{side} parallelogram"), holes));
            builder.close(Loop::connect(format!("{side} push"), pins));
        }
        builder.build().unwrap()
    }
}
