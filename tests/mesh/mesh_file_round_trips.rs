//! Promise: meshes and matrices round trip through files bitwise.

use glam::Vec3;
use kinopt::io::dmat::{self, DmatEncoding};
use kinopt::io::obj;
use kinopt::io::ply::{self, PlyEncoding};
use kinopt::mesh::TriangleMesh;
use nalgebra::DMatrix;

/// Numbers that lose bits if written carelessly.
fn awkward_mesh(with_normals: bool) -> TriangleMesh {
    let positions = vec![
        Vec3::new(0.1, -1.0 / 3.0, 1e-30),
        Vec3::new(16_777_217.0, -0.0, f32::MIN_POSITIVE),
        Vec3::new(f32::MAX, f32::from_bits(1), 2.0),
        Vec3::new(3.0, std::f32::consts::PI, -1e10),
    ];
    let normals = match with_normals {
        true => positions.iter().map(|p| Vec3::new(p.y, 0.7, p.x)).collect(),
        false => Vec::new(),
    };
    TriangleMesh::new(positions, normals, vec![[0, 1, 2], [3, 2, 1], [0, 3, 1]]).unwrap()
}

fn bits(vectors: &[Vec3]) -> Vec<[u32; 3]> {
    let bits = |v: &Vec3| v.to_array().map(f32::to_bits);
    vectors.iter().map(bits).collect()
}

fn assert_same(a: &TriangleMesh, b: &TriangleMesh) {
    assert_eq!(bits(a.positions()), bits(b.positions()));
    assert_eq!(bits(a.normals()), bits(b.normals()));
    assert_eq!(a.triangles(), b.triangles());
}

#[test]
fn ply_round_trips_in_each_encoding() {
    for with_normals in [false, true] {
        let mesh = awkward_mesh(with_normals);
        for encoding in [
            PlyEncoding::Ascii,
            PlyEncoding::BinaryLittleEndian,
            PlyEncoding::BinaryBigEndian,
        ] {
            let bytes = ply::to_bytes(&mesh, encoding);
            assert_same(&mesh, &ply::from_bytes(&bytes, "written").unwrap());
        }
        let empty = TriangleMesh::default();
        let bytes = ply::to_bytes(&empty, PlyEncoding::BinaryLittleEndian);
        assert_eq!(ply::from_bytes(&bytes, "empty").unwrap(), empty);
    }
}

#[test]
fn ply_round_trips_through_the_disk() {
    let path = std::env::temp_dir().join(format!("kinopt-{}.ply", std::process::id()));
    let mesh = awkward_mesh(true);
    ply::write(&mesh, PlyEncoding::BinaryLittleEndian, &path).unwrap();
    let read = ply::read(&path);
    std::fs::remove_file(&path).unwrap();
    assert_same(&mesh, &read.unwrap());
}

#[test]
fn ply_variants_of_other_programs_are_read() {
    // Doubles, quads, an unknown property, an unknown leading element, 32-bit type names.
    let text = "ply\nformat ascii 1.0\ncomment by hand\nelement camera 1\n\
        property list uchar int order\nelement vertex 4\nproperty float64 x\nproperty double y\n\
        property float z\nproperty uchar red\nelement face 1\n\
        property list uint8 int32 vertex_index\nproperty int part\nend_header\n\
        2 5 6\n0 0 0.5 255\n1 0 0.5 0\n1 1e0 0.5 1\n0 1 0.5 2\n4 0 1 2 3 7\n";
    let mesh = ply::from_bytes(text.as_bytes(), "hand").unwrap();
    assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.positions()[2], Vec3::new(1.0, 1.0, 0.5));
    assert!(mesh.normals().is_empty());

    // Doubles are rounded to the nearest f32, and binary data of unknown lists is skipped.
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\n\
        property list uchar short extra\nproperty double y\nproperty double z\nelement face 1\n\
        property list ushort uchar vertex_indices\nend_header\n"
        .to_vec();
    for x in [0.1_f64, 0.2, 0.3] {
        bytes.extend(x.to_le_bytes());
        bytes.extend([2, 1, 0, 2, 0]);
        bytes.extend(1.0_f64.to_le_bytes());
        bytes.extend((-x).to_le_bytes());
    }
    bytes.extend([3, 0, 2, 1, 0]);
    let mesh = ply::from_bytes(&bytes, "hand").unwrap();
    assert_eq!(mesh.positions()[1], Vec3::new(0.2, 1.0, -0.2));
    assert_eq!(mesh.triangles(), [[2, 1, 0]]);
}

#[test]
fn dmat_round_trips_in_both_encodings() {
    let values = [
        0.1,
        -1.0 / 3.0,
        0.0,
        1.0,
        -7.5e-5,
        1e-300,
        f64::MAX,
        f64::MIN_POSITIVE,
        5e-324,
        -0.0,
        123_456_789.123_456_79,
        1e22,
    ];
    for (rows, columns) in [(12, 1), (1, 12), (4, 3), (3, 4)] {
        let matrix = DMatrix::from_column_slice(rows, columns, &values);
        for encoding in [DmatEncoding::Text, DmatEncoding::Binary] {
            let read = dmat::from_bytes(&dmat::to_bytes(&matrix, encoding), "written").unwrap();
            assert_eq!(read.shape(), (rows, columns));
            let bits = |m: &DMatrix<f64>| m.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&read), bits(&matrix));
        }
    }
    let empty = DMatrix::<f64>::zeros(0, 0);
    for encoding in [DmatEncoding::Text, DmatEncoding::Binary] {
        assert_eq!(
            dmat::from_bytes(&dmat::to_bytes(&empty, encoding), "empty").unwrap(),
            empty
        );
    }
}

#[test]
fn dmat_is_column_major() {
    let matrix = dmat::from_bytes(b"2 3\r\n1\r\n2\r\n3\r\n4\r\n5\r\n6", "hand").unwrap();
    assert_eq!(matrix, nalgebra::dmatrix![1.0, 4.0; 2.0, 5.0; 3.0, 6.0]);
    let mut bytes = b"0 0\n2 1\n".to_vec();
    bytes.extend(1.5_f64.to_le_bytes());
    bytes.extend(2.5_f64.to_le_bytes());
    let matrix = dmat::from_bytes(&bytes, "hand").unwrap();
    assert_eq!(matrix, nalgebra::dmatrix![1.5, 2.5]);
}

#[test]
fn obj_round_trips_with_indices_from_one() {
    for with_normals in [false, true] {
        let mesh = awkward_mesh(with_normals);
        let (mut positions, mut normals, mut triangles) = (vec![], vec![], vec![]);
        for line in obj::to_text(&mesh).lines() {
            let words: Vec<&str> = line.split(' ').collect();
            let vector = || {
                Vec3::from_slice(
                    &words[1..]
                        .iter()
                        .map(|w| w.parse().unwrap())
                        .collect::<Vec<_>>(),
                )
            };
            match words[0] {
                "v" => positions.push(vector()),
                "vn" => normals.push(vector()),
                "f" => triangles.push([1, 2, 3].map(|corner| {
                    let parts: Vec<&str> = words[corner].split("//").collect();
                    assert_eq!(parts.len(), if with_normals { 2 } else { 1 });
                    assert!(parts.iter().all(|p| *p == parts[0]));
                    parts[0].parse::<u32>().unwrap() - 1
                })),
                other => panic!("unexpected {other}"),
            }
        }
        assert_same(
            &mesh,
            &TriangleMesh::new(positions, normals, triangles).unwrap(),
        );
    }
}

/// Only text files may end in blanks.
#[test]
fn trailing_bytes_of_a_binary_mesh_are_rejected() {
    let mesh = ply::from_bytes(support::small_rig::PLY.as_bytes(), "small.ply").unwrap();
    for (encoding, is_text) in [
        (PlyEncoding::Ascii, true),
        (PlyEncoding::BinaryLittleEndian, false),
        (PlyEncoding::BinaryBigEndian, false),
    ] {
        let mut bytes = ply::to_bytes(&mesh, encoding);
        bytes.extend_from_slice(b" \n");
        assert_eq!(ply::from_bytes(&bytes, "more.ply").is_ok(), is_text);
    }
}
