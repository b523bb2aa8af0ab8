//! Promise: `kinopt spheres` writes sphere models in formats of other programs. It reports their number, their
//! maximum protrusion and the enabled collision pairs.

use crate::forked_rig::*;
use kinopt::collision::{CollisionModel, SphereModel};
use kinopt::robot::Robot;
use serde_json::json;

#[test]
fn robot_spheres_are_written_in_both_formats() {
    let folder = Folder::new("spheres");
    let panda = model("franka_panda.urdf");
    let robot = Robot::read(&panda).unwrap();
    let shapes = CollisionModel::of(&robot).unwrap();
    for name in ["panda.urdf", "panda.yml"] {
        let out = folder.file(name);
        let report = answer!("spheres {panda} --max-protrusion 0.04 --samples 500 --out {out}");
        assert!(number(&report["max_protrusion"]) <= 0.04);
        let read = SphereModel::read(&out, &shapes).unwrap();
        assert_eq!(count(&report["spheres"]), read.count() as u64);
        // The reported maximum protrusion equals a new measurement.
        assert!((read.max_protrusion() - number(&report["max_protrusion"])).abs() < 1e-12);
        let links = list(&report["links"]);
        assert_eq!(links.len(), shapes.links().len());
        has!(links[0], {"name": "base"});
        let pairs = list(&report["pairs"]);
        assert!(pairs.contains(&json!(["base", "link5"])), "{pairs:?}");
        assert!(!pairs.contains(&json!(["link1", "link2"])));
    }
    let spherised = folder.file("panda.urdf");
    let again = Robot::read(&spherised).unwrap();
    assert_eq!(
        again.model().limits().count(),
        robot.model().limits().count()
    );
    let spheres = SphereModel::of_spheres(&CollisionModel::of(&again).unwrap()).unwrap();
    assert_eq!(spheres.max_protrusion(), 0.0);
    // Links that consist of spheres are unchanged.
    let out = folder.file("again.yml");
    let report = answer!("spheres {spherised} --samples 0 --out {out}");
    has!(report, {"max_protrusion": 0.0, "spheres": spheres.count()});
}

#[test]
fn srdf_pairs_are_kept() {
    let folder = Folder::new("sphere-pairs");
    let ur5e = model("universal_ur5e.urdf");
    let (out, srdf) = (folder.file("ur5e.yml"), folder.file("ur5e.srdf"));
    let sampled =
        answer!("spheres {ur5e} --spheres 8 --samples 500 --out {out} --save-srdf {srdf}");
    let links = list(&sampled["links"]);
    assert!(
        links.iter().all(|link| count(&link["spheres"]) <= 8),
        "{links:?}"
    );
    let read = answer!("spheres {ur5e} --spheres 8 --srdf {srdf} --out {out}");
    assert_eq!(read["pairs"], sampled["pairs"]);
    let all = answer!("spheres {ur5e} --spheres 8 --samples 0 --out {out}");
    assert!(list(&all["pairs"]).len() > list(&sampled["pairs"]).len());
    let text = text!("spheres {ur5e} --spheres 8 --samples 0 --out {out}");
    says!(text => "spheres on 7 links | maximum protrusion | 15 pairs of links are checked | link6");
}

#[test]
fn single_sphere_is_reported_in_the_singular() {
    let folder = Folder::new("one-sphere");
    let ball = "<collision><geometry><sphere radius='0.1'/></geometry></collision>";
    let urdf = format!(
        "<robot name='balls'><link name='a'>{ball}</link><link name='b'>{ball}</link><joint name='j' type='revolute'>\
         <origin xyz='1 0 0'/><parent link='a'/><child link='b'/><axis xyz='0 0 1'/><limit lower='-1' upper='1'/></joint></robot>"
    );
    let (balls, out) = (folder.text("balls.urdf", urdf), folder.file("balls.yml"));
    let text = text!("spheres {balls} --samples 0 --out {out}");
    says!(text => "2 spheres on 2 links, | 0 pairs of links are checked");
    let text = text!("info {balls}");
    says!(text => "1 degree of freedom, 1 of them free | 0 files of meshes");
    let urdf = format!("<robot name='ball'><link name='a'>{ball}</link></robot>");
    let ball = folder.text("ball.urdf", urdf);
    says!(text!("spheres {ball} --samples 0 --out {out}") => "1 sphere on 1 link, ");
    says!(text!("info {ball}") => "0 degrees of freedom");
}

#[test]
fn invalid_input_is_rejected() {
    let folder = Folder::new("no-spheres");
    let panda = model("franka_panda.urdf");
    let out = folder.file("panda.yml");
    refused!("spheres {panda} --max-protrusion=-1 --out {out}" => 1, "--max-protrusion -1: | positive");
    refused!("spheres {panda} --spheres 0 --out {out}" => 1, "--spheres 0: | positive");
    refused!("spheres {panda} --out {out}.txt" => 2, ".urdf or .yml");
    let bare = r#"<robot name="bare"><link name="a"/></robot>"#;
    let bare = folder.text("bare.urdf", bare);
    refused!("spheres {bare} --out {out}" => 1, "bare has no collision shapes");
    let mesh = r#"<robot name="m"><link name="a"><collision><geometry><mesh filename="package://pack/a.stl"/></geometry></collision></link></robot>"#;
    let mesh = folder.text("mesh.urdf", mesh);
    refused!("spheres {mesh} @collisions.package=[\"/nowhere\"] --out {out}" => 1, "/nowhere/pack/a.stl");
}

/// A robot file with a floor, which is too large for a resolution of a fiftieth of the reach.
#[test]
fn default_accepts_links_of_any_size() {
    let folder = Folder::new("sphere-default");
    let floor = r#"<mujoco><worldbody><geom name="floor" type="box" size="5 5 .1" pos="0 0 -.2"/>
      <body name="a" pos="0 0 .5"><joint axis="0 1 0" range="-100 100"/><geom type="capsule" size=".05" fromto="0 0 0 .4 0 0"/>
      <body name="b" pos=".4 0 0"><joint axis="0 1 0" range="-100 100"/><geom type="box" size=".2 .05 .05" pos=".2 0 0"/>
      </body></body></worldbody></mujoco>"#;
    let (robot, out) = (folder.text("arm.xml", floor), folder.file("spheres.yml"));
    let report = answer!("spheres {robot} --samples 0 --out {out}");
    assert!(number(&report["max_protrusion"]) > 0.008, "{report}");
    let run = kinopt!("spheres {robot} --samples 0 --out {out}");
    says!(stderr(&run) => "note: | too large for 0.008 m, 2 % of the reach");
    refused!("spheres {robot} --samples 0 --max-protrusion 0.0001 --out {out}" => 1, "--max-protrusion 0.0001: | larger");
    let rig = model("humanoid/humanoid.json");
    refused!("spheres {rig} --out {out}" => 2, "spheres is for robots with collision shapes | is a rig");
    refused!("check {rig}" => 2, "check is for robots with collision shapes | is a rig");
}
