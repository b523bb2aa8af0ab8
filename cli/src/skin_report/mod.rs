//! `kinopt skin-report`: volume and radius of a twisted tube.

use std::path::PathBuf;

use clap::Args;
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{MeshWeights, SkinningMethod, TwistedTube};
use serde::Serialize;

use crate::animated_armature::extension;
use crate::failure::Outcome;
use crate::number_format::three_digits;
use crate::number_list::Numbers;
use crate::output;
use crate::table::Table;

#[cfg(feature = "charts")]
mod picture;

const EXAMPLES: &str = "\
Examples:
  kinopt skin-report                        the table
  kinopt skin-report --out twist.svg        the table and a chart
  kinopt skin-report --twists 0,30,60 --json";

#[cfg(not(feature = "charts"))]
const LEFT_OUT: &str = "--out: charts need a build with the feature `charts`: \
    cargo run --release -p kinopt-cli --features charts -- skin-report --out twist.svg";

/// Volume of a twisted tube under each skinning method.
///
/// A closed tube of radius 1 and length 8 follows two bones; the weights blend linearly along its middle half. One bone
/// is fixed, the other twists about the tube's axis. Volumes are percentages of the rest volume. The waist is the
/// smallest radius of a ring.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Twists in degrees, −180 to 180.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true,
          default_value = "0,45,90,135,180", value_parser = Numbers::parse)]
    twists: Numbers,

    /// Write a chart of volumes and radii as .svg; needs the feature `charts`. Default: no file.
    #[arg(long, value_name = "FILE", value_parser = picture_file)]
    out: Option<PathBuf>,
}

fn picture_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match extension(&path).as_str() {
        "svg" => Ok(path),
        _ => Err("charts are written as .svg".to_owned()),
    }
}

#[derive(Serialize)]
struct Document<'a> {
    radius: f64,
    length: f64,
    blended_share: f64,
    vertices: usize,
    twists: &'a [Row],
}

#[derive(Serialize)]
struct Row {
    degrees: f64,
    lbs: Kept,
    dqs: Kept,
}

/// Ratios to the tube at rest.
#[derive(Clone, Copy, Serialize)]
struct Kept {
    volume: f64,
    waist: f64,
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let Numbers(twists) = &arguments.twists;
    if twists.is_empty() {
        return Err(usage!("--twists: at least one is needed"));
    }
    if let Some(beyond) = twists.iter().find(|twist| twist.abs() > 180.0) {
        return Err(usage!(
            "--twists: {beyond} degrees is outside [-180, 180], the range of dual quaternions"
        ));
    }
    #[cfg(not(feature = "charts"))]
    if arguments.out.is_some() {
        return Err(failure!("{LEFT_OUT}"));
    }
    let subject = Subject::new(TwistedTube::default())?;
    let rows = twists.iter().map(|&degrees| {
        Ok(Row {
            degrees,
            lbs: subject.kept(SkinningMethod::LinearBlend, degrees)?,
            dqs: subject.kept(SkinningMethod::DualQuaternion, degrees)?,
        })
    });
    let rows = rows.collect::<Outcome<Vec<Row>>>()?;
    let document = || Document {
        radius: subject.tube.radius,
        length: subject.tube.length,
        blended_share: subject.tube.blended_share,
        vertices: subject.rest.positions().len(),
        twists: &rows,
    };
    output::result(json, document, || table(&rows))?;
    #[cfg(feature = "charts")]
    if let Some(path) = &arguments.out {
        let furthest = twists.iter().map(|twist| twist.abs()).fold(0.0, f64::max);
        subject.picture(furthest)?.write_svg(path)?;
        output::message(&format!("wrote {}", path.display()));
    }
    Ok(())
}

fn table(rows: &[Row]) -> String {
    let mut table = Table::new(">twist, ° | >volume lbs, % | >dqs, % | >waist lbs, % | >dqs, %");
    let percent = |share: f64| three_digits(100.0 * share);
    for row in rows {
        table.row([
            three_digits(row.degrees),
            percent(row.lbs.volume),
            percent(row.dqs.volume),
            percent(row.lbs.waist),
            percent(row.dqs.waist),
        ]);
    }
    table.text()
}

/// Tube with its rest mesh, weights and volume.
struct Subject {
    tube: TwistedTube,
    rest: TriangleMesh,
    weights: MeshWeights,
    volume: f64,
}

impl Subject {
    fn new(tube: TwistedTube) -> Outcome<Self> {
        let rest = tube.mesh()?;
        let weights = tube.weights()?.into();
        let volume = rest.signed_volume();
        Ok(Self {
            tube,
            rest,
            weights,
            volume,
        })
    }

    fn posed(&self, method: SkinningMethod, degrees: f64) -> Outcome<TriangleMesh> {
        let transforms = TwistedTube::transforms(degrees.to_radians());
        Ok(self.weights.mesh(method, &self.rest, &transforms)?)
    }

    fn kept(&self, method: SkinningMethod, degrees: f64) -> Outcome<Kept> {
        let posed = self.posed(method, degrees)?;
        let radii = self.tube.ring_radii(&posed).into_iter();
        let waist = radii.fold(f64::INFINITY, |min, (_, radius)| min.min(radius));
        Ok(Kept {
            volume: posed.signed_volume() / self.volume,
            waist: waist / self.tube.radius,
        })
    }
}
