//! Rig of three bones and one triangle, in memory.

use kinopt::io::rig::Rig;
use kinopt::io::{FileLocation, ReadError};

pub const JSON: &str = r#"{
"model": {"file": "small.ply"}, "weights": {"file": "small.dmat"}, "author": {"x": [1, null]},
"ik_constraints": [2],
"fk_animation": [{"bone_id": 1, "keys": [{"t": 0.75, "xzx": [0, 10, 0]}, {"t": 1.75, "xzx": [5, -20.25, 7]}]}],
"bones": [
{"parent_id":-1,"weight_id":-1,"length":0,"xzx_min":[0,0,0],"xzx_max":[0,0,0],
 "rest_T":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]},
{"parent_id":0,"weight_id":0,"length":0.5,"xzx_min":[-10,-20,-1e10],"xzx_max":[10,90,1e10],
 "rest_T":[[1,0,0,0.125],[0,1,0,0],[0,0,1,0],[0,0,0,1]]},
{"parent_id":1,"weight_id":1,"length":0.25,
 "rest_T":[[0,-1,0,0.625],[1,0,0,0],[0,0,1,0.1],[0,0,0,1]]}
]}"#;

pub const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n\
    property float y\nproperty float z\nelement face 1\n\
    property list uchar uint vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0.5\n3 0 1 2\n";

pub const DMAT: &str = "2 3\n1\n0.5\n0\n0\n0.5\n1\n";

/// Its three files; a file that is `None` does not exist.
pub struct SmallRig {
    pub json: Vec<u8>,
    pub ply: Option<Vec<u8>>,
    pub dmat: Option<Vec<u8>>,
}

impl SmallRig {
    pub fn with_json(json: &str) -> Self {
        Self {
            json: json.into(),
            ply: Some(PLY.into()),
            dmat: Some(DMAT.into()),
        }
    }

    pub fn parse(&self) -> Result<Rig, ReadError> {
        Rig::parse(&self.json, "small.json", |file| {
            let part = match file {
                "small.ply" => self.ply.clone(),
                "small.dmat" => self.dmat.clone(),
                _ => None,
            };
            part.ok_or_else(|| ReadError {
                file: file.into(),
                place: FileLocation::File,
                problem: std::io::Error::from(std::io::ErrorKind::NotFound).into(),
            })
        })
    }
}
