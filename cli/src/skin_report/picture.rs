//! Picture of a skin report.

use kinopt::skinning::SkinningMethod;
use kinopt_charts::{Axis, Chart, Figure};

use super::Subject;
use crate::failure::Outcome;

impl Subject {
    /// Chart of volumes up to `furthest` degrees, and of the tube's outline at that angle.
    pub(super) fn picture(&self, furthest: f64) -> Outcome<Figure> {
        const STEPS: u32 = 36;
        let mut volumes = Chart::new("Volume kept")
            .x(Axis::linear("twist, degrees"))
            .y(Axis::linear("volume, %").range(0.0, 105.0));
        let mut outline = Chart::new(format!("Radius at {furthest} degrees"))
            .x(Axis::linear("position along the tube"))
            .y(Axis::linear("radius").range(0.0, 1.05 * self.tube.radius));
        for method in SkinningMethod::ALL {
            let mut points = Vec::new();
            for step in 0..=STEPS {
                let degrees = furthest * f64::from(step) / f64::from(STEPS);
                points.push((degrees, 100.0 * self.kept(method, degrees)?.volume));
            }
            volumes = volumes.series(method.name(), points);
            let posed = self.posed(method, furthest)?;
            outline = outline.series(method.name(), self.tube.ring_radii(&posed));
        }
        let figure = Figure::new("A tube of two bones, twisted");
        Ok(figure.chart(volumes).chart(outline))
    }
}
