//! Promise: so it is for files of meshes (PLY, OBJ), of tables (DMAT) and of cones: read, written, and refused.
#![allow(clippy::unwrap_used)]

use glam::Vec3;
use kinopt::io::dmat::{self, DmatEncoding};
use kinopt::io::ply::{self, PlyEncoding};
use kinopt::io::{cones, obj};
use kinopt::mesh::TriangleMesh;
use kinopt::skeleton::Cones;
use nalgebra::DMatrix;
use support::random::Random;

use crate::animated::{changed, check_single, mesh, vector};
use crate::digest::{Digest, Value};

const PLY: &str = "ply
format ascii 1.0
comment of nothing
element colour 1
property uchar red
element vertex 4
property double x
property float y
property float z
property float nx
property float ny
property float nz
property int flags
element face 2
property list uchar int vertex_indices
element edge 1
property int a
end_header
200
0 0 0 0 0 1 7
1 0 0.1 0 0 1 7
1 1.5 0 0 1 0 7
0 1 0 0 0 1 7
4 0 1 2 3
3 1 3 2
9
";

fn meshes() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(181));
    let read = |text: &str| ply::from_bytes(text.as_bytes(), "own.ply");
    changed(
        &mut digest,
        PLY,
        &[
            ("of nothing", "of something"),
            ("vertex_indices", "vertex_index"),
            ("vertex_indices", "corners"),
            (
                "vertex_indices",
                "vertex_indices\nproperty list uchar int vertex_index",
            ),
            ("property list uchar int", "property list uchar char"),
            ("property list uchar int", "property list int ushort"),
            ("property list uchar int", "property list uchar float"),
            ("property double x", "property uchar x"),
            ("property double x", "property double w"),
            ("property float nx", "property float mx"),
            ("property float nx", "property float y"),
            ("element vertex 4", "element vertex 3"),
            ("element vertex 4", "element vertex 5"),
            ("element vertex 4", "element vertex 4000000000"),
            ("element vertex 4", "element point 4"),
            ("element face 2", "element face 1"),
            ("element edge 1\nproperty int a", "element edge 1"),
            ("element edge 1\nproperty int a", "element edge 0"),
            ("ply\n", "plyy\n"),
            ("format ascii 1.0", "format ascii 2.0"),
            ("format ascii 1.0", "format binary_little_endian 1.0"),
            ("end_header\n", ""),
            ("1 1.5 0", "1 1e39 0"),
            ("1 1.5 0", "1 nan 0"),
            ("1 1.5 0", "1 x 0"),
            ("1 1.5 0 0 1 0", "1 1.5 0 0 inf 0"),
            ("3 1 3 2", "3 1 3 4"),
            ("3 1 3 2", "3 1 -3 2"),
            ("3 1 3 2", "2 1 3"),
            ("3 1 3 2", "0"),
            ("3 1 3 2", "4 1 3 2"),
            ("\n9\n", "\n9"),
            ("\n9\n", "\n9\n \n"),
            ("\n9\n", "\n9\n9\n"),
        ],
        read,
        mesh,
    );
    digest.refused(ply::from_bytes(b"", "own.ply"));
    digest.refused(ply::from_bytes(b"ply\nformat ascii 1.0\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n", "own.ply"));
    let points: Vec<Vec3> = (0..5).map(|_| vector(&mut random, 3.0).into()).collect();
    let triangles = vec![[0, 1, 2], [4, 3, 2]];
    let bare = TriangleMesh::new(points, Vec::new(), triangles).unwrap();
    let solid = bare.clone().with_computed_normals();
    for own in [&bare, &solid, &TriangleMesh::default()] {
        digest.bytes(obj::to_text(own));
        for encoding in [
            PlyEncoding::Ascii,
            PlyEncoding::BinaryLittleEndian,
            PlyEncoding::BinaryBigEndian,
        ] {
            let bytes = ply::to_bytes(own, encoding);
            digest.bytes(&bytes);
            mesh(&mut digest, &ply::from_bytes(&bytes, "again.ply").unwrap());
            let mut more = bytes.clone();
            more.extend(b"12");
            digest.refused(ply::from_bytes(&more, "more.ply"));
            if !own.positions().is_empty() {
                digest.refused(ply::from_bytes(&bytes[..bytes.len() - 5], "less.ply"));
                let lines = bytes.len() - 40;
                digest.refused(ply::from_bytes(&bytes[..lines], "less.ply"));
            }
        }
    }
    digest.value()
}

fn tables() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(182));
    let add = |digest: &mut Digest, table: &DMatrix<f64>| {
        digest.debug(table.shape());
        digest.doubles(table.iter().copied());
    };
    let text = "2 3\n1\n0.5 -2e-7\n0\n\n0.5\n1\n";
    let read = |text: &str| dmat::from_bytes(text.as_bytes(), "own.dmat");
    changed(
        &mut digest,
        text,
        &[
            ("2 3", "3 2"),
            ("2 3", "2 3 1"),
            ("2 3", "2"),
            ("2 3", "2 -3"),
            ("2 3", "2 4"),
            ("2 3", "1 3"),
            ("2 3", "0 3"),
            ("2 3", "3 0"),
            ("2 3", "20000 30000"),
            ("2 3", "18446744073709551615 18446744073709551615"),
            ("0.5\n1", "0.5\none"),
            ("0.5\n1", "0.5\nnan"),
            (
                "0.5\n1",
                "0.5\na_word_that_is_longer_than_forty_letters_and_is_cut",
            ),
            ("0.5\n1\n", "0.5\n1"),
            ("0.5\n1\n", "0.5"),
        ],
        read,
        add,
    );
    digest.refused(dmat::from_bytes(b"2 1\n1\n\xff\n", "own.dmat"));
    digest.refused(dmat::from_bytes(b"", "own.dmat"));
    digest.refused(dmat::from_bytes(b"\xff 1\n", "own.dmat"));
    let table = DMatrix::from_fn(3, 4, |row, column| match (row, column) {
        (1, 2) => 3e-5,
        (2, 0) => -0.0,
        (0, 3) => 1e22,
        _ => random.within(-1.0, 1.0),
    });
    for table in [
        table,
        DMatrix::zeros(0, 0),
        DMatrix::zeros(0, 2),
        DMatrix::zeros(1, 1),
    ] {
        for encoding in [DmatEncoding::Text, DmatEncoding::Binary] {
            let bytes = dmat::to_bytes(&table, encoding);
            digest.bytes(&bytes);
            match dmat::from_bytes(&bytes, "again.dmat") {
                Ok(again) => add(&mut digest, &again),
                Err(error) => digest.text(error.to_string()),
            }
            let mut more = bytes.clone();
            more.extend(b" 7");
            let cut = &bytes[..bytes.len() - 1];
            for bytes in [more.as_slice(), cut] {
                let read = dmat::from_bytes(bytes, "odd.dmat");
                digest.text(read.map_or_else(|error| error.to_string(), |_| String::new()));
            }
        }
    }
    let mut infinite = dmat::to_bytes(&DMatrix::zeros(2, 1), DmatEncoding::Binary);
    let end = infinite.len();
    infinite[end - 2..].copy_from_slice(&[0xF0, 0x7F]);
    digest.refused(dmat::from_bytes(&infinite, "odd.dmat"));
    digest.value()
}

const CONES: &str = r#"{
 "arm": {"swing": 90, "twist": [-60, 60.5]},
 "fore": {"axis": [0, 2, 0], "swing": 2, "twist": [-150, 0]},
 "neck": {"swing": [45, 25], "about": [1, 0, 1], "twist": [-70, 70], "angle": 100},
 "free": {"angle": 180}
}"#;

fn figures() -> Value {
    let mut digest = Digest::new();
    let read = |text: &str| cones::from_bytes(text.as_bytes(), "man.json");
    let add = |digest: &mut Digest, cones: &Cones| digest.debug(cones);
    changed(
        &mut digest,
        CONES,
        &[
            ("\"free\"", "\"loose\""),
            ("\"free\"", "\"arm\""),
            ("\"swing\": 90", "\"swing\": 0"),
            ("\"swing\": 90", "\"swing\": 180.5"),
            ("\"swing\": 90", "\"swing\": [90, 20]"),
            ("\"swing\": 90", "\"swing\": [90]"),
            ("\"swing\": 90", "\"swing\": \"wide\""),
            ("\"swing\": 90", "\"swung\": 90"),
            ("\"swing\": 90", "\"about\": [1, 0, 0]"),
            ("\"swing\": 90, ", ""),
            ("\"swing\": 90, \"twist\": [-60, 60.5]", ""),
            ("[-60, 60.5]", "[60, -60.5]"),
            ("[-60, 60.5]", "[-181, 60.5]"),
            ("[-60, 60.5]", "[-60, 181]"),
            ("[45, 25]", "[45, 0]"),
            ("[45, 25], \"about\"", "[45, 25], \"angle\": 3, \"about\""),
            ("\"about\": [1, 0, 1], ", ""),
            ("\"about\": [1, 0, 1]", "\"about\": [0, 0, 0]"),
            ("\"axis\": [0, 2, 0]", "\"axis\": [0, 0, 0]"),
            ("\"axis\": [0, 2, 0]", "\"axis\": [1e200, 1e200, 0]"),
            ("\"angle\": 180", "\"angle\": -1"),
            ("\"angle\": 180", "\"angle\": null"),
            ("\n}", "\n"),
        ],
        read,
        add,
    );
    digest.refused(read("{}"));
    digest.refused(read(r#"{"": {"swing": 90}, "a\"b": {"swung": 3}}"#));
    digest.refused(read("[]"));
    digest.debug(cones::read("../models/humanoid/cones.json").unwrap());
    digest.value()
}

#[test]
fn of_tables() {
    check_single(&[
        ("files of meshes", meshes()),
        ("files of tables", tables()),
        ("files of cones", figures()),
    ]);
}
