//! `--contact-speed`, `--contact-height`: thresholds of foot contacts.

use clap::Args;
use kinopt::motion::retarget::ContactDetection;

use crate::number_list::not_negative;

/// Thresholds of foot contacts.
#[derive(Args, Clone, Debug)]
pub(super) struct ContactOptions {
    /// Largest speed of a foot in contact, in m/s, for legs of 0.9 m. Scaled with the leg length. Range: ≥ 0.
    /// Default: 0.25.
    #[arg(long, value_name = "M/S", value_parser = not_negative)]
    contact_speed: Option<f64>,

    /// Largest height of a foot in contact above the ground, in metres. Range: ≥ 0. Default: any height, as on boxes.
    #[arg(long, value_name = "M", value_parser = not_negative)]
    contact_height: Option<f64>,
}

impl ContactOptions {
    pub(super) fn detection(&self) -> ContactDetection {
        let usual = ContactDetection::default();
        usual
            .with_speed(self.contact_speed.unwrap_or(usual.speed))
            .with_height(self.contact_height.unwrap_or(usual.height))
    }
}
