//! Promise: a mesh has the same triangles in all formats, and errors of damaged files name the file.

use std::fmt::Write;

use kinopt::collision::MeshFile;
use kinopt::spatial::Vector3;
use support::fault_tables::ExpectedError;
use support::random::Random;

/// Corners of a box of 2 × 4 × 6 about (10, 20, 30), and its twelve triangles, counter-clockwise from outside.
fn corners() -> Vec<[f64; 3]> {
    let corner = |k: usize| {
        let side = |bit: usize, half: f64| if k & bit == 0 { -half } else { half };
        [
            10.0 + side(1, 1.0),
            20.0 + side(2, 2.0),
            30.0 + side(4, 3.0),
        ]
    };
    (0..8).map(corner).collect()
}

const QUADS: [[usize; 4]; 6] = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
];

fn triangles() -> Vec<[usize; 3]> {
    let halves = |[a, b, c, d]: &[usize; 4]| [[*a, *b, *c], [*a, *c, *d]];
    QUADS.iter().flat_map(halves).collect()
}

/// Six times the volume by the divergence theorem: 48 · 6 for the box if all triangles face outward.
fn six_volumes(mesh: &MeshFile) -> f64 {
    let part = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|k| mesh.points[k as usize]);
        a.dot(b.cross(c))
    };
    mesh.triangles.iter().map(part).sum()
}

fn is_the_box(mesh: &MeshFile) {
    assert_eq!(mesh.triangles.len(), 12);
    assert!(
        (six_volumes(mesh) - 288.0).abs() < 1e-3,
        "{}",
        six_volumes(mesh)
    );
    for corner in corners() {
        let at = Vector3::from(corner);
        assert!(
            mesh.points.iter().any(|p| (*p - at).norm() < 1e-5),
            "{corner:?}"
        );
    }
}

fn obj() -> String {
    let mut text = "# box\no one\n".to_owned();
    for [x, y, z] in corners() {
        writeln!(text, "v {x} {y} {z} 0.5 0.5 0.5").unwrap();
    }
    for quad in &QUADS[..5] {
        let [a, b, c, d] = quad.map(|k| k + 1);
        writeln!(text, "f {a}/1/1 {b}//2 {c}/3 {d}").unwrap();
    }
    // Negative indices, on two lines.
    let [a, b, c, d] = QUADS[5].map(|k| k as i64 - 8);
    writeln!(text, "g other\nf {a} {b} \\\n {c} {d}").unwrap();
    text
}

fn ascii_stl() -> String {
    let mut text = "solid box\n".to_owned();
    for triangle in triangles() {
        text += " facet normal 0 0 0\n  outer loop\n";
        for k in triangle {
            let [x, y, z] = corners()[k];
            writeln!(text, "   vertex {x} {y} {z}").unwrap();
        }
        text += "  endloop\n endfacet\n";
    }
    text + "endsolid box\n"
}

fn binary_stl() -> Vec<u8> {
    let mut bytes = b"solid is how many binary files begin".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(12_u32.to_le_bytes());
    for triangle in triangles() {
        bytes.extend([0; 12]);
        for number in triangle.into_iter().flat_map(|k| corners()[k]) {
            bytes.extend((number as f32).to_le_bytes());
        }
        bytes.extend([0; 2]);
    }
    bytes
}

/// The box at half its size in centimetres, placed by a node within another that rotates and doubles it.
fn dae() -> String {
    // A rotation by +90° about z takes (x, y, z) to (-y, x, z). The inverse is applied here, with (5, 0, 0) cm before.
    let points = corners().into_iter().map(|[x, y, z]| {
        let [x, y, z] = [x * 50.0, y * 50.0, z * 50.0];
        format!("{} {} {}", y, -x - 5.0, z)
    });
    let points = points.collect::<Vec<_>>().join(" ");
    let indices = QUADS.iter().flatten().map(|k| format!("{k} 0"));
    let indices = indices.collect::<Vec<_>>().join(" ");
    format!(
        r##"<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="centimeter" meter="0.01"/><up_axis>Y_UP</up_axis></asset>
  <library_geometries><geometry id="box"><mesh>
    <source id="places"><float_array id="numbers" count="24">{points}</float_array>
      <technique_common><accessor source="#numbers" count="8" stride="3"/></technique_common></source>
    <vertices id="corners"><input semantic="POSITION" source="#places"/></vertices>
    <polylist count="6"><input semantic="VERTEX" source="#corners" offset="0"/>
      <input semantic="NORMAL" source="#places" offset="1"/>
      <vcount>4 4 4 4 4 4</vcount><p>{indices}</p></polylist>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="scene"><node><scale>2 2 2</scale><rotate>0 0 1 90</rotate>
    <node><translate>0 5 0</translate><instance_geometry url="#box"/></node></node></visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>"##
    )
}

#[test]
fn all_formats_give_equal_triangles() {
    is_the_box(&MeshFile::parse(obj().as_bytes(), "box.obj").unwrap());
    is_the_box(&MeshFile::parse(ascii_stl().as_bytes(), "box.stl").unwrap());
    is_the_box(&MeshFile::parse(&binary_stl(), "box.STL").unwrap());
    is_the_box(&MeshFile::parse(dae().as_bytes(), "box.dae").unwrap());
}

/// A backslash continues a line; after the last one nothing follows, and the text before it counts. In COLLADA the
/// other attributes of a vertex may precede its position.
#[test]
fn collada_offsets_are_respected() {
    let later = dae().replacen("offset=\"0\"", "offset=\"2\"", 1).replacen(
        "offset=\"1\"",
        "offset=\"0\"",
        1,
    );
    let corners = QUADS.iter().flatten().map(|k| format!("7 3 {k}"));
    let corners = corners.collect::<Vec<_>>().join(" ");
    let (before, rest) = later.split_once("<p>").unwrap();
    let (_, after) = rest.split_once("</p>").unwrap();
    let later = format!("{before}<p>{corners}</p>{after}");
    is_the_box(&MeshFile::parse(later.as_bytes(), "box.dae").unwrap());
}

/// Exporters add the edges of faces as lines.
#[test]
fn collada_lines_are_ignored() {
    let lines = "<lines count=\"2\"><input semantic=\"VERTEX\" source=\"#corners\" offset=\"0\"/><p>0 1 1 3</p></lines>";
    let drawn = dae().replace("<polylist", &format!("{lines}<polylist"));
    is_the_box(&MeshFile::parse(drawn.as_bytes(), "box.dae").unwrap());
}

#[test]
fn file_ending_in_a_backslash_keeps_its_last_face() {
    let whole = obj();
    let file = format!("{} \\", whole.trim_end());
    is_the_box(&MeshFile::parse(file.as_bytes(), "box.obj").unwrap());
    let file = whole.replacen("f ", "f \\\n", 1);
    assert_ne!(file, whole);
    is_the_box(&MeshFile::parse(file.as_bytes(), "box.obj").unwrap());
}

#[test]
fn mirrored_mesh_faces_outward() {
    let mesh = MeshFile::parse(obj().as_bytes(), "box.obj").unwrap();
    let mirrored = mesh.scaled([-1.0, 2.0, 1.0]);
    assert!((six_volumes(&mirrored) - 576.0).abs() < 1e-9);
}

#[test]
fn connected_parts_are_separated() {
    let one = MeshFile::parse(obj().as_bytes(), "box.obj").unwrap();
    let mut two = obj();
    let far = corners()
        .into_iter()
        .map(|[x, y, z]| format!("v {} {y} {z}\n", x + 50.0));
    two.extend(far);
    for quad in &QUADS {
        let [a, b, c, d] = quad.map(|k| k + 9);
        writeln!(two, "f {a} {b} {c} {d}").unwrap();
    }
    let parts = MeshFile::parse(two.as_bytes(), "two.obj").unwrap().parts();
    assert_eq!(parts.len(), 2);
    assert!(
        parts
            .iter()
            .all(|part| part.points.len() == 8 && part.triangles.len() == 12)
    );
    assert_eq!(one.parts().len(), 1);
    // Equal vertices are one, also with zero and negative zero.
    let touching = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -0.0 -0 0\nv 0 1 -0\nv -1 1 0\nf 1 2 3\nf 4 5 6\n";
    let touching = MeshFile::parse(touching.as_bytes(), "two.obj").unwrap();
    let parts = touching.parts();
    assert_eq!(parts.len(), 1);
    assert_eq!(parts[0].triangles.len(), 2);
    // Triangles that share any vertex are one part.
    for face in ["1 4 5", "4 2 5", "4 5 3"] {
        let points: String = (0..5).map(|k| format!("v {k} {} 0\n", k * k)).collect();
        let file = format!("{points}f 1 2 3\nf {face}\n");
        let touching = MeshFile::parse(file.as_bytes(), "two.obj").unwrap();
        assert_eq!(touching.parts().len(), 1, "{face}");
    }
}

#[test]
fn errors_name_the_file() {
    let message = |bytes: &[u8], file: &str| MeshFile::parse(bytes, file).unwrap_err().to_string();
    assert!(message(b"", "hand.fbx").contains("hand.fbx: is of no format that is read"));
    assert!(
        message(b"v 0 0 0\nf 1 2 3\n", "a.obj")
            .contains("line 2: `2` is not an index of the 1 points")
    );
    assert!(message(b"v 0 0 nan\n", "a.obj").contains("line 1"));
    assert!(message(b"v 0 0 0\n", "a.obj").contains("has no triangles"));
    assert!(message(&binary_stl()[..300], "a.stl").contains("at least"));
    let dangling = dae().replace("url=\"#box\"", "url=\"#ball\"");
    assert!(message(dangling.as_bytes(), "a.dae").contains("`#ball` is not an id"));
    let endless = dae().replace(
        "<node><translate>0 5 0</translate>",
        "<node id=\"n\"><instance_node url=\"#n\"/>",
    );
    assert!(message(endless.as_bytes(), "a.dae").contains("nodes within nodes"));
    let beyond = dae().replace("0 0 2 0 3 0 1 0", "0 0 2 0 3 0 8 0");
    assert!(message(beyond.as_bytes(), "a.dae").contains("beyond the 8"));
}

/// Each of 18 nodes instantiates the next twice.
#[test]
fn exponential_node_instances_are_rejected() {
    for last in ["", "<instance_geometry url=\"#box\"/>"] {
        let mut nodes = format!("<node id=\"n18\">{last}</node>");
        for k in 0..18 {
            let next = format!("<instance_node url=\"#n{}\"/>", k + 1);
            write!(nodes, "<node id=\"n{k}\">{next}{next}</node>").unwrap();
        }
        let library = format!("<library_nodes>{nodes}</library_nodes><library_geometries>");
        let file = dae().replace("<library_geometries>", &library).replace(
            "<instance_geometry url=\"#box\"/></node></node></visual_scene>",
            "<instance_node url=\"#n0\"/></node></node></visual_scene>",
        );
        MeshFile::parse(file.as_bytes(), "a.dae").says("nodes within nodes");
    }
}

#[test]
fn damaged_files_never_panic() {
    let files = [
        ("a.obj", obj().into_bytes()),
        ("a.stl", ascii_stl().into_bytes()),
        ("b.stl", binary_stl()),
        ("a.dae", dae().into_bytes()),
    ];
    let mut random = Random::new(14);
    for (name, bytes) in files {
        for _ in 0..300 {
            let mut damaged = bytes.clone();
            for _ in 0..1 + random.below(4) {
                let at = random.below(damaged.len());
                match random.below(3) {
                    0 => damaged[at] = random.below(256) as u8,
                    1 => damaged.truncate(at.max(1)),
                    _ => drop(damaged.remove(at)),
                }
            }
            if let Ok(mesh) = MeshFile::parse(&damaged, name) {
                let count = mesh.points.len() as u32;
                assert!(
                    mesh.triangles
                        .iter()
                        .flatten()
                        .all(|corner| *corner < count)
                );
            }
        }
    }
}

/// Exporters append a checksum or notes after the announced triangles of a binary STL, and break long lines of an OBJ.
#[test]
fn trailing_bytes_and_continuations_are_accepted() {
    let mut longer = binary_stl();
    longer.extend([7; 120]);
    is_the_box(&MeshFile::parse(&longer, "box.stl").unwrap());
    let broken = obj().replace(' ', " \\\n").replace("v \\\n", "v ");
    is_the_box(&MeshFile::parse(broken.as_bytes(), "box.obj").unwrap());
    let tight = obj().replace(' ', "\\\n");
    is_the_box(&MeshFile::parse(tight.as_bytes(), "box.obj").unwrap());
}

/// Nested entities could expand to any amount of memory.
#[test]
fn dae_with_a_document_type_is_rejected() {
    let mut entities = String::from("<!ENTITY e0 'xxxxxxxxxx'>");
    for k in 1..9 {
        let before = format!("&e{};", k - 1).repeat(10);
        write!(entities, "<!ENTITY e{k} '{before}'>").unwrap();
    }
    let body = dae().replace("<library_geometries>", "&e8;<library_geometries>");
    for text in [
        format!("<!DOCTYPE x [{entities}]>{body}"),
        format!("<!DOCTYPE x>{}", dae()),
    ] {
        MeshFile::parse(text.as_bytes(), "bomb.dae").says("DTD");
    }
}
