//! `kinopt spheres`: spheres that cover the shapes of a robot.

use std::path::{Path, PathBuf};

use clap::Args;
use kinopt::collision::{CollisionModel, Resolution, SphereModel};
use kinopt::counted;
use kinopt_bindings::problem_file::number_list;
use serde::Serialize;

use crate::animated_armature::extension;
use crate::collision_options::CollisionOptions;
use crate::failure::Outcome;
use crate::file_access;
use crate::help_headings::OUTPUT;
use crate::loaded_model::LoadedModel;
use crate::model_options::ModelOptions;
use crate::output;
use crate::table::Table;

const EXAMPLES: &str = "\
Examples:
  kinopt spheres robot.urdf --out spherised.urdf
  kinopt spheres robot.urdf --max-protrusion 0.02 --out spheres.yml
  kinopt spheres robot.urdf --spheres 6 --problem ros.json --out spheres.yml

Every point of every shape is in a sphere of its link. The report lists the enabled pairs of links.
ROS packages are keys of the --problem file: {\"collisions\": {\"package\": [\"/opt/ros/share\"]}}.";

/// Default maximum protrusion, as a share of the robot's reach.
const PROTRUSION_OF_REACH: f64 = 0.02;
/// Maximum protrusion for larger links, as a share of the radius around the largest shape.
const PROTRUSION_OF_LARGEST: f64 = 0.05;
/// Largest number of doublings of the maximum protrusion.
const DOUBLINGS: usize = 40;

/// Cover a robot's collision shapes with spheres, for fast collision checks.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Robot file: .urdf or MJCF .xml.
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,

    /// Output file: .urdf (robot of spheres) or .yml (cuRobo collision_spheres).
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    out: PathBuf,

    /// Maximum protrusion in metres. Default: 2 % of the reach, more for large links.
    #[arg(long, value_name = "METRES", value_parser = number_list::number, conflicts_with = "spheres")]
    max_protrusion: Option<f64>,

    /// Largest number of spheres a link, with small protrusion. Default: as --max-protrusion.
    #[arg(long, value_name = "N")]
    spheres: Option<usize>,

    /// Write the disabled pairs of links as an SRDF file. Default: no file.
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    save_srdf: Option<PathBuf>,

    #[command(flatten)]
    collisions: CollisionOptions,

    #[command(flatten)]
    model_options: ModelOptions,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    /// URDF of the robot with spheres as collision shapes.
    Urdf,
    /// cuRobo collision_spheres.
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
    let problem = arguments.model_options.problem()?;
    let loaded = LoadedModel::read(path, &problem.model)?;
    let robot = loaded.robot_with_shapes("spheres")?;
    let model = (arguments.collisions).model(robot, &problem)?;
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

/// Sphere model with a maximum protrusion of 2 % of the reach, or more for large links.
fn as_fine_as_may_be(model: &CollisionModel, reach: f64) -> Outcome<SphereModel> {
    // A robot with a single revolute joint may have reach 0, but has shapes.
    let finest = match reach > 0.0 && reach.is_finite() {
        true => PROTRUSION_OF_REACH * reach,
        false => PROTRUSION_OF_REACH,
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
                    "note: maximum protrusion {max_protrusion} m: a link is too large for {finest} m, 2 % of the reach"
                ));
            }
            return Ok(spheres);
        }
        max_protrusion = (2.0 * max_protrusion).max(PROTRUSION_OF_LARGEST * largest);
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
            let checked_links = spheres.pairs().iter().filter_map(|[a, b]| match index {
                _ if *a == index => Some(groups[*b].name.as_str()),
                _ if *b == index => Some(groups[*a].name.as_str()),
                _ => None,
            });
            let checked_links: Vec<&str> = checked_links.collect();
            table.row([
                group.name.clone(),
                group.spheres.len().to_string(),
                checked_links.join(", "),
            ]);
        }
        let count = counted(spheres.count(), "sphere");
        let pairs = match spheres.pairs().len() {
            1 => "1 pair of links is checked".to_owned(),
            count => format!("{count} pairs of links are checked"),
        };
        let millimetres = 1e3 * spheres.max_protrusion();
        format!(
            "{count} on {}, maximum protrusion {millimetres:.1} mm; {pairs}\n\n{}\n{} written\n",
            counted(groups.len(), "link"),
            table.text(),
            arguments.out.display(),
        )
    };
    output::result(json, document, text)
}

impl Arguments {
    fn format(&self) -> Outcome<Format> {
        let format = match extension(&self.out).as_str() {
            "urdf" => Format::Urdf,
            "yml" | "yaml" => Format::Yaml,
            _ => {
                let out = self.out.display();
                return Err(usage!("{out}: expected a name that ends in .urdf or .yml"));
            }
        };
        let is_urdf = extension(&self.robot) == "urdf";
        match format == Format::Urdf && !is_urdf {
            true => Err(usage!(
                "{}: only a URDF robot can be written as .urdf; use .yml",
                self.robot.display()
            )),
            false => Ok(format),
        }
    }
}
