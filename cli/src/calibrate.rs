//! `kinopt calibrate`: kinematic parameters of an arm from measurements.

use std::path::PathBuf;

use clap::Args;
use kinopt::calibration::{Calibrated, Calibration, Measurements, Noise, ParameterSet};
use kinopt::counted;
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use kinopt_bindings::placement::PoseTarget;
use kinopt_bindings::problem_file::number_list;
use serde::Serialize;

use crate::failure::Outcome;
use crate::file_access;
use crate::frame_report::FramePlacement;
use crate::help_headings::OUTPUT;
use crate::output;
use crate::table::Table;

const EXAMPLES: &str = "\
Examples:
  kinopt calibrate ur5e.urdf measured.csv --base base --tip flange --out calibrated.urdf
  kinopt calibrate ur5e.urdf points.csv --base base --tip flange --parameters joint_offsets,base,tool

A row of the CSV file is a measurement: the joint positions from base to tip, then x, y, z of the
tip, or x, y, z, qw, qx, qy, qz. A first row with names is skipped. The frame of the measurements
may differ from the base. Guide: docs/guide/calibration.md.";

/// Estimate joint offsets and link parameters of an arm from measured poses or points.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Robot file: .urdf.
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,

    /// CSV file of measurements.
    #[arg(value_name = "MEASUREMENTS")]
    measurements: PathBuf,

    /// Link below which the tip is mounted.
    #[arg(long, value_name = "FRAME")]
    base: String,

    /// Measured frame.
    #[arg(long, value_name = "FRAME")]
    tip: String,

    /// Estimated parts: joint_offsets, link_positions, link_rotations, base, tool. Default: all.
    #[arg(long, value_name = "PART,…", value_delimiter = ',', value_parser = PARTS)]
    parameters: Vec<String>,

    /// Standard deviation of positions in metres. Default: estimated.
    #[arg(long, value_name = "M", value_parser = number_list::positive, requires = "angle_noise")]
    position_noise: Option<f64>,

    /// Standard deviation of orientations in radians. Default: estimated.
    #[arg(long, value_name = "RAD", value_parser = number_list::positive, requires = "position_noise")]
    angle_noise: Option<f64>,

    /// Write the calibrated robot as URDF.
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    out: Option<PathBuf>,
}

const PARTS: [&str; 5] = [
    "joint_offsets",
    "link_positions",
    "link_rotations",
    "base",
    "tool",
];

#[derive(Serialize)]
struct Document {
    position_rms_before: f64,
    position_rms: f64,
    orientation_rms: f64,
    noise: [f64; 2],
    outliers: Vec<usize>,
    device_from_base: FramePlacement,
    tip_from_tool: FramePlacement,
    urdf_has_tool: bool,
    parameters: Vec<ParameterDocument>,
}

#[derive(Serialize)]
struct ParameterDocument {
    name: String,
    value: f64,
    standard_deviation: f64,
    determined: bool,
}

impl Document {
    fn of(fit: &Calibrated) -> Self {
        let parameters = fit.parameters.iter().map(|parameter| ParameterDocument {
            name: parameter.name.clone(),
            value: parameter.value,
            standard_deviation: parameter.standard_deviation,
            determined: parameter.is_determined,
        });
        Self {
            position_rms_before: fit.before.position,
            position_rms: fit.after.position,
            orientation_rms: fit.after.angle,
            noise: [fit.noise.position, fit.noise.angle],
            outliers: fit.outliers.clone(),
            device_from_base: (&fit.device_from_base).into(),
            tip_from_tool: (&fit.tip_from_tool).into(),
            urdf_has_tool: fit.urdf_has_tool(),
            parameters: parameters.collect(),
        }
    }
}

/// Measured rows: configurations, and poses or points.
struct Measured {
    q: Vec<f64>,
    poses: Vec<Placement<f64>>,
    points: Vec<Vector3<f64>>,
}

/// Reads the rows of a CSV file, whose first row may be names.
fn read(text: &str, file: &str, joints: usize) -> Outcome<Measured> {
    let mut measured = Measured {
        q: Vec::new(),
        poses: Vec::new(),
        points: Vec::new(),
    };
    let mut columns = None;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let numbers: Result<Vec<f64>, _> =
            line.split(',').map(|cell| cell.trim().parse()).collect();
        let row = match numbers {
            Ok(row) => row,
            Err(_) if columns.is_none() => {
                columns = Some(line.split(',').count());
                continue;
            }
            Err(error) => return Err(failure!("{file}:{}: {error}", index + 1)),
        };
        if *columns.get_or_insert(row.len()) != row.len() {
            return Err(failure!(
                "{file}:{}: {} numbers, the first row has {}",
                index + 1,
                row.len(),
                columns.unwrap_or(0)
            ));
        }
        let Some((q, tip)) = row.split_at_checked(joints) else {
            return Err(failure!(
                "{file}:{}: {} numbers, expected {joints} joint positions and those of the tip",
                index + 1,
                row.len()
            ));
        };
        let located = |problem| failure!("{file}:{}: after {joints} joints: {problem}", index + 1);
        let tip = PoseTarget::of_numbers(tip).map_err(located)?;
        match tip.has_orientation {
            true => measured.poses.push(tip.placement),
            false => measured.points.push(tip.placement.translation),
        }
        measured.q.extend(q);
    }
    Ok(measured)
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let file = arguments.robot.display().to_string();
    let text = String::from_utf8(file_access::allowed().read(&arguments.robot)?)
        .map_err(|_| failure!("{file}: is not UTF-8 text"))?;
    let robot = Robot::parse(&text, &file)?;
    let mut calibration = Calibration::new(&robot, &*arguments.base, &*arguments.tip)?;
    if !arguments.parameters.is_empty() {
        let has = |part: &str| arguments.parameters.iter().any(|name| name == part);
        calibration = calibration.with_parameters(ParameterSet {
            joint_offsets: has("joint_offsets"),
            link_positions: has("link_positions"),
            link_rotations: has("link_rotations"),
            base: has("base"),
            tool: has("tool"),
        });
    }
    let noise = arguments.position_noise.zip(arguments.angle_noise);
    calibration = calibration.with_noise(noise.map(|(position, angle)| Noise { position, angle }));

    let measurements = file_access::allowed().read(&arguments.measurements)?;
    let name = arguments.measurements.display().to_string();
    let rows = String::from_utf8_lossy(&measurements);
    let measured = read(&rows, &name, calibration.joints().len())?;
    let fit = match measured.poses.is_empty() {
        true => calibration.fit(&measured.q, Measurements::Points(&measured.points))?,
        false => calibration.fit(&measured.q, Measurements::Poses(&measured.poses))?,
    };
    if let Some(out) = &arguments.out {
        output::write_file(out, fit.urdf(&text, &file)?)?;
    }
    output::result(json, || Document::of(&fit), || report(&fit))
}

fn report(fit: &Calibrated) -> String {
    let mm = |metres: f64| format!("{:.3} mm", 1e3 * metres);
    let mut text = format!(
        "Position error {} before, {} after. Noise {} and {:.4}°.\n",
        mm(fit.before.position),
        mm(fit.after.position),
        mm(fit.noise.position),
        fit.noise.angle.to_degrees()
    );
    if !fit.outliers.is_empty() {
        let rows: Vec<String> = fit.outliers.iter().map(ToString::to_string).collect();
        let outliers = counted(fit.outliers.len(), "outlier");
        text += &format!("{outliers}: measurement {}.\n", rows.join(", "));
    }
    let mut table = Table::new("parameter | >deviation | >standard deviation | determined");
    for parameter in &fit.parameters {
        let shown = |value: f64| match parameter.name.contains(" position") {
            true => mm(value),
            false => format!("{:.4}°", value.to_degrees()),
        };
        table.row([
            parameter.name.clone(),
            shown(parameter.value),
            shown(parameter.standard_deviation),
            if parameter.is_determined { "yes" } else { "no" }.to_owned(),
        ]);
    }
    text + "\n" + &table.text()
}
