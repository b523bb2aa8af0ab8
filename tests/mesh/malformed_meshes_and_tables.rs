//! Promise: errors of malformed PLY or DMAT files name the file, the location and the problem.

use kinopt::io::{ReadError, dmat, ply};
use support::fault_tables::faults;
use support::small_rig::PLY;

fn ply_error(bytes: impl AsRef<[u8]>) -> ReadError {
    ply::from_bytes(bytes.as_ref(), "bad.ply").unwrap_err()
}

/// Faults of the PLY file of the small rig.
const PLY_FAULTS: &str = r#"
element vertex => element corner | no element `vertex` | corner
element face => element facet | no element `face`
float y => float w | no property `y`
float y => float x | twice
element face => element vertex | twice
float y => int y | line 10 | 'y'
uint vertex_indices => float vertex_indices | line 13 | 'vertex_indices'
vertex_indices => indices | vertex_indices
vertex 3 => vertex 4000000000 | 4000000000 entries | `vertex` | left in the file
vertex 3 => vertex 18446744073709551615 | 18446744073709551615 entries
vertex 3 => vertex 99999999999999999999 | line 3
vertex 3 => vertex -1 | line 3
face 1 => face 1000000000 | 1000000000 entries | `face`
element face => element nothing 4000000000\nelement face | `nothing` | no properties
3 0 1 2 => 2 0 1 | face 0:  | 2 corners
3 0 1 2 => 0 | face 0:  | no corners
3 0 1 2 => 3 0 1 3 | face 0:  | index 3 | 3 vertices
3 0 1 2 => 2147483648 0 1 2 | line 13 | 2147483648
3 0 1 2 => 3 0 1 -1 | line 13 | index 2
1 0 0\n => 1 nan 0\n | line 11
1 0 0\n => 1 1e60 0\n | vertex 1 | not finite
1 0 0\n => 1 0\n | line 11
3 0 1 2\n => 3 0 1 2\n7\n | 2 bytes are left
"#;

#[test]
fn malformed_ply_is_named_with_its_location() {
    for fault in faults(PLY_FAULTS) {
        let text = PLY.replacen(&fault.from, &fault.to, 1);
        let error = ply_error(text);
        let message = error.to_string();
        assert!(
            message.starts_with("bad.ply: ") && message.len() < 500,
            "{message}"
        );
        fault.check(Err::<(), _>(error));
    }
    let cases: Vec<(String, &[&str])> = vec![
        (ply_error("").to_string(), &["byte 0", "end of file"]),
        (ply_error("solid").to_string(), &["line 1", "ply"]),
        (ply_error(&PLY[..40]).to_string(), &["line 4"]),
        (
            ply_error("ply\nformat ascii 1.0\n").to_string(),
            &["end_header"],
        ),
        (
            ply_error(PLY.replacen("ascii 1.0\n", "ascii 1.0\n\u{fe}", 1)).to_string(),
            &["line 3"],
        ),
    ];
    for (message, parts) in cases {
        for part in ["bad.ply: "].iter().chain(parts) {
            assert!(message.contains(part), "no `{part}` in: {message}");
        }
        assert!(message.len() < 500 && !message.contains('\n'), "{message}");
    }
}

/// By the sizes of Turk's format.
#[test]
fn announced_ply_size_is_checked_in_bytes() {
    for (kinds, width) in [
        (["char", "uchar"], 1),
        (["short", "ushort"], 2),
        (["int", "uint"], 4),
        (["float", "float"], 4),
        (["double", "double"], 8),
    ] {
        for kind in kinds {
            let message = ply_error(format!(
                "ply\nformat binary_little_endian 1.0\nelement vertex 1000\nproperty float x\nproperty float y\n\
                property float z\nproperty {kind} extra\nelement face 0\nproperty list int int vertex_indices\nend_header\n"
            ));
            let needed = format!("{}", 1000 * (3 * 4 + width));
            assert!(message.to_string().contains(&needed), "{kind}: {message}");
        }
    }
}

#[test]
fn malformed_binary_ply_is_named() {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty double x\n\
        property double y\nproperty double z\nelement face 1\n\
        property list int int vertex_indices\nend_header\n";
    let file = |x: f64, corners: i32| {
        let mut bytes = header.as_bytes().to_vec();
        bytes.extend([x, 0.0, 0.0].iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend([corners, 0, 0, 0].iter().flat_map(|v| v.to_le_bytes()));
        bytes
    };
    assert!(ply::from_bytes(&file(1.0, 3), "good").is_ok());
    for (bytes, parts) in [
        (file(f64::NAN, 3), ["vertex 0", "not finite"]),
        (file(1e300, 3), ["vertex 0", "not finite"]),
        (file(1.0, i32::MAX), ["byte ", "end of file"]),
        (file(1.0, -1), ["byte ", "ist"]),
        (file(1.0, 2), ["4 bytes are left", "byte "]),
    ] {
        let message = ply_error(bytes).to_string();
        assert!(
            parts.iter().all(|part| message.contains(part)),
            "{parts:?}: {message}"
        );
    }
    let whole = file(1.0, 3);
    for length in 0..whole.len() {
        ply_error(&whole[..length]);
    }
}

#[test]
fn malformed_dmat_is_named_with_its_location() {
    let f64s = |values: &[f64]| {
        values
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect::<Vec<u8>>()
    };
    let binary = |sizes: &str, values: &[f64]| {
        [format!("0 0\n{sizes}\n").into_bytes(), f64s(values)].concat()
    };
    let cases: Vec<(Vec<u8>, &[&str])> = vec![
        (b"".to_vec(), &["line 1: ", "whole numbers"]),
        (b"2".to_vec(), &["line 1: "]),
        (b"1 2 3\n".to_vec(), &["line 1: "]),
        (b"-1 2\n".to_vec(), &["line 1: "]),
        (
            b"4000000000 0\n".to_vec(),
            &["line 1: ", "4000000000 columns of 0"],
        ),
        (
            b"0 4000000000\n".to_vec(),
            &["line 1: ", "0 columns of 4000000000"],
        ),
        (binary("0 7", &[]), &["line 2: ", "0 columns of 7"]),
        (b"1.5 2\n".to_vec(), &["line 1: "]),
        (b"99999999999999999999 1\n".to_vec(), &["line 1: "]),
        (b"\xff\xfe".to_vec(), &["line 1: "]),
        (b"0 0\n".to_vec(), &["line 2: "]),
        (b"2 2\n1 2 3".to_vec(), &["line 1: ", "5 are left"]),
        (b"2 2\n1 2 3     ".to_vec(), &["3 of the 4"]),
        (b"2 2\n1 2 3 4 5".to_vec(), &["line 2: ", "more values"]),
        (b"2 2\n1 2\n3 x4".to_vec(), &["line 3: ", "`x4`"]),
        (b"2 2\n1 2\nNaN 4".to_vec(), &["line 3: ", "`NaN`"]),
        (b"2 2\n1 2\n1e999 4".to_vec(), &["line 3: ", "`1e999`"]),
        (b"2 2\n1 2\n3 \xff".to_vec(), &["line 3: ", "text"]),
        (
            b"18446744073709551615 18446744073709551615\n1".to_vec(),
            &["line 1: ", "left in the file"],
        ),
        (
            binary("18446744073709551615 18446744073709551615", &[1.0]),
            &["line 2: ", "left in the file"],
        ),
        (
            binary("4000000000 4000000000", &[1.0]),
            &["line 2: ", "8 are left"],
        ),
        (binary("1 2", &[1.0]), &["line 2: ", "16", "8 are left"]),
        (
            binary("1 1", &[1.0, 2.0]),
            &["byte 16: ", "8 bytes are left"],
        ),
        (binary("1 2", &[1.0, f64::NAN]), &["byte 16: ", "NaN"]),
    ];
    for (bytes, parts) in cases {
        let shown = String::from_utf8_lossy(&bytes).into_owned();
        let message = match dmat::from_bytes(&bytes, "bad.dmat") {
            Ok(matrix) => panic!("{shown:?} was read as {:?}", matrix.shape()),
            Err(error) => error.to_string(),
        };
        for part in ["bad.dmat: "].iter().chain(parts) {
            assert!(
                message.contains(part),
                "{shown:?}: no `{part}` in: {message}"
            );
        }
    }
}
