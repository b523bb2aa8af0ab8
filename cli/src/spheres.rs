//! `kinopt spheres`: spheres that cover the shapes of a robot.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use kinopt::collision::{CollisionModel, Resolution, SphereModel};
use kinopt::counted;
use serde::Serialize;

use crate::collision_options::CollisionOptions;
use crate::failure::Outcome;
use crate::file_access;
use crate::help_headings::OUTPUT;
use crate::loaded_model::LoadedModel;
use crate::model_options::ModelOptions;
use crate::number_list;
use crate::output;
use crate::table::Table;

const EXAMPLES: &str = "\
Examples:
  kinopt spheres robot.urdf --out spherised.urdf     the same robot, of spheres that stick out by a
                                                     fiftieth of its reach at most
  kinopt spheres robot.urdf --max-protrusion 0.02 --out spheres.yml
                                                     by 2 cm, for cuRobo
  kinopt spheres robot.urdf --spheres 6 --package /opt/ros/jazzy/share --out spheres.yml
                                                     at most six a link, meshes of ROS packages";

/// The largest protrusion, unless given, as a share of the robot's reach.
const SHARE: f64 = 0.02;
/// And where a link is too large for that, as a share of the radius around the largest shape.
const SHARE_OF_LARGEST: f64 = 0.05;
/// So often it is doubled at most.
const DOUBLINGS: usize = 40;

/// Covers a robot's collision shapes with spheres, for fast checks here and elsewhere.
///
/// Every point of every shape lies in a sphere of its link, and no sphere sticks out of the shapes further than
/// is said. Links whose shapes are spheres keep them. Which links are checked against each other is told: all but
/// those joined to each other, those that --srdf disables, and those that cannot touch or nearly always do in random
/// configurations.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The robot's .urdf or MJCF .xml file.
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,

    /// Where to write: .urdf (the robot with spheres for its collision shapes, as foam and VAMP have it) or
    /// .yml (cuRobo's collision_spheres).
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    out: PathBuf,

    /// What to write, whatever the file's name ends in. Default: as it ends.
    #[arg(long, help_heading = OUTPUT)]
    format: Option<Format>,

    /// As few spheres as are found that stick out by at most this, in metres. Default: a fiftieth of
    /// the robot's reach, and more where a link is too large for that.
    #[arg(long, value_name = "METRES", value_parser = number_list::number, conflicts_with = "spheres")]
    max_protrusion: Option<f64>,

    /// At most so many spheres a link, sticking out as little as is found. Default: as --max-protrusion.
    #[arg(long, value_name = "N")]
    spheres: Option<usize>,

    /// Write which links may touch as an SRDF file. Default: do not.
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    save_srdf: Option<PathBuf>,

    #[command(flatten)]
    collisions: CollisionOptions,

    #[command(flatten)]
    model_options: ModelOptions,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// The robot's URDF with spheres for its collision shapes.
    Urdf,
    /// cuRobo's collision_spheres.
    #[value(alias = "yml")]
    Yaml,
}

#[derive(Serialize)]
struct Document<'a> {
    out: &'a Path,
    spheres: usize,
    max_protrusion: f64,
    links: Vec<Link<'a>>,
    pairs: Vec<[&'a str; 2]>,
    notes: &'a [String],
}

#[derive(Serialize)]
struct Link<'a> {
    name: &'a str,
    spheres: usize,
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let format = arguments.format()?;
    let path = &arguments.robot;
    let loaded = LoadedModel::read(path, &arguments.model_options)?;
    let robot = loaded.robot_with_shapes("spheres")?;
    let model = (arguments.collisions).model(robot, &arguments.model_options)?;
    let spheres = match (arguments.max_protrusion, arguments.spheres) {
        (Some(max_protrusion), _) => {
            SphereModel::of(&model, Resolution::MaxProtrusion(max_protrusion))
                .map_err(|wrong| failure!("--max-protrusion {max_protrusion}: {}", wrong.allowed))?
        }
        (_, Some(count)) => SphereModel::of(&model, Resolution::PerLink(count))
            .map_err(|wrong| failure!("--spheres {count}: {}", wrong.allowed))?,
        _ => as_fine_as_may_be(&model, robot.model().reach())?,
    };
    let text = match format {
        Format::Yaml => spheres.to_yaml(),
        Format::Urdf => {
            let file = path.display().to_string();
            let urdf = file_access::text(path)?;
            spheres.spherised(&urdf, &file)?
        }
    };
    output::write_file(&arguments.out, &text)?;
    if let Some(path) = &arguments.save_srdf {
        output::write_file(path, model.to_srdf())?;
    }
    report(arguments, &model, &spheres, json)
}

/// Spheres that stick out by a fiftieth of the reach, or where a link is too large for that by a share of the largest.
fn as_fine_as_may_be(model: &CollisionModel, reach: f64) -> Outcome<SphereModel> {
    // A robot with a single revolute joint may have reach 0, but has shapes.
    let finest = match reach > 0.0 && reach.is_finite() {
        true => SHARE * reach,
        false => SHARE,
    };
    let sizes = model.objects().iter();
    let largest = sizes
        .map(|object| object.shape.bounding_sphere().radius)
        .fold(0.0, f64::max);
    let mut max_protrusion = finest;
    for _ in 0..DOUBLINGS {
        if let Ok(spheres) = SphereModel::of(model, Resolution::MaxProtrusion(max_protrusion)) {
            if max_protrusion > finest {
                output::message(&format!(
                    "note: the spheres stick out by up to {max_protrusion} m: some link is too large for {finest} m, a fiftieth of the reach"
                ));
            }
            return Ok(spheres);
        }
        max_protrusion = (2.0 * max_protrusion).max(SHARE_OF_LARGEST * largest);
    }
    Ok(SphereModel::of(
        model,
        Resolution::MaxProtrusion(max_protrusion),
    )?)
}

fn report(
    arguments: &Arguments,
    model: &CollisionModel,
    spheres: &SphereModel,
    json: bool,
) -> Outcome<()> {
    let groups = spheres.groups();
    let pairs = || {
        spheres
            .pairs()
            .iter()
            .map(|pair| pair.map(|at| groups[at].name.as_str()))
    };
    let document = || Document {
        out: &arguments.out,
        spheres: spheres.count(),
        max_protrusion: spheres.max_protrusion(),
        links: (groups.iter())
            .map(|group| Link {
                name: &group.name,
                spheres: group.spheres.len(),
            })
            .collect(),
        pairs: pairs().collect(),
        notes: model.notes(),
    };
    let text = || {
        let mut table = Table::new("link | >spheres | checked against");
        for (index, group) in groups.iter().enumerate() {
            let others = spheres.pairs().iter().filter_map(|[a, b]| match index {
                _ if *a == index => Some(groups[*b].name.as_str()),
                _ if *b == index => Some(groups[*a].name.as_str()),
                _ => None,
            });
            let others: Vec<&str> = others.collect();
            table.row([
                group.name.clone(),
                group.spheres.len().to_string(),
                others.join(", "),
            ]);
        }
        let count = counted(spheres.count(), "sphere");
        let pairs = match spheres.pairs().len() {
            1 => "1 pair of links is checked".to_owned(),
            count => format!("{count} pairs of links are checked"),
        };
        let millimetres = 1e3 * spheres.max_protrusion();
        format!(
            "{count} on {}, sticking out by {millimetres:.1} mm at most; {pairs}\n\n{}\n{} written\n",
            counted(groups.len(), "link"),
            table.text(),
            arguments.out.display(),
        )
    };
    output::result(json, document, text)
}

impl Arguments {
    fn format(&self) -> Outcome<Format> {
        let end = self.out.extension().and_then(|end| end.to_str());
        let by_name = match end.map(str::to_ascii_lowercase).as_deref() {
            Some("urdf") => Some(Format::Urdf),
            Some("yml" | "yaml") => Some(Format::Yaml),
            _ => None,
        };
        let format = self.format.or(by_name).ok_or_else(|| {
            let out = self.out.display();
            usage!("{out}: the name must end in .urdf or .yml, or --format say what to write")
        })?;
        let is_urdf = self
            .robot
            .extension()
            .is_some_and(|end| end.eq_ignore_ascii_case("urdf"));
        match format == Format::Urdf && !is_urdf {
            true => Err(usage!(
                "{}: only a URDF robot can be written as .urdf; take .yml",
                self.robot.display()
            )),
            false => Ok(format),
        }
    }
}
