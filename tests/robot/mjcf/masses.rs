//! Promise: body masses equal those of MuJoCo 4.0.0, or a note names the mesh whose file is needed. No mass is dropped
//! silently.

use kinopt::model::ModelError;
use kinopt::robot::{Link, MissingInertia, Robot};
use kinopt::spatial::Vector3;

const TWO_GEOMS: &str =
    r#"<geom size=".1" pos="1 0 0"/><geom type="box" size=".1 .1 .1" group="3"/>"#;
const STATED_INERTIA: &str = r#"<inertial mass="2" pos="0 0 0" diaginertia="1 1 1"/>"#;
const MESH_ASSET: &str = r#"<asset><mesh name="m" file="m.stl"/></asset>"#;

fn robot(compiler: &str, body: &str) -> Robot {
    let text = format!(
        r#"<mujoco><compiler {compiler}/>{MESH_ASSET}<worldbody><geom size="1"/>
        <body name="stand"><geom size=".1"/></body><body name="a"><joint/>{body}</body></worldbody></mujoco>"#
    );
    Robot::parse_mjcf(&text, "weighs.xml").unwrap()
}

fn link(robot: &Robot) -> &Link {
    robot.link(robot.model().frame("a").unwrap()).unwrap()
}

/// Expected numbers are `body_mass` and the largest of `body_inertia`.
#[test]
fn masses_follow_groups_and_compiler_options() {
    let stand = 4.18879020478639;
    let both = 12.188790204786393;
    for (compiler, stated, mass, most) in [
        ("", "", both, 2.819362),
        (r#"inertiagrouprange="3 5""#, "", 8.0, 0.053333),
        (r#"inertiagrouprange="3 5""#, STATED_INERTIA, 2.0, 1.0),
        (r#"inertiafromgeom="true""#, STATED_INERTIA, both, 2.819362),
        (
            r#"inertiafromgeom="true" inertiagrouprange="4 5""#,
            STATED_INERTIA,
            2.0,
            1.0,
        ),
        (r#"settotalmass="-1""#, "", both, 2.819362),
        (r#"settotalmass="0""#, "", both, 2.819362),
        (
            r#"settotalmass="10""#,
            "",
            both * 10.0 / (both + stand),
            2.819362 * 10.0 / (both + stand),
        ),
        (
            r#"settotalmass="10" inertiagrouprange="0 0""#,
            "",
            5.0,
            0.02,
        ),
    ] {
        let robot = robot(compiler, &format!("{stated}{TWO_GEOMS}"));
        let inertial = link(&robot).inertial.unwrap();
        assert!((inertial.mass - mass).abs() < 1e-12, "{compiler}");
        let moment = (0..3).map(|k| inertial.moments[k][k]).fold(0.0, f64::max);
        assert!((moment - most).abs() < 1e-6, "{compiler}: {moment}");
        assert!((robot.masses().unwrap().total() - mass).abs() < 1e-12);
        assert_eq!(robot.repairs(), []);
    }
    for wrong in [r#"settotalmass="x""#, r#"inertiagrouprange="3""#] {
        let text = format!(r#"<mujoco><compiler {wrong}/><worldbody/></mujoco>"#);
        let message = Robot::parse_mjcf(&text, "wrong.xml")
            .unwrap_err()
            .to_string();
        let attribute = wrong.split('=').next().unwrap();
        assert!(
            message.starts_with("wrong.xml:1:") && message.contains(attribute),
            "{message}"
        );
    }
}

/// Collision geoms often have zero density by their class; by MuJoCo's reference a mass overrides a density.
#[test]
fn mass_overrides_the_density_of_a_class() {
    let geoms = r#"<geom size=".1" pos="1 0 0" mass="3"/><geom size=".2" pos="-1 0 0" mass="1"/>
        <geom size=".4" pos="0 5 0"/>"#;
    let text = format!(
        r#"<mujoco>{MESH_ASSET}<default><geom density="0"/></default><worldbody>
        <body name="a"><joint/>{geoms}</body>
        <body name="b"><joint/><geom type="mesh" mesh="m" mass="2"/></body></worldbody></mujoco>"#
    );
    let robot = Robot::parse_mjcf(&text, "weighs.xml").unwrap();
    let inertial = link(&robot).inertial.unwrap();
    assert_eq!(inertial.mass, 4.0);
    // (3 · 1 − 1 · 1) / 4.
    let centre = inertial.link_from_inertia.translation;
    assert!(
        (centre - Vector3::new(0.5, 0.0, 0.0)).norm() < 1e-15,
        "{centre:?}"
    );
    // Spheres of ⅖ m r², 0.5 and 1.5 from the centre.
    let along = 0.4 * (3.0 * 0.01 + 0.04);
    let across = along + 3.0 * 0.25 + 2.25;
    for (k, expected) in [along, across, across].into_iter().enumerate() {
        let moment = inertial.moments[k][k];
        assert!((moment - expected).abs() < 1e-12, "{k}: {moment}");
    }
    let of_mesh = robot.link(robot.model().frame("b").unwrap()).unwrap();
    assert_eq!(
        of_mesh.left_to_meshes,
        Some(MissingInertia::Centre { mass: 2.0 })
    );
}

#[test]
fn unknown_mesh_masses_are_noted() {
    let mass = "mass depends on a mesh";
    let centre = "2 kg depends on a mesh";
    let of_two = Some(MissingInertia::Centre { mass: 2.0 });
    for (compiler, geoms, left, note) in [
        (
            "",
            r#"<geom type="mesh" mesh="m"/>"#,
            Some(MissingInertia::Mass),
            mass,
        ),
        (
            "",
            r#"<geom type="mesh" mesh="m" mass="2"/>"#,
            of_two,
            centre,
        ),
        (
            "",
            r#"<geom type="sphere" mesh="m" mass="2"/>"#,
            of_two,
            centre,
        ),
        (
            "",
            r#"<geom type="mesh" mesh="m" mass="1.5"/><geom size=".1" mass=".5"/>"#,
            of_two,
            centre,
        ),
        (
            "",
            r#"<geom type="mesh" mesh="m" density="500"/><geom size=".1" mass=".5"/>"#,
            Some(MissingInertia::Mass),
            mass,
        ),
        (
            r#"settotalmass="9""#,
            r#"<geom size=".1"/><body><geom type="mesh" mesh="m"/></body>"#,
            Some(MissingInertia::Mass),
            mass,
        ),
        // A known mass is scaled in any element.
        (
            r#"settotalmass="2.5""#,
            r#"<geom type="mesh" mesh="m" mass="16.7551608191456"/>"#,
            of_two,
            "kg depends on a mesh",
        ),
    ] {
        let robot = robot(compiler, geoms);
        let body = link(&robot);
        assert_eq!(body.inertial, None);
        match (body.left_to_meshes, left) {
            (
                Some(MissingInertia::Centre { mass }),
                Some(MissingInertia::Centre { mass: expected }),
            ) => {
                assert!((mass - expected).abs() < 1e-12, "{mass}");
            }
            (body, expected) => assert_eq!(body, expected, "{geoms}"),
        }
        let reported: Vec<String> = robot.repairs().iter().map(ToString::to_string).collect();
        let reported = reported
            .iter()
            .find(|reported| reported.contains("body `a`"))
            .unwrap();
        assert!(
            reported.starts_with("2: ") && reported.contains(note),
            "{reported}"
        );
        let refused = robot.masses().unwrap_err();
        assert!(matches!(&refused, ModelError::MissingInertia { frame, .. } if frame == "a"));
        assert!(refused.to_string().contains("`a`"), "{refused}");
        match body.left_to_meshes {
            Some(MissingInertia::Centre { mass }) => assert_eq!(robot.total_mass().unwrap(), mass),
            _ => assert_eq!(robot.total_mass().unwrap_err(), refused),
        }
        assert!(robot.centre_of_mass(&robot.model().neutral()).is_err());
    }
}

/// Only relevant meshes are noted: not massless ones, those with a stated inertial, or static ones.
#[test]
fn irrelevant_meshes_are_not_noted() {
    for (compiler, body) in [
        (
            "",
            r#"<geom type="mesh" mesh="m" mass="0"/><geom size=".1" mass="3"/>"#,
        ),
        (
            "",
            r#"<geom type="mesh" mesh="m" density="0"/><geom size=".1" mass="3"/>"#,
        ),
        (
            r#"inertiagrouprange="0 1""#,
            r#"<geom type="mesh" mesh="m" group="2"/><geom size=".1" mass="3"/>"#,
        ),
        (
            "",
            r#"<geom type="mesh" mesh="m"/><inertial mass="3" pos="0 0 0" diaginertia="1 1 1"/>"#,
        ),
    ] {
        let robot = robot(compiler, body);
        assert_eq!(robot.masses().unwrap().total(), 3.0, "{body}");
        assert_eq!(robot.repairs(), []);
    }
    let text = format!(
        r#"<mujoco>{MESH_ASSET}<worldbody><body name="stand"><geom type="mesh" mesh="m"/>
        <body name="a"><joint/><geom size=".1" mass="3"/></body></body></worldbody></mujoco>"#
    );
    let robot = Robot::parse_mjcf(&text, "stands.xml").unwrap();
    assert_eq!(robot.masses().unwrap().total(), 3.0);
}
