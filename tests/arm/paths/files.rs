//! Promise: tables of points are read by their headers or by the number of their columns, and the interpretation is
//! reported. An error names its line.

use kinopt::motion::path::{CartesianPath, CsvColumns, QuaternionOrder};
use support::fault_tables::ExpectedError;

fn read(text: &str) -> Result<(CartesianPath, CsvColumns), String> {
    let read = CartesianPath::from_csv(text.as_bytes(), "path.csv", QuaternionOrder::WFirst);
    read.map_err(|error| error.to_string())
}

#[test]
fn headers_name_the_columns() {
    for header in [
        "time,x,y,z,qx,qy,qz,qw",
        "time,target-POS_X,target-POS_Y,target-POS_Z,target-ROT_X,target-ROT_Y,target-ROT_Z,target-ROT_W",
        "t;pos_x;pos_y;pos_z;quat_x;quat_y;quat_z;quat_w",
        "T X Y Z QX QY QZ QW",
    ] {
        let apart = header.chars().find(|c| ",; ".contains(*c)).unwrap();
        let row = |t: &str| format!("{t},1,2,3,0,0,0.6,0.8").replace(',', &apart.to_string());
        let text = format!("{header}\n{}\n\n# a remark\n{}\n", row("0"), row("0.5"));
        let (path, columns) = read(&text).unwrap();
        assert!(columns.by_name, "{header}");
        assert_eq!(columns.quaternion, Some([7, 4, 5, 6]));
        assert_eq!(path.times().unwrap(), [0.0, 0.5]);
        let point = path.points()[1];
        assert_eq!(point.translation.to_array(), [1.0, 2.0, 3.0]);
        // A rotation about z: cos = 0.8² − 0.6².
        assert!(
            (point.rotation.x.x - 0.28).abs() < 1e-15 && (point.rotation.x.y - 0.96).abs() < 1e-15
        );
        assert_eq!(
            columns.to_string(),
            "x, y, z from columns 2, 3, 4; quaternion w, x, y, z from columns 8, 5, 6, 7; times from column 1 (as the header names them)"
        );
    }
}

#[test]
fn tool_column_assigns_points_to_tools() {
    let (path, columns) = read("x,y,z,tool\n1,2,3,0\n1,2,4,2").unwrap();
    assert_eq!((columns.tool, path.tools()), (Some(3), Some(&[0, 2][..])));
    let message = columns.to_string();
    assert!(message.contains("tools from column 4"), "{message}");
    let (path, columns) = read("x,y,z\n1,2,3").unwrap();
    assert_eq!((columns.tool, path.tools()), (None, None));
}

#[test]
fn tables_without_header_are_read_by_column_count() {
    let (path, columns) = read("1,2,3,1,0,0,0\n1,2,4,1,0,0,0").unwrap();
    assert_eq!(
        (path.points().len(), columns.quaternion),
        (2, Some([3, 4, 5, 6]))
    );
    // Row numbers are not times.
    let (path, columns) = read(",0,1,2,3,4,5,6\n0,1,2,3,1,0,0,0\n1,1,2,4,1,0,0,0").unwrap();
    assert_eq!(
        (path.times(), columns.time, columns.by_name),
        (None, None, false)
    );
    let (path, _) = read("0,1,2,3,1,0,0,0\n0.25,1,2,4,1,0,0,0").unwrap();
    assert_eq!(path.times().unwrap(), [0.0, 0.25]);
    let (path, columns) = read("1 2 3\n1 2 4").unwrap();
    assert_eq!((path.points().len(), columns.quaternion), (2, None));
    let text = b"1,2,3,0,0,0.6,0.8";
    let (path, _) = CartesianPath::from_csv(text, "p", QuaternionOrder::WLast).unwrap();
    assert!((path.points()[0].rotation.x.x - 0.28).abs() < 1e-15);
}

#[test]
fn invalid_tables_are_reported_with_their_line() {
    for (text, says) in [
        ("", "path.csv: has no points"),
        ("x,y,z\n", "has no points"),
        ("1,2,3,4,5\n", "line 1: has 5 columns"),
        ("1,2,3\n1,2,x\n", "line 2: `x` is not a finite number"),
        ("1,2,3\n1,2,nan\n", "line 2: `nan` is not a finite number"),
        (
            "1,2,3\n1,2\n",
            "line 2: has 2 columns, the first line has 3",
        ),
        ("1,2,3,0,0,0,2\n", "line 1: its quaternion has length 2"),
        ("time,x,y,z\n1,0,0,0\n0,0,0,0\n", "times must increase"),
        (
            "x,y,z,tool\n1,2,3,0\n1,2,3,0.5\n",
            "line 3: its tool is 0.5",
        ),
        ("x,y,z,tool\n1,2,3,-1\n", "line 2: its tool is -1"),
        ("x,y,z,tool\n1,2,3,1e300\n", "line 2: its tool is 1"),
    ] {
        let error = read(text).unwrap_err();
        assert!(error.contains(says), "{text:?}: {error}");
    }
    let error = CartesianPath::from_csv(&[0xff], "path.csv", QuaternionOrder::WFirst);
    error.says("UTF-8");
    let error = CartesianPath::read("/no/such/path.csv", QuaternionOrder::WFirst);
    error.says("/no/such/path.csv");
}
