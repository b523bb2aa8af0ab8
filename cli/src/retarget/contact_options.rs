//! `--contact-speed`, `--contact-height`: thresholds of foot contacts.

use clap::Args;
use kinopt::motion::retarget::ContactDetection;

use crate::number_list::not_negative;

/// Options about what stands.
#[derive(Args, Clone, Debug)]
pub(super) struct ContactOptions {
    /// A foot stands while it moves no faster than this, m/s, on legs of 0.9 m; on others as much slower as they are shorter.
    /// Default: 0.25.
    #[arg(long, value_name = "M/S", value_parser = not_negative)]
    contact_speed: Option<f64>,

    /// A foot stands where it is no higher over the ground than this, metres. Default: at any height, as on boxes.
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
