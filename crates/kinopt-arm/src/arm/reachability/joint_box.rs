//! Box of joint values.

/// Largest number of free joints of an arm for which unreachability can be proven.
pub(super) const MAX_ARM_JOINTS: usize = 8;
/// Largest number of joints of a chain: those of an arm, and three translations and three rotations for the coordinates
/// of a cell of poses.
pub(super) const MAX_JOINTS: usize = MAX_ARM_JOINTS + 6;

/// Joint values within `centre` ± `half_width`, radians or metres. Values beyond the chain's joints are 0.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct JointBox {
    pub(super) centre: [f64; MAX_JOINTS],
    pub(super) half_width: [f64; MAX_JOINTS],
}

impl JointBox {
    /// The lower and the upper half in one joint.
    pub(super) fn halves(self, joint: usize) -> [Self; 2] {
        let half = 0.5 * self.half_width[joint];
        [-half, half].map(|offset| {
            let mut part = self;
            part.centre[joint] += offset;
            part.half_width[joint] = half;
            part
        })
    }

    /// The part from `lower` to `upper` of one joint, as fractions from −1 to 1 of its half width.
    pub(super) fn narrow(&mut self, joint: usize, lower: f64, upper: f64) {
        let half_width = self.half_width[joint];
        self.centre[joint] += half_width * 0.5 * (lower + upper);
        self.half_width[joint] = half_width * 0.5 * (upper - lower);
    }

    /// Product of the ratios of the half widths of `self` to those of a larger box.
    pub(super) fn volume_ratio(&self, larger: &Self) -> f64 {
        let widths = self.half_width.iter().zip(&larger.half_width);
        let ratios = widths.map(|(width, larger)| match *larger > 0.0 {
            true => width / larger,
            false => 1.0,
        });
        ratios.product()
    }
}
