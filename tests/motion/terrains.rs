//! Promise: a motion is moved onto steps and slopes. Heights follow the ground, and feet tilt with it.

use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::retarget::{
    BodyMap, Capture, RetargetOptions, Retargeting, Terrain, TerrainPatch, UpAxis,
};
use support::arms::floating_nao;
use support::fault_tables::ExpectedError;

fn patch(height: f64, slope: f64) -> TerrainPatch {
    TerrainPatch {
        centre: [0.0, 0.0, height],
        size: [50.0, 50.0],
        heading: 0.0,
        slope,
    }
}

fn retargeted(
    terrain: Option<Terrain>,
) -> kinopt::motion::Trajectory<kinopt::motion::retarget::RetargetReport> {
    let robot = floating_nao();
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let capture = Capture::of_clip(&read.armature, &read.clip, 30.0).unwrap();
    let map = BodyMap::guess(&capture, robot.model()).unwrap().map;
    let options = RetargetOptions::default()
        .with_up(UpAxis::Y)
        .with_terrain(terrain);
    let retargeting = Retargeting::new(&robot, &map, &capture, options).unwrap();
    retargeting.per_frame().unwrap()
}

#[test]
fn raised_ground_raises_the_whole_motion() {
    let height = 0.3;
    let (level, raised) = (
        retargeted(None),
        retargeted(Some(Terrain::new(vec![patch(height, 0.0)]).unwrap())),
    );
    for (level, raised) in level.rows().zip(raised.rows()) {
        for (k, (a, b)) in level.iter().zip(raised).enumerate() {
            let expected = if k == 2 { a + height } else { *a };
            assert!((b - expected).abs() < 1e-3, "coordinate {k}: {a} {b}");
        }
    }
}

#[test]
fn feet_tilt_with_a_slope() {
    let slope: f64 = 0.15;
    let found = retargeted(Some(Terrain::new(vec![patch(0.0, slope)]).unwrap()));
    assert!(found.report.slip < 1e-3, "{} m", found.report.slip);
    assert!(
        found.report.ground_penetration < 3e-3,
        "{} m",
        found.report.ground_penetration
    );
    let robot = floating_nao();
    let model = robot.model();
    let feet = ["left_foot", "right_foot"].map(|foot| model.frame(foot).unwrap());
    let mut kinematics = ForwardKinematics::of_frames(model, &feet).unwrap();
    let q = found.rows().last().unwrap();
    for placed in kinematics.place(q).unwrap() {
        // The slope rises along x: its normal is (-sin, 0, cos).
        let (up, expected) = (placed.rotation.z, [-slope.sin(), 0.0, slope.cos()]);
        for (value, expected) in up.to_array().into_iter().zip(expected) {
            assert!((value - expected).abs() < 0.06, "{up:?}");
        }
    }
}

#[test]
fn highest_patch_counts_and_outside_is_level() {
    let step = TerrainPatch {
        centre: [1.0, 0.0, 0.2],
        size: [1.0, 2.0],
        heading: 0.0,
        slope: 0.0,
    };
    let ramp = TerrainPatch {
        centre: [0.0, 3.0, 0.5],
        size: [2.0, 2.0],
        heading: std::f64::consts::FRAC_PI_2,
        slope: 0.25,
    };
    let terrain = Terrain::new(vec![step, ramp]).unwrap();
    assert_eq!(terrain.height(1.2, 0.5), 0.2);
    assert_eq!(terrain.height(3.0, 0.0), 0.0);
    // The ramp rises along y.
    assert!((terrain.height(0.0, 3.8) - (0.5 + 0.8 * 0.25_f64.tan())).abs() < 1e-12);
    let text = r#"{"patches": [{"centre": [1.0, 0.0, 0.2], "size": [1.0, 2.0]}]}"#;
    assert_eq!(Terrain::from_json(text).unwrap().patches(), [step]);
    Terrain::from_json(r#"{"patches": [{"centre": [0, 0, 0], "size": [0, 1]}]}"#).says("size");
    Terrain::from_json(r#"{"patch": []}"#).says("patch");
}
