//! Small rig with two arms, written by the library, and helpers that run the command on it.

use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::Vec3;
use kinopt::animation::{Armature, Clip, EulerClip, EulerKey, EulerTrack};
use kinopt::io::gltf::{self, Scene, SceneMesh, WriteOptions};
use kinopt::io::rig::Rig;
use kinopt::mesh::TriangleMesh;
use kinopt::model::Limits;
use kinopt::skeleton::{Bone, Skeleton};
use kinopt::skinning::SkinWeights;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use serde_json::Value;

/// Temporary folder of one test, removed at the end.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new(test: &str) -> Self {
        // Two tests can have the same name.
        static FOLDER_COUNT: AtomicUsize = AtomicUsize::new(0);
        let made = FOLDER_COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("kinopt-cli-{}-{made}-{test}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(crate) fn file(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }

    /// Folder with the rig, and the path of the rig's JSON file.
    pub(crate) fn with_rig(test: &str) -> (Self, String) {
        let folder = Self::new(test);
        let rig = folder.rig();
        (folder, rig)
    }

    /// Writes the whole rig and returns the path of its JSON file.
    pub(crate) fn rig(&self) -> String {
        self.write("rig.json", &rig())
    }

    pub(crate) fn write(&self, name: &str, rig: &Rig) -> String {
        let path = self.file(name);
        rig.write(&path).unwrap();
        path
    }

    /// Writes a changed rig and returns the path of its JSON file.
    pub(crate) fn changed<T>(&self, name: &str, change: impl FnOnce(&mut Rig) -> T) -> String {
        let mut changed = rig();
        change(&mut changed);
        self.write(name, &changed)
    }

    /// Writes a scene and returns its path.
    pub(crate) fn scene(&self, name: &str, scene: &Scene) -> String {
        let path = self.file(name);
        gltf::write(scene, &WriteOptions::default(), &path).unwrap();
        path
    }

    /// Writes a text file and returns its path.
    pub(crate) fn text(&self, name: &str, content: impl std::fmt::Display) -> String {
        let path = self.file(name);
        std::fs::write(&path, content.to_string()).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Rig with two arms and a mesh strip along each. Bone 0 is a locked root at the origin, and both tips are pinned.
/// Bone 1 has keyframes.
///
/// - Bones 1 and 2 go left from (−1, 0, 0) to (−3, 0, 0).
/// - Bones 3 and 4 go right from (1, 0, 0) to (3, 0, 0).
pub(crate) fn rig() -> Rig {
    let [x, y, z] = Vector3::UNITS;
    let towards_left = Matrix3::from_columns(-x, -y, z);
    let [root, left, right] = [
        Placement::identity(),
        Placement::new(towards_left, -x),
        Placement::translation(x),
    ];
    let offset = |placement: Placement<f64>| placement * Placement::translation(x);
    let locked = [Limits::new(0.0, 0.0); 3];
    let shoulder = [-1.5, -2.0, -1.0].map(|lower: f64| Limits::new(lower, -lower));
    let elbow = [
        Limits::new(-0.5, 0.5),
        Limits::new(-2.2, 0.1),
        Limits::new(0.0, 0.0),
    ];
    let plan = [
        (None, 0.0, root, locked),
        (Some(0), 1.0, left, shoulder),
        (Some(1), 1.0, offset(left), elbow),
        (Some(0), 1.0, right, shoulder),
        (Some(3), 1.0, offset(right), elbow),
    ];
    let mut skeleton = Skeleton::new("forked", Vec::new()).unwrap();
    for (index, (parent, length, model_from_rest, limits)) in plan.into_iter().enumerate() {
        let mut bones = skeleton.bones().to_vec();
        bones.push(Bone {
            name: format!("bone/{index}"),
            parent: parent.map(|index| skeleton.bone_at(index).unwrap()),
            length,
            model_from_rest,
            limits,
        });
        skeleton = Skeleton::new("forked", bones).unwrap();
    }
    let bone = |index| skeleton.bone_at(index).unwrap();
    let key = |time, bend| EulerKey {
        time,
        angles: [0.25, bend, -0.5],
    };
    let clip = EulerClip::new(vec![EulerTrack {
        bone: bone(1),
        keys: vec![key(0.5, 0.0), key(1.0, 1.0), key(2.0, -0.5)],
    }]);
    let (mesh, weights) = strips();
    Rig {
        mesh: Some(mesh),
        weights: Some(weights),
        clip: clip.unwrap(),
        constrained: vec![bone(2), bone(4)],
        notes: Vec::new(),
        skeleton,
    }
}

/// Two arms of five vertex pairs; each vertex follows the bone next to it.
fn strips() -> (TriangleMesh, SkinWeights) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let mut weights = SkinWeights::builder(20, 5);
    for (side, upper) in [(-1.0, 1), (1.0, 3)] {
        for pair in 0..5_u32 {
            let along = side * (1.0 + 0.5 * pair as f32);
            let first = positions.len() as u32;
            let bone = if pair < 2 { upper } else { upper + 1 };
            for y in [-0.1, 0.1] {
                weights.add(positions.len(), bone, 1.0).unwrap();
                positions.push(Vec3::new(along, y, 0.0));
            }
            if pair > 0 {
                triangles.push([first - 2, first - 1, first]);
                triangles.push([first, first - 1, first + 1]);
            }
        }
    }
    let mesh = TriangleMesh::new(positions, Vec::new(), triangles).unwrap();
    (mesh, weights.build().unwrap())
}

/// Runs a command line. Words are separated by spaces or enclosed in quotation marks. Words such as
/// `@solve.attempts=1` are keys of a problem file.
pub(crate) fn kinopt(line: &str) -> Output {
    let parts = line.split('\'').enumerate();
    let words = parts.map(|(k, part)| match k % 2 {
        0 => part.split_whitespace().collect(),
        _ => vec![part],
    });
    let words = words.collect::<Vec<Vec<&str>>>().concat();
    let (keys, words): (Vec<&str>, Vec<&str>) =
        words.into_iter().partition(|word| word.starts_with('@'));
    let mut command = Command::new(env!("CARGO_BIN_EXE_kinopt"));
    command.args(words);
    if keys.is_empty() {
        return command.output().unwrap();
    }
    let folder = Folder::new("problem");
    let file = folder.text("problem.json", problem(&keys));
    command.args(["--problem", &file]).output().unwrap()
}

/// Problem of keys such as `@solve.attempts=1`. A value that is not JSON is a string.
fn problem(keys: &[&str]) -> Value {
    let mut problem = Value::Object(Default::default());
    for key in keys {
        let (place, text) = key[1..].split_once('=').unwrap();
        let value = serde_json::from_str(text).unwrap_or_else(|_| text.into());
        let mut entry = &mut problem;
        for name in place.split('.') {
            entry = &mut entry[name];
        }
        *entry = value;
    }
    problem
}

/// Standard output and standard error of a run that must succeed.
#[track_caller]
pub(crate) fn succeeds(line: &str) -> (String, String) {
    let output = kinopt(line);
    let (text, messages) = (stdout(&output), stderr(&output));
    assert_eq!(output.status.code(), Some(0), "{line}: {messages}");
    (text.to_owned(), messages.to_owned())
}

/// Asserts that a run ends with `code`, prints nothing on standard output and reports all `words`, separated by bars.
/// A failure is one line.
pub(crate) fn refused(line: &str, code: i32, words: &str) {
    let output = kinopt(line);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{line:?}: {message}");
    assert_eq!(stdout(&output), "", "{line:?}");
    says(message, words);
    if code == 1 {
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(message.starts_with("kinopt: error: "), "{message}");
    }
}

/// [`refused`](crate::forked_rig::refused) with a format string: `refused!("info {rig}" => 1, "this | that")`.
macro_rules! refused {
    ($line:literal $(, $part:expr)* => $code:expr, $words:literal) => {
        $crate::forked_rig::refused(&format!($line $(, $part)*), $code, &format!($words))
    };
}

/// Runs a command line that can fail.
macro_rules! kinopt {
    ($line:literal $(, $part:expr)*) => { $crate::forked_rig::kinopt(&format!($line $(, $part)*)) };
}

/// Standard output as text of a run that must succeed.
macro_rules! text {
    ($line:literal $(, $part:expr)*) => {
        $crate::forked_rig::succeeds(&format!($line $(, $part)*)).0
    };
}

/// JSON document of a run that must succeed. The second form also returns its standard error.
macro_rules! answer {
    (with_messages $line:literal) => {{
        let (text, messages) = $crate::forked_rig::succeeds(&(format!($line) + " --json"));
        (serde_json::from_str::<serde_json::Value>(&text).unwrap(), messages)
    }};
    ($line:literal $(, $part:expr)*) => {{
        let line = format!($line $(, $part)*) + " --json";
        let text = $crate::forked_rig::succeeds(&line).0;
        serde_json::from_str::<serde_json::Value>(&text).unwrap()
    }};
}

/// [`says`](crate::forked_rig::says) with any string type: `says!(text => "this | that")`.
macro_rules! says {
    ($text:expr => $words:expr) => {
        $crate::forked_rig::says(&$text, $words)
    };
}

/// [`has`](crate::forked_rig::has) with a JSON literal: `has!(answer, {"reached": true, "tasks/0/frame": "hand"})`.
macro_rules! has {
    ($document:expr, $expected:tt) => {
        $crate::forked_rig::has(&$document, serde_json::json!($expected))
    };
}

/// Scene without notes.
pub(crate) fn scene(armature: Armature, meshes: Vec<SceneMesh>, clips: Vec<Clip>) -> Scene {
    let notes = Vec::new();
    Scene {
        armature,
        meshes,
        clips,
        notes,
    }
}

/// Names of the general solvers.
pub(crate) const METHODS: [&str; 5] = [
    "levenberg-marquardt",
    "levenberg-marquardt-error",
    "gauss-newton",
    "projected-gradient",
    "projected-gradient-bb",
];

/// Asserts that a text has all these words, which are separated by bars.
#[track_caller]
pub(crate) fn says(text: &str, words: &str) {
    for word in words.split(" | ") {
        assert!(text.contains(word), "no {word} in {text}");
    }
}

pub(crate) fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).unwrap()
}

pub(crate) fn stderr(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).unwrap()
}

/// Asserts that a document has these values at these keys, or at paths such as `tasks/0/frame`.
#[track_caller]
pub(crate) fn has(document: &Value, expected: Value) {
    for (path, expected) in expected.as_object().unwrap() {
        let found = document.pointer(&format!("/{path}"));
        assert_eq!(
            found.unwrap_or(&Value::Null),
            expected,
            "{path} of {document}"
        );
    }
}

/// Path of a file in the folder `models`.
pub(crate) fn model(name: &str) -> String {
    format!("{}/../models/{name}", env!("CARGO_MANIFEST_DIR"))
}

pub(crate) fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap()
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

pub(crate) fn count(value: &Value) -> u64 {
    value.as_u64().unwrap()
}

pub(crate) fn word(value: &Value) -> &str {
    value.as_str().unwrap()
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    list(value).iter().map(number).collect()
}

pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>().sqrt()
}

/// Comma-separated numbers with all digits.
pub(crate) fn commas(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
    numbers.join(",")
}
