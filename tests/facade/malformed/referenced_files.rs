//! Promise: a file opens no other file outside of its own folder and the folders listed by the caller. No error quotes
//! the content of a referenced file.
//!
//! Thousands of references are made by a fixed pseudo-random sequence: absolute paths, `..`, percent encodings, URLs,
//! backslashes and symbolic links. They lead to files outside, which are damaged, or valid and contain a secret.
#![cfg(unix)]

use std::fmt::Debug;
use std::os::unix::fs::symlink;
use std::path::PathBuf;

use kinopt::collision::{CollisionModel, CollisionModelError, SphereModel, World};
use kinopt::io::gltf::{self, SceneFile};
use kinopt::io::rig::Rig;
use kinopt::io::{FileAccess, FileLocation, ReadError};
use kinopt::robot::Robot;
use support::fault_tables::ExpectedError;
use support::folders::Folder;
use support::random::Random;
use support::small_rig;

/// Contained in every file outside, also as a vertex. Its length is a multiple of three bytes.
const SECRET: &str = "SECRET7f3a91c05be2";
/// The secret within a base64 text, where it begins at a multiple of three bytes.
const SECRET_IN_BASE64: &str = "U0VDUkVUN2YzYTkxYzA1YmUy";
/// A coordinate of the meshes outside.
const SECRET_NUMBER: &str = "48151.62";
const REFERENCES: usize = 800;

/// Files outside, with their names.
fn outside_files() -> Vec<(String, Vec<u8>)> {
    let ply = small_rig::PLY.replace("1 0 0\n", &format!("{SECRET_NUMBER} 0 0\n"));
    let ply = ply.replace("ply\n", &format!("ply\ncomment {SECRET}\n"));
    let stl = format!(
        "solid {SECRET}\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex {SECRET_NUMBER} 0 0\nvertex 0 1 1\n\
         endloop\nendfacet\nendsolid\n"
    );
    let obj = format!("# {SECRET}\nv 0 0 0\nv {SECRET_NUMBER} 0 0\nv 0 1 1\nf 1 2 3\n");
    let body = format!("<mujoco><worldbody><body name=\"{SECRET}\"/></worldbody></mujoco>");
    let png = [b"\x89PNG\r\n\x1a\n\0", SECRET.as_bytes()].concat();
    let mut files: Vec<(String, Vec<u8>)> = [
        ("good.ply", ply),
        ("good.stl", stl),
        ("good.obj", obj),
        ("good.dmat", small_rig::DMAT.into()),
        ("good.xml", body),
        ("bad.xml", format!("<{SECRET}></{SECRET}2>")),
        (
            "worse.xml",
            format!("<a><joint name=\"{SECRET}\" type=\"{SECRET}\"/></a>"),
        ),
        ("secret", format!("{SECRET}\nroot:x:0\n")),
    ]
    .map(|(name, text)| (name.to_owned(), text.into_bytes()))
    .into();
    for end in ["ply", "stl", "obj", "dae", "dmat", "png", "bin", "gltf"] {
        let text = format!("{SECRET} {SECRET}\n{SECRET}\n");
        files.push((format!("bad.{end}"), text.into_bytes()));
    }
    files.push(("good.png".into(), png.clone()));
    files.push(("good.bin".into(), [b"012", SECRET.as_bytes()].concat()));
    files
}

/// Folder with files outside, and a folder next to it with links to them.
struct Scenery {
    folder: Folder,
    names: Vec<String>,
}

impl Scenery {
    fn new(name: &str) -> Self {
        let folder = Folder::new(name);
        let (outside, inside) = (folder.path("outside"), folder.path("inside"));
        std::fs::create_dir_all(inside.join("sub")).unwrap();
        std::fs::create_dir_all(folder.path("written")).unwrap();
        std::fs::create_dir_all(&outside).unwrap();
        // A folder whose name has that of the allowed folder as its prefix.
        std::fs::create_dir_all(folder.path("inside2")).unwrap();
        let mut names = Vec::new();
        for (file, bytes) in outside_files() {
            std::fs::write(outside.join(&file), &bytes).unwrap();
            std::fs::write(folder.path("inside2").join(&file), &bytes).unwrap();
            symlink(
                format!("../outside/{file}"),
                inside.join(format!("link_{file}")),
            )
            .unwrap();
            symlink(outside.join(&file), inside.join("sub").join(&file)).unwrap();
            names.push(file);
        }
        symlink("../outside", inside.join("elsewhere")).unwrap();
        symlink("/", inside.join("root")).unwrap();
        symlink("link_to_link", inside.join("ring")).unwrap();
        symlink("ring", inside.join("link_to_link")).unwrap();
        Self { folder, names }
    }

    fn inside(&self) -> PathBuf {
        self.folder.path("inside")
    }

    /// A reference to a file outside.
    fn reference(&self, random: &mut Random) -> String {
        let file = &self.names[random.below(self.names.len())];
        let whole = self.folder.path("outside").join(file);
        let whole = whole.display().to_string();
        let plain = match random.below(28) {
            0 => whole,
            1 => format!("../outside/{file}"),
            2 => format!("sub/../../outside/{file}"),
            3 => format!("./sub/.././../outside/./{file}"),
            4 => format!("link_{file}"),
            5 => format!("sub/{file}"),
            6 => format!("elsewhere/{file}"),
            7 => format!("root{whole}"),
            8 => format!("file://{whole}"),
            9 => format!("file:{whole}"),
            10 => format!("file://localhost{whole}"),
            11 => format!("/{whole}"),
            12 => format!("/proc/self/root{whole}"),
            13 => format!("..\\outside\\{file}"),
            14 => format!("sub\\..\\..\\outside\\{file}"),
            15 => format!("../inside2/{file}"),
            16 => format!("../inside/../outside/{file}"),
            17 => format!("nothing/../../outside/{file}"),
            18 => format!("FILE://{whole}"),
            19 => format!("http://localhost{whole}"),
            20 => format!("../outside/{file}?{file}#{file}"),
            // Other characters that look like dots and slashes, and the end of a string in C.
            21 => format!("..\u{2215}outside\u{2215}{file}"),
            22 => format!("\u{ff0e}\u{ff0e}/outside/{file}"),
            23 => format!("\u{202e}../outside/{file}\u{feff}"),
            24 => format!("../outside/{file}\0.png"),
            25 => format!("own\0/../../outside/{file}"),
            26 => format!("~/{file} ../outside/{file}"),
            _ => format!("C:{}", whole.replace('/', "\\")),
        };
        match random.below(6) {
            0 => encoded(&plain, random),
            1 => encoded(&encoded(&plain, random), random),
            2 => plain.replace('/', "//"),
            3 => plain.replace("..", "%2e%2E"),
            _ => plain,
        }
    }
}

/// Replaces some bytes by percent encodings such as `%2e`.
fn encoded(plain: &str, random: &mut Random) -> String {
    let bytes = plain.bytes().map(|byte| match random.below(3) {
        0 => format!("%{byte:02x}"),
        1 => format!("%{byte:02X}"),
        _ => char::from(byte).to_string(),
    });
    bytes.collect()
}

/// Asserts that the text contains no part of the secret.
fn assert_silent(text: &str, reference: &str) {
    // The reference itself may be repeated; it contains no secret.
    for secret in [SECRET, SECRET_IN_BASE64, SECRET_NUMBER, "48151.6", "root:x"] {
        assert!(!text.contains(secret), "{reference}: {text}");
    }
}

fn assert_refused<T: Debug, E: std::error::Error>(result: Result<T, E>, reference: &str) {
    match result {
        Ok(found) => panic!("{reference} was opened: {found:?}"),
        Err(error) => assert_error_is_silent(&error, reference),
    }
}

fn assert_error_is_silent(error: &dyn std::error::Error, reference: &str) {
    let mut next = Some(error);
    while let Some(error) = next {
        assert_silent(&format!("{error} {error:?}"), reference);
        next = error.source();
    }
}

fn json(text: &str) -> String {
    serde_json::to_string(text).unwrap()
}

fn attribute(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('"', "&quot;")
        .replace('<', "&lt;")
}

fn for_references(name: &str, mut check: impl FnMut(&Scenery, &str)) {
    let scenery = Scenery::new(name);
    let mut random = Random::new(77);
    for _ in 0..REFERENCES {
        let reference = scenery.reference(&mut random);
        check(&scenery, &reference);
    }
}

fn buffer_document(reference: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":{},"byteLength":1}}],"nodes":[{{"name":"n"}}]}}"#,
        json(reference)
    )
}

#[test]
fn gltf_buffers_outside_the_folder_are_rejected() {
    for_references("refs-buffers", |scenery, reference| {
        let path = scenery.inside().join("scene.gltf");
        std::fs::write(&path, buffer_document(reference)).unwrap();
        assert_refused(gltf::read(&path), reference);
        assert_refused(SceneFile::read(&path), reference);
    });
}

#[test]
fn gltf_images_outside_the_folder_are_not_embedded() {
    for_references("refs-images", |scenery, reference| {
        let kind = ["", r#","mimeType":"image/png""#][reference.len() % 2];
        let document = format!(
            r#"{{"asset":{{"version":"2.0"}},"images":[{{"uri":{}{kind}}}],"nodes":[{{"name":"n"}}]}}"#,
            json(reference)
        );
        let path = scenery.inside().join("scene.gltf");
        std::fs::write(&path, document).unwrap();
        let scene = SceneFile::read(&path).unwrap();
        for end in ["gltf", "glb"] {
            let out = scenery.folder.path("written").join(format!("copy.{end}"));
            match scene.write(&out) {
                Ok(()) => {
                    let written = std::fs::read(&out).unwrap();
                    assert_silent(&String::from_utf8_lossy(&written), reference);
                    std::fs::remove_file(&out).unwrap();
                }
                Err(error) => assert_error_is_silent(&error, reference),
            }
        }
    });
}

#[test]
fn gltf_images_of_unknown_type_are_not_embedded() {
    let scenery = Scenery::new("refs-types");
    let png = b"\x89PNG\r\n\x1a\nrest".as_slice();
    let jpeg = b"\xff\xd8\xff\xe0rest".as_slice();
    let text = SECRET.as_bytes();
    for (bytes, kind, embedded) in [
        (png, None, Some("image/png")),
        (png, Some("image/png"), Some("image/png")),
        (jpeg, None, Some("image/jpeg")),
        (jpeg, Some("image/png"), None),
        (png, Some("text/plain"), None),
        (text, None, None),
        (text, Some("image/png"), None),
        (text, Some("text/plain"), None),
        (b"", Some("image/png"), None),
    ] {
        std::fs::write(scenery.inside().join("own.png"), bytes).unwrap();
        let kind = kind.map_or(String::new(), |kind| format!(r#","mimeType":"{kind}""#));
        let document = format!(
            r#"{{"asset":{{"version":"2.0"}},"images":[{{"uri":"own.png"{kind}}}],"nodes":[{{"name":"n"}}]}}"#
        );
        let path = scenery.inside().join("scene.gltf");
        std::fs::write(&path, document).unwrap();
        let out = scenery.folder.path("written").join("copy.gltf");
        let written = SceneFile::read(&path).unwrap().write(&out);
        match embedded {
            Some(kind) => {
                written.unwrap();
                let text = std::fs::read_to_string(&out).unwrap();
                assert!(text.contains(&format!("data:{kind};base64,")), "{text}");
            }
            None => {
                let error = written.unwrap_err();
                assert!(error.to_string().contains("images[0].uri"), "{error}");
                assert_error_is_silent(&error, "own.png");
            }
        }
    }
}

#[test]
fn scene_from_memory_opens_no_file_when_written() {
    let scenery = Scenery::new("refs-memory");
    let here = std::env::current_dir().unwrap().join("Cargo.toml");
    for reference in ["Cargo.toml", "main.rs", here.to_str().unwrap()] {
        let document = format!(
            r#"{{"asset":{{"version":"2.0"}},"images":[{{"uri":{}}}],"nodes":[{{"name":"n"}}]}}"#,
            json(reference)
        );
        let nothing = |file: &str| -> Result<Vec<u8>, ReadError> { panic!("{file}") };
        let scene = SceneFile::from_bytes(document.as_bytes(), "scene.gltf", nothing).unwrap();
        let out = scenery.folder.path("written").join("copy.gltf");
        scene.write(&out).unwrap();
        let text = std::fs::read_to_string(&out).unwrap();
        assert!(!text.contains("base64"), "{text}");
    }
}

#[test]
fn rig_files_outside_the_folder_are_rejected() {
    for_references("refs-rigs", |scenery, reference| {
        let path = scenery.inside().join("rig.json");
        std::fs::write(scenery.inside().join("small.ply"), small_rig::PLY).unwrap();
        let model = small_rig::JSON.replace("\"small.ply\"", &json(reference));
        std::fs::write(&path, &model).unwrap();
        assert_refused(Rig::read(&path), reference);
        let weights = small_rig::JSON.replace("\"small.dmat\"", &json(reference));
        std::fs::write(&path, &weights).unwrap();
        match Rig::read(&path) {
            Ok(rig) => assert!(rig.weights.is_none(), "{reference}"),
            Err(error) => assert_error_is_silent(&error, reference),
        }
    });
}

#[test]
fn world_meshes_outside_the_folder_are_rejected() {
    for_references("refs-worlds", |scenery, reference| {
        let path = scenery.inside().join("world.json");
        let text = format!(
            r#"{{"meshes":[{{"name":"mesh","file":{}}}]}}"#,
            json(reference)
        );
        std::fs::write(&path, &text).unwrap();
        assert_refused(World::read(&path), reference);
        assert_refused(World::from_json(text.as_bytes(), "world.json"), reference);
    });
}

fn urdf(reference: &str) -> String {
    format!(
        "<robot name='r'><link name='a'><collision><geometry><mesh filename=\"{}\"/></geometry></collision></link></robot>",
        attribute(reference)
    )
}

#[test]
fn confined_robot_opens_no_mesh_outside_its_folder() {
    for_references("refs-robots", |scenery, reference| {
        let path = scenery.inside().join("robot.urdf");
        for reference in [
            reference.to_owned(),
            format!("package://inside/{reference}"),
            format!("package://outside/{reference}"),
            format!("model://../{reference}"),
        ] {
            std::fs::write(&path, urdf(&reference)).unwrap();
            let robot = match Robot::reader().confined().read(&path) {
                Ok(robot) => robot,
                // XML has no such character.
                Err(error) if reference.contains('\0') => {
                    assert_error_is_silent(&error, &reference);
                    continue;
                }
                Err(error) => panic!("{error}"),
            };
            assert!(robot.is_confined());
            assert_refused(CollisionModel::of(&robot), &reference);
            // Without a path it opens nothing.
            let robot = Robot::reader().confined();
            let robot = robot.parse(&urdf(&reference), "robot.urdf").unwrap();
            assert_refused(CollisionModel::of(&robot), &reference);
            // An unconfined robot opens meshes elsewhere, and does not quote them.
            if let Err(error) = CollisionModel::of(&Robot::read(&path).unwrap()) {
                assert_error_is_silent(&error, &reference);
            }
        }
    });
}

#[test]
fn sphere_model_opens_no_mesh() {
    let text = "<robot name='r'><link name='a'><collision><geometry><sphere radius='1'/></geometry></collision></link></robot>";
    let robot = Robot::parse(text, "robot.urdf").unwrap();
    let model = CollisionModel::of(&robot).unwrap();
    for_references("refs-spheres", |_, reference| {
        let found = SphereModel::parse(urdf(reference).as_bytes(), "spheres.urdf", &model);
        assert_refused(found, reference);
    });
}

#[test]
fn confined_mjcf_includes_no_file_outside_its_folder() {
    for_references("refs-mjcf", |scenery, reference| {
        let path = scenery.inside().join("robot.xml");
        let include = format!("<include file=\"{}\"/>", attribute(reference));
        let text = format!(
            "<mujoco>{include}<worldbody><body name='b'>{include}</body></worldbody></mujoco>"
        );
        let once =
            format!("<mujoco><worldbody><body name='b'>{include}</body></worldbody></mujoco>");
        for text in [text, once] {
            std::fs::write(&path, &text).unwrap();
            assert_refused(Robot::mjcf_reader().confined().read(&path), reference);
            assert_refused(Robot::reader().confined().read(&path), reference);
            let joined = Robot::mjcf_reader().confined().text_with_includes(&path);
            assert_refused(joined, reference);
            if let Err(error) = Robot::read_mjcf(&path) {
                assert_error_is_silent(&error, reference);
            }
        }
    });
}

#[test]
fn confined_mjcf_opens_no_mesh_outside_its_folder() {
    for_references("refs-mjcf-meshes", |scenery, reference| {
        let path = scenery.inside().join("robot.xml");
        let outside = scenery.folder.path("outside").display().to_string();
        for folder in ["", "../outside", "elsewhere", &outside] {
            let text = format!(
                "<mujoco><compiler meshdir=\"{folder}\"/><asset><mesh name='m' file=\"{}\"/></asset>\
                 <worldbody><body name='b'><geom type='mesh' mesh='m'/></body></worldbody></mujoco>",
                attribute(reference)
            );
            std::fs::write(&path, &text).unwrap();
            let read = Robot::mjcf_reader().confined().read(&path);
            match read.map(|robot| CollisionModel::of(&robot)) {
                // Meshes of other kinds are omitted with a note.
                Ok(Ok(model)) => {
                    assert!(model.objects().is_empty(), "{folder} {reference}");
                    assert_silent(&format!("{model:?}"), reference);
                }
                Ok(Err(error)) => assert_error_is_silent(&error, reference),
                Err(error) => assert_error_is_silent(&error, reference),
            }
        }
    });
}

#[test]
fn confined_robot_reads_no_manifest_outside() {
    let scenery = Scenery::new("refs-manifests");
    let manifest = |folder: PathBuf, name: &str| {
        std::fs::create_dir_all(&folder).unwrap();
        let text = format!("<package><name>{name}</name></package>");
        std::fs::write(folder.join("package.xml"), text).unwrap();
    };
    // The package around the robot's folder, one next to it, and one whose manifest is a link that leads outside.
    manifest(scenery.folder.path(""), "around");
    manifest(scenery.folder.path("outside"), "outer");
    manifest(scenery.inside().join("own"), "inner");
    let linked = scenery.inside().join("linked");
    std::fs::create_dir_all(&linked).unwrap();
    symlink("../../outside/package.xml", linked.join("package.xml")).unwrap();
    let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    for folder in [
        scenery.folder.path("outside"),
        scenery.inside().join("own"),
        linked,
    ] {
        std::fs::write(folder.join("body.obj"), mesh).unwrap();
    }
    let path = scenery.inside().join("robot.urdf");
    let model = |reference: &str, confined: bool| {
        std::fs::write(&path, urdf(reference)).unwrap();
        let reader = Robot::reader();
        let reader = if confined { reader.confined() } else { reader };
        let robot = reader.read(&path).unwrap();
        let builder = CollisionModel::builder(&robot).with_package_folder(scenery.inside());
        builder.build()
    };
    let result = model("package://inner/body.obj", true);
    assert!(result.is_ok(), "{result:?}");
    for reference in [
        "package://around/outside/body.obj",
        "package://outer/body.obj",
    ] {
        let found = model(reference, false);
        assert!(found.is_ok(), "{found:?}");
        let CollisionModelError::MeshNotFound { looked_at, .. } =
            model(reference, true).unwrap_err()
        else {
            panic!("{reference}");
        };
        assert!(
            looked_at
                .iter()
                .all(|path| path.starts_with(scenery.inside()))
        );
    }
}

#[test]
fn callbacks_get_names_below_the_folder_alone() {
    let mut opened = Vec::new();
    for_references("refs-callbacks", |_, reference| {
        let mut open = |file: &str| {
            opened.push(file.to_owned());
            Err(ReadError {
                file: file.to_owned(),
                place: FileLocation::File,
                problem: std::io::Error::from(std::io::ErrorKind::NotFound).into(),
            })
        };
        let document = buffer_document(reference);
        let scene = gltf::from_bytes(document.as_bytes(), "scene.gltf", &mut open);
        assert_refused(scene, reference);
        let rig = small_rig::JSON.replace("\"small.ply\"", &json(reference));
        assert_refused(Rig::parse(rig.as_bytes(), "rig.json", &mut open), reference);
    });
    assert!(opened.len() > REFERENCES / 10);
    for file in opened {
        // Separators of Unix and of Windows.
        let parts: Vec<&str> = file.split(['/', '\\']).collect();
        assert!(
            !file.starts_with(['/', '\\']) && file.as_bytes()[1] != b':',
            "{file}"
        );
        let depth = parts.iter().try_fold(0_i32, |depth, part| match *part {
            "" | "." => Some(depth),
            ".." => (depth > 0).then(|| depth - 1),
            _ => Some(depth + 1),
        });
        assert!(depth.is_some(), "{file}");
    }
}

#[test]
fn listed_folders_and_links_within_are_opened() {
    let scenery = Scenery::new("refs-listed");
    let inside = scenery.inside();
    std::fs::write(inside.join("own.ply"), small_rig::PLY).unwrap();
    symlink("../own.ply", inside.join("sub/again.ply")).unwrap();
    let listed = FileAccess::new().with_folder(scenery.folder.path("outside"));
    let outside = scenery
        .folder
        .path("outside/good.ply")
        .display()
        .to_string();
    let path = inside.join("world.json");
    let read = |reference: &str, access: &FileAccess| {
        let text = format!(
            r#"{{"meshes":[{{"name":"mesh","file":{}}}]}}"#,
            json(reference)
        );
        std::fs::write(&path, text).unwrap();
        World::read_with(&path, access)
    };
    for reference in ["own.ply", "sub/again.ply", "sub/../own.ply"] {
        read(reference, &FileAccess::new()).unwrap();
    }
    for reference in [
        "../outside/good.ply",
        "link_good.ply",
        "elsewhere/good.ply",
        &outside,
    ] {
        read(reference, &listed).unwrap();
        assert_refused(read(reference, &FileAccess::new()), reference);
    }
    // Not listed, although its name has that of a listed folder as its prefix.
    assert_refused(read("../inside2/good.ply", &listed), "inside2");
    let error = read("../outside/good.ply", &FileAccess::new()).unwrap_err();
    let text = error.to_string();
    assert!(
        text.contains("meshes[0]") && text.contains("outside of the folders"),
        "{text}"
    );
    assert!(text.contains(inside.to_str().unwrap()), "{text}");
}

#[test]
fn files_above_the_size_limit_are_not_read() {
    let scenery = Scenery::new("refs-sizes");
    let path = scenery.inside().join("long.gltf");
    let file = std::fs::File::create(&path).unwrap();
    // A sparse file: nothing of it is on disk, and nothing may be read.
    file.set_len((1 << 30) + 1).unwrap();
    let is_too_long = |error: ReadError, limit: u64| matches!(error.problem, kinopt::io::ReadProblem::TooLong { limit: own } if own == limit);
    assert!(is_too_long(gltf::read(&path).unwrap_err(), 1 << 30));
    assert!(is_too_long(Rig::read(&path).unwrap_err(), 1 << 30));
    let access = FileAccess::new().with_max_bytes(100);
    assert!(is_too_long(
        gltf::read_with(&path, &access).unwrap_err(),
        100
    ));
    let world = scenery.inside().join("world.json");
    std::fs::write(&world, r#"{"meshes":[{"name":"m","file":"own.ply"}]}"#).unwrap();
    std::fs::write(scenery.inside().join("own.ply"), small_rig::PLY).unwrap();
    World::read_with(&world, &access).says("100 bytes");
    World::read_with(&world, &FileAccess::new()).unwrap();
}
