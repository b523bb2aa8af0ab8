//! glTF documents as text: numbers are in a data URI, everything else is JSON.

use kinopt::animation::{Cursor, Playback, Pose};
use kinopt::io::ReadError;
use kinopt::io::gltf::{self, Scene};

/// Buffer of a document, its views and its accessors.
#[derive(Default)]
pub struct Numbers {
    bytes: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

pub const U8: u32 = 5121;
pub const U16: u32 = 5123;
pub const F32: u32 = 5126;

impl Numbers {
    /// View of bytes, at an offset that is a multiple of 4.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        while !self.bytes.len().is_multiple_of(4) {
            self.bytes.push(0);
        }
        let (offset, length) = (self.bytes.len(), bytes.len());
        self.bytes.extend_from_slice(bytes);
        self.views.push(format!(
            r#"{{"buffer":0,"byteOffset":{offset},"byteLength":{length}}}"#
        ));
        self.views.len() - 1
    }

    pub fn accessor(&mut self, json: String) -> usize {
        self.accessors.push(json);
        self.accessors.len() - 1
    }

    /// Accessor with a view of its own bytes; `more` is empty, or JSON that starts with a comma.
    pub fn raw(
        &mut self,
        bytes: &[u8],
        component: u32,
        kind: &str,
        count: usize,
        more: &str,
    ) -> usize {
        let view = self.view(bytes);
        self.accessor(format!(
            r#"{{"bufferView":{view},"componentType":{component},"type":"{kind}","count":{count}{more}}}"#
        ))
    }

    /// Accessor of floats.
    pub fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values
            .as_flattened()
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        let kind = match N {
            1 => "SCALAR",
            3 => "VEC3",
            4 => "VEC4",
            16 => "MAT4",
            _ => "VEC2",
        };
        self.raw(&bytes, F32, kind, values.len(), "")
    }

    pub fn shorts<const N: usize>(&mut self, values: &[[u16; N]]) -> usize {
        let bytes: Vec<u8> = values
            .as_flattened()
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        let kind = if N == 1 { "SCALAR" } else { "VEC4" };
        self.raw(&bytes, U16, kind, values.len(), "")
    }

    pub fn bytes<const N: usize>(&mut self, values: &[[u8; N]], more: &str) -> usize {
        let kind = if N == 1 { "SCALAR" } else { "VEC4" };
        self.raw(values.as_flattened(), U8, kind, values.len(), more)
    }

    /// Complete document; `rest` contains the other keys.
    pub fn document(&self, rest: &str) -> String {
        let length = self.bytes.len();
        let uri = format!(
            "data:application/octet-stream;base64,{}",
            base64(&self.bytes)
        );
        self.document_of(&format!(r#"{{"uri":"{uri}","byteLength":{length}}}"#), rest)
    }

    fn document_of(&self, buffer: &str, rest: &str) -> String {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{buffer}],"bufferViews":[{}],"accessors":[{}],{rest}}}"#,
            self.views.join(","),
            self.accessors.join(","),
        )
    }

    /// Complete document as GLB.
    pub fn glb(&self, rest: &str) -> Vec<u8> {
        let length = self.bytes.len();
        let json = self.document_of(&format!(r#"{{"byteLength":{length}}}"#), rest);
        let mut binary = self.bytes.clone();
        binary.resize(length.next_multiple_of(4), 0);
        glb(&json, &binary)
    }

    pub fn read(&self, rest: &str) -> Scene {
        read(self.document(rest).as_bytes()).unwrap()
    }

    pub fn refused(&self, rest: &str) -> String {
        read(self.document(rest).as_bytes())
            .unwrap_err()
            .to_string()
    }
}

/// Small file with a skin, sparse morph targets, cubic splines and a matrix.
pub fn small() -> (Numbers, String) {
    let mut numbers = Numbers::default();
    let positions = numbers.floats(&[
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
    ]);
    let normals = numbers.floats(&[[0.0, 0.0, 1.0]; 4]);
    let joints = numbers.bytes(&[[0, 1, 0, 0]; 4], "");
    let weights = numbers.bytes(
        &[
            [255, 0, 0, 0],
            [51, 204, 0, 0],
            [0, 255, 0, 0],
            [1, 254, 0, 0],
        ],
        r#","normalized":true"#,
    );
    let identity = [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ];
    let bound = numbers.floats(&[identity; 2]);
    let indices = numbers.shorts(&[[0], [1], [2], [1], [3], [2]]);
    let places = numbers.view(&[1, 0, 3, 0]);
    let deltas: Vec<u8> = [0.0f32, 0.0, 2.0, 0.5, 0.0, 0.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let deltas = numbers.view(&deltas);
    let sparse = numbers.accessor(format!(
        r#"{{"componentType":5126,"type":"VEC3","count":4,"sparse":{{"count":2,"indices":{{"bufferView":{places},"componentType":5123}},"values":{{"bufferView":{deltas}}}}}}}"#
    ));
    let times = numbers.floats(&[[0.0], [0.5]]);
    let cubic = numbers.floats(&[[0.0, 0.0, 0.0, 1.0]; 6]);
    let moves = numbers.floats(&[[0.0, 1.0, 0.0], [0.5, 1.0, 0.0]]);
    let morphs = numbers.floats(&[[0.0], [1.0]]);
    let rest = format!(
        r#""nodes":[{{"name":"upper","translation":[0,1,0]}},{{"name":"lower","children":[0],"rotation":[0,0,0,1]}},
        {{"name":"body","mesh":0,"skin":0,"weights":[0.5]}},{{"children":[1,2],"matrix":[2,0,0,0,0,2,0,0,0,0,2,0,1,2,3,1]}}],
        "scene":0,"scenes":[{{"nodes":[3]}}],
        "meshes":[{{"name":"tube","extras":{{"targetNames":["bulge"]}},"primitives":[{{"indices":{indices},"mode":4,
        "attributes":{{"POSITION":{positions},"NORMAL":{normals},"JOINTS_0":{joints},"WEIGHTS_0":{weights}}},"targets":[{{"POSITION":{sparse}}}]}}]}}],
        "skins":[{{"joints":[1,0],"inverseBindMatrices":{bound}}}],
        "animations":[{{"name":"bend","samplers":[{{"input":{times},"output":{cubic},"interpolation":"CUBICSPLINE"}},{{"input":{times},"output":{moves}}},{{"input":{times},"output":{morphs},"interpolation":"STEP"}}],
        "channels":[{{"sampler":0,"target":{{"node":0,"path":"rotation"}}}},{{"sampler":1,"target":{{"node":1,"path":"translation"}}}},{{"sampler":2,"target":{{"node":2,"path":"weights"}}}}]}}]"#
    );
    (numbers, rest)
}

/// Reads a file without external references.
pub fn read(bytes: &[u8]) -> Result<Scene, ReadError> {
    gltf::from_bytes(bytes, "own.gltf", |file| {
        let missing = std::env::temp_dir().join("there/is/no").join(file);
        Err(gltf::read(missing).unwrap_err())
    })
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let word = [0, 1, 2].map(|k| u32::from(chunk.get(k).copied().unwrap_or(0)));
        let word = word[0] << 16 | word[1] << 8 | word[2];
        for digit in 0..4 {
            let value = (word >> (18 - 6 * digit)) & 63;
            text.push(if digit <= chunk.len() {
                DIGITS[value as usize] as char
            } else {
                '='
            });
        }
    }
    text
}

/// Pose of a clip at a time of the file, in seconds.
pub fn at(scene: &Scene, clip: usize, time: f64) -> Pose {
    let mut pose = scene.armature.rest().clone();
    let mut cursor = Cursor::new();
    let clip = &scene.clips[clip];
    clip.sample(time, Playback::Hold, &mut cursor, &mut pose)
        .unwrap();
    pose
}

/// GLB file of these chunks. The binary chunk may have any length, as other programs write it.
pub fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut file = [b"glTF", &2u32.to_le_bytes()[..], &[0; 4]].concat();
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    for (kind, bytes) in [(b"JSON", &json[..]), (b"BIN\0", binary)] {
        file.extend((bytes.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(bytes);
    }
    let length = file.len() as u32;
    file[8..12].copy_from_slice(&length.to_le_bytes());
    file
}
