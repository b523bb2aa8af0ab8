//! `--contact-speed`, `--contact-height`: thresholds of foot contacts.

use clap::Args;
use kinopt::motion::retarget::ContactDetection;
use kinopt_bindings::problem_file::number_list::not_negative;

/// Thresholds of foot contacts.
#[derive(Args, Clone, Debug)]
pub(crate) struct ContactOptions {
    /// Largest speed of a foot in contact, for legs of 0.9 m. Default: 0.25.
    #[arg(long, value_name = "M/S", value_parser = not_negative)]
    contact_speed: Option<f64>,

    /// Largest height of a foot in contact. Default: any height.
    #[arg(long, value_name = "M", value_parser = not_negative)]
    contact_height: Option<f64>,
}

impl ContactOptions {
    pub(crate) fn detection(&self) -> ContactDetection {
        let usual = ContactDetection::default();
        usual
            .with_speed(self.contact_speed.unwrap_or(usual.speed))
            .with_height(self.contact_height.unwrap_or(usual.height))
    }
}
