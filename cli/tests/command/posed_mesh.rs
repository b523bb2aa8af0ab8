//! Promise: --out writes the mesh in the solved pose, and the file can be read again.

use crate::forked_rig::*;
use glam::Vec3;
use kinopt::io::ply;

/// Right elbow bent by 90°, so that bone 4 points along −y from (2, 0, 0).
const START: &str = "--start=0,0,0,0,0,0,0,0,0,0,0,0,0,-90,0";

/// Expected vertices: those of bone 4 are rotated by −90° about (2, 0, 0).
fn expected() -> Vec<Vec3> {
    let mesh = rig().mesh.unwrap();
    let turned = |p: &Vec3| match p.x >= 2.0 {
        true => Vec3::new(2.0 + p.y, -(p.x - 2.0), 0.0),
        false => *p,
    };
    mesh.positions().iter().map(turned).collect()
}

fn solve_to(folder: &Folder, out: &str) {
    let rig = folder.rig();
    let target = "--target=bone/4=2,-1,0";
    let solution = answer!("solve {rig} {target} {START} --degrees --out {out}");
    assert_eq!(solution["reached"], true);
}

fn close(actual: &[Vec3]) {
    let expected = expected();
    assert_eq!(actual.len(), expected.len());
    for (actual, expected) in actual.iter().zip(expected) {
        assert!(
            (*actual - expected).length() < 6e-6,
            "{actual} is not {expected}"
        );
    }
}

#[test]
fn posed_mesh_is_written_as_ply() {
    let folder = Folder::new("ply");
    let out = folder.file("posed.PLY");
    solve_to(&folder, &out);
    let posed = ply::read(&out).unwrap();
    close(posed.positions());
    assert_eq!(posed.triangles(), rig().mesh.unwrap().triangles());
}

#[test]
fn posed_mesh_is_written_as_obj() {
    let folder = Folder::new("obj");
    let out = folder.file("posed.obj");
    solve_to(&folder, &out);
    let text = std::fs::read_to_string(&out).unwrap();
    let lines_of = |kind: &'static str| {
        let lines = text.lines().filter_map(move |line| line.strip_prefix(kind));
        lines.map(|line| line.split_whitespace().collect::<Vec<_>>())
    };
    let position = |words: Vec<&str>| Vec3::from([0, 1, 2].map(|k| words[k].parse().unwrap()));
    close(&lines_of("v ").map(position).collect::<Vec<_>>());
    let corner = |word: &str| word.parse::<u32>().unwrap() - 1;
    let triangles = lines_of("f ").map(|words| [0, 1, 2].map(|k| corner(words[k])));
    let triangles: Vec<[u32; 3]> = triangles.collect();
    assert_eq!(triangles, rig().mesh.unwrap().triangles());
}

#[test]
fn dual_quaternions_move_rigid_parts_equally() {
    let folder = Folder::new("dqs");
    let (rig, out) = (folder.rig(), folder.file("posed.ply"));
    let common =
        format!("solve {rig} --target=bone/4=2,-1,0 {START} --degrees @output.skinning=dqs");
    assert_eq!(answer!("{common} --out {out}")["reached"], true);
    // Every vertex of this rig has one influence.
    close(ply::read(&out).unwrap().positions());
}
