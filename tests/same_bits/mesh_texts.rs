//! Promise: so it is for files of meshes: what each format says in its many spellings, parts, scales, and every fault.
#![allow(clippy::unwrap_used)]

use kinopt::collision::MeshFile;
use kinopt::io::ply;
use support::changed_text::changed;
use support::changed_xml::Element;
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::robot_texts::{add_error, add_text};

/// Two parts that touch in a point that stands twice, polygons, every way to name a corner, lines that go on.
const OBJ: &str = "# two tents\nmtllib x.mtl\no one\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1.25 0.5 0.5 0.5
vn 0 0 1\nvt 0 0\nf 1/1/1 2//1 3/1 4\nf 1 2 5\nf -4 -3 \\\n  -1 # roof\nf 3 4 5
g other\nv 0.5 0.5 1.25\nv 2 0 1\nv 2 1 1.5\nv -0 0 0\ns off\nf 6 7 8\nusemtl y\nf -2 -3 9 8\n";

const STL: &str = "solid a tent\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 -0\n endloop\nendfacet
facet normal 0 0 0\n outer loop\n  vertex 0 0 1e-3\n  vertex 1.0 0 0\n  vertex 5 5 5\n endloop\nendfacet
facet\n outer loop\n  vertex 0 1 0\n  vertex 5 5 5.0\n  vertex 7 5 5\n endloop\nendfacet\nendsolid a tent\n";

/// Every kind of primitives, nodes that turn, mirror and stand elsewhere, a skin, a unit.
const DAE: &str = r##"<COLLADA version="1.4.1"><asset><unit name="inch" meter="0.0254"/><up_axis>Z_UP</up_axis></asset>
<library_controllers><controller id="bent"><skin source="#fan"/></controller></library_controllers>
<library_geometries><geometry id="box"><mesh><source id="places"><float_array id="f" count="15">0 0 0 1 0 0 0 1 0 0 0 1 2 2 2</float_array>
<technique_common><accessor source="#f" count="5" stride="3"/></technique_common></source>
<vertices id="corners"><input semantic="POSITION" source="#places"/></vertices>
<triangles count="2"><input semantic="NORMAL" source="#places" offset="1"/><input semantic="VERTEX" source="#corners" offset="0"/><p>0 0 1 0 2 0 1 1 3 1 4 1</p></triangles>
<polylist count="2"><input semantic="VERTEX" source="#corners"/><vcount>3 4</vcount><p>0 1 3 1 2 3 4</p></polylist></mesh></geometry>
<geometry id="fan"><mesh><source id="more"><float_array>0 0 0 9 3 0 0 9 0 3 0 9 0 0 3 9</float_array>
<technique_common><accessor stride="4"/></technique_common></source><vertices id="tips"><input semantic="POSITION" source="#more"/></vertices>
<trifans><input semantic="VERTEX" source="#tips" offset="0"/><p>0 1 2 3</p></trifans>
<tristrips><input semantic="VERTEX" source="#tips" offset="0"/><p>3 1 2 0</p><p>0 2 1</p></tristrips>
<polygons><input semantic="VERTEX" source="#tips" offset="0"/><p>0 3 2 1</p></polygons><lines/></mesh></geometry><geometry id="bow"><spline/></geometry></library_geometries>
<library_nodes><node id="again"><scale>1 -1 2</scale><instance_geometry url="#box"/></node></library_nodes>
<library_visual_scenes><visual_scene id="first"><node><instance_geometry url="#bow"/></node></visual_scene><visual_scene id="scene">
<node><matrix>0 -1 0 1 1 0 0 2 0 0 1 3 0 0 0 1</matrix><rotate>0 0 2 90</rotate><node><translate>4 5 6</translate><instance_geometry url="#fan"/></node>
<instance_node url="#again"/></node><node><rotate>1 0 0 -30</rotate><rotate>0 0 0 5</rotate><instance_controller url="#bent"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene></COLLADA>"##;

const PLY: &str = "ply\nformat ascii 1.0\ncomment a tent\nelement vertex 5\nproperty double x\nproperty float y\nproperty double z
property uchar red\nproperty float nx\nproperty float ny\nproperty float nz\nelement edge 1\nproperty int vertex1\nproperty list uchar short more
element face 3\nproperty list uchar int vertex_index\nend_header\n0 0 0 1 0 0 1\n1 0 0 2 0 0 1\n0 1 0 3 0 0 1\n0 0 1 4 0 1 0\n2 2 2 5 1 0 0
7 2 1 2\n3 0 1 2\n4 0 1 4 3\n3 3 2 1\n";

fn add_mesh(digest: &mut Digest, mesh: &MeshFile) {
    digest.doubles(mesh.points.iter().flat_map(|point| point.to_array()));
    add_text(digest, &format!("{:?}", mesh.triangles));
}

fn add(digest: &mut Digest, bytes: &[u8], file: &str, random: &mut Random) {
    let by = [(); 3].map(|()| [-2.0, 0.5, 1.0, 0.0, 3.0][random.below(5)]);
    match MeshFile::parse(bytes, file) {
        Ok(mesh) => {
            add_mesh(digest, &mesh);
            for part in mesh.parts() {
                add_mesh(digest, &part);
            }
            add_mesh(digest, &mesh.scaled(by));
        }
        Err(error) => add_error(digest, &error),
    }
}

fn words() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(901));
    for (text, file, count) in [
        (OBJ, "two.obj", 120),
        (STL, "tent.STL", 120),
        (PLY, "tent.ply", 150),
        (OBJ, "two.step", 1),
        (STL, "stl", 1),
    ] {
        add(&mut digest, text.as_bytes(), file, &mut random);
        for text in changed(text, count, &mut random) {
            add(&mut digest, text.as_bytes(), file, &mut random);
        }
    }
    for kind in ["char", "uchar", "short", "ushort", "int", "uint", "float"] {
        let text = PLY.replace("list uchar int", &format!("list ushort {kind}"));
        add(&mut digest, text.as_bytes(), "kinds.ply", &mut random);
        let twice = format!("property list uchar {kind} vertex_indices\nend_header");
        let text = PLY.replace("end_header", &twice);
        add(&mut digest, text.as_bytes(), "twice.ply", &mut random);
    }
    digest.value()
}

/// One triangle and another, with a header that announces more, fewer or as many.
fn binary_stl() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(902));
    for round in 0..80 {
        let begin = [&b"solid x"[..], b"", b"  solid", b"\0solid"][round % 4];
        let mut bytes = begin.to_vec();
        bytes.resize(80, if round % 8 < 4 { b' ' } else { 0 });
        let count = random.below(4);
        let announced = count + [0, 0, 0, 1, 9][random.below(5)]
            - usize::from(count > 1 && random.below(5) == 0);
        bytes.extend((announced as u32).to_le_bytes());
        for _ in 0..count {
            bytes.extend([7; 12]);
            for _ in 0..9 {
                let numbers = [0.0, -0.0, 1.0, 0.5, -3.0, 2e38, f32::NAN];
                let number = numbers[random.below(if round % 5 == 0 { 7 } else { 6 })];
                bytes.extend(number.to_le_bytes());
            }
            bytes.extend([1; 2]);
        }
        let more = [0, 0, 3, 60][random.below(4)];
        bytes.resize(bytes.len() + more, 1);
        bytes.truncate(bytes.len() - [0, 0, 0, 1, 30][random.below(5)].min(bytes.len()));
        add(&mut digest, &bytes, "a.stl", &mut random);
    }
    for short in [&b""[..], b"solid", b"SOLID x", b"solid \xff\nvertex 1 2 3"] {
        add(&mut digest, short, "a.stl", &mut random);
    }
    digest.value()
}

fn documents() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(903));
    add(&mut digest, DAE.as_bytes(), "a.dae", &mut random);
    // Without a scene, without scenes, numbers as words, in the order of words.
    let scene = DAE.find("<scene>").unwrap();
    let library = DAE.find("<library_visual_scenes>").unwrap();
    for text in [
        format!("{}</COLLADA>", &DAE[..scene]),
        format!("{}</COLLADA>", &DAE[..library]),
        format!("\u{feff}<!DOCTYPE x>{DAE}"),
        DAE.replace("0.0254", "-1"),
        DAE[..scene].to_owned(),
    ] {
        add(&mut digest, text.as_bytes(), "a.dae", &mut random);
    }
    for text in changed(DAE, 160, &mut random) {
        add(&mut digest, text.as_bytes(), "a.dae", &mut random);
    }
    let whole = Element::parse(DAE);
    let texts: Vec<&str> = DAE.split(['<', '>']).collect();
    for _ in 0..60 {
        // The tree keeps no texts, so that what it says of numbers is that they are missing.
        let mut own = whole.clone();
        own.change(&mut random);
        add(&mut digest, own.text().as_bytes(), "tree.dae", &mut random);
        let at = random.below(texts.len() / 2) * 2;
        let text = DAE.replacen(&format!(">{}<", texts[at]), "><", 1);
        add(&mut digest, text.as_bytes(), "a.dae", &mut random);
    }
    digest.value()
}

/// PLY in every encoding, damaged a byte at a time, as our own reader of meshes has it.
fn binary_ply() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(904));
    let mesh = ply::from_bytes(PLY.as_bytes(), "a.ply").unwrap();
    let bare = kinopt::mesh::TriangleMesh::new(
        mesh.positions().to_vec(),
        Vec::new(),
        mesh.triangles().to_vec(),
    );
    for mesh in [&mesh, &bare.unwrap()] {
        for encoding in [
            ply::PlyEncoding::Ascii,
            ply::PlyEncoding::BinaryLittleEndian,
            ply::PlyEncoding::BinaryBigEndian,
        ] {
            let good = ply::to_bytes(mesh, encoding);
            add_text(&mut digest, &format!("{good:?}"));
            for round in 0..25 {
                let mut bytes = good.clone();
                let at = random.below(bytes.len());
                match round % 5 {
                    0 => bytes[at] ^= 1 << random.below(7),
                    1 => bytes.truncate(at),
                    2 => {
                        bytes.extend_from_slice([&b" \n"[..], b"3 0 1 2\n", b"\0"][random.below(3)])
                    }
                    3 => drop(bytes.remove(at)),
                    _ => {}
                }
                match ply::from_bytes(&bytes, "b.ply") {
                    Ok(mesh) => add_text(&mut digest, &format!("{mesh:?}")),
                    Err(error) => add_error(&mut digest, &error),
                }
                add(&mut digest, &bytes, "b.ply", &mut random);
            }
        }
    }
    digest.value()
}

#[test]
fn of_files_of_meshes() {
    check(&[
        ("files of meshes: words changed", words()),
        ("files of meshes: binary STL", binary_stl()),
        ("files of meshes: COLLADA, changed", documents()),
        ("files of meshes: PLY in every encoding", binary_ply()),
    ]);
}
