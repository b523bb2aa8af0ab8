//! Promise: a file with an added clip or posed nodes keeps everything else byte for byte, known to the reader or not.

use glam::{Quat, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::rotation::RotationCurve;
use kinopt::animation::{Channel, Clip, LocalTransform, Pose};
use kinopt::io::ReadError;
use kinopt::io::gltf::{self, Scene, SceneFile, ScenePosing, UnwritableScene, WriteOptions};
use kinopt::skinning::SkinningMethod;
use serde_json::Value;
use support::fault_tables::ExpectedError;
use support::folders::Folder;
use support::gltf_text::{Numbers, at, glb, small};

/// JSON that no reader here uses, with unusual spacing and numbers with more digits than a double.
const UNKNOWN: &str = r#""materials":[{"name":"fur" , "pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1},"roughnessFactor":0.300000000000000044},"extensions":{"ACME_fur":{"hairs":[1,2e0,3]}}}],
 "textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":10497}],"cameras":[{"type":"perspective","perspective":{"yfov":0.80,"znear":1e-2}}],
 "extensionsUsed":["ACME_fur"],"extensions":{"ACME_fur":{"wind" :[ 0,0 , 1.50 ]}},"extras":{"author":"\u00e4","count":12345678901234567890}"#;
/// Arbitrary bytes as image data.
const IMAGE: [u8; 7] = [0x89, b'P', b'N', b'G', 0, 255, 7];

/// The small file of all tests with an image in its buffer and keys unknown to the reader.
fn file() -> (Numbers, String, usize) {
    let (mut numbers, rest) = small();
    let view = numbers.view(&IMAGE);
    let image = format!(r#""images":[{{"bufferView":{view},"mimeType":"image/png"}}]"#);
    (numbers, format!("{rest},{image},{UNKNOWN}"), view)
}

fn no_referenced_files(_: &str) -> Result<Vec<u8>, ReadError> {
    unreachable!()
}

fn opened(bytes: &[u8]) -> SceneFile {
    SceneFile::from_bytes(bytes, "own", no_referenced_files).unwrap()
}

fn scene(bytes: &[u8]) -> Scene {
    gltf::from_bytes(bytes, "again", no_referenced_files).unwrap()
}

/// Clip that moves each bone; one of them has a matrix in the file.
fn wave(scene: &Scene) -> Clip {
    let mut builder = Clip::builder("wave", &scene.armature);
    for (index, bone) in scene.armature.bone_ids().enumerate() {
        let turned = Quat::from_rotation_x(0.3 + index as f32);
        let turn = RotationCurve::slerp(vec![0.0, 0.25, 1.0], vec![Quat::IDENTITY, turned, turned]);
        builder
            .channel(bone, Channel::Rotation(turn.unwrap()))
            .unwrap();
        let places = vec![Vec3A::ZERO, Vec3A::new(1.0, index as f32, 3.0)];
        let moved = KeyedCurve::linear(vec![0.0, 1.0], places).unwrap();
        builder.channel(bone, Channel::Translation(moved)).unwrap();
    }
    let bulge = KeyedCurve::linear(vec![0.0, 1.0], vec![0.0, 0.75]).unwrap();
    builder.morph_weight(0, bulge).unwrap();
    builder.build()
}

fn sampled(scene: &Scene, clip: usize) -> Vec<Pose> {
    (0..=20)
        .map(|k| at(scene, clip, f64::from(k) / 20.0))
        .collect()
}

/// JSON text of a .gltf or .glb file.
fn text(bytes: &[u8]) -> String {
    let json = match bytes.strip_prefix(b"glTF") {
        Some(_) => {
            let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
            &bytes[20..20 + length]
        }
        None => bytes,
    };
    String::from_utf8(json.to_vec()).unwrap()
}

fn binary(bytes: &[u8]) -> &[u8] {
    let json = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let at = 20 + json;
    let length = u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    &bytes[at + 8..at + 8 + length]
}

fn with_wave(bytes: &[u8]) -> Vec<u8> {
    let mut file = opened(bytes);
    let clip = wave(file.scene());
    file.add_clip(&clip, &WriteOptions::default()).unwrap();
    file.to_bytes().unwrap()
}

#[test]
fn unknown_content_keeps_its_text() {
    let (numbers, rest, _) = file();
    for before in [numbers.document(&rest).into_bytes(), numbers.glb(&rest)] {
        let after = text(&with_wave(&before));
        for member in UNKNOWN.split_inclusive("]").map(str::trim) {
            let member_text = member.trim_start_matches(',').trim();
            assert!(
                after.contains(member_text),
                "{member_text} is not in {after}"
            );
        }
        let [old, new]: [Value; 2] =
            [text(&before), after].map(|text| serde_json::from_str(&text).unwrap());
        for (key, value) in old.as_object().unwrap() {
            let now = &new[key];
            match key.as_str() {
                // Existing entries stay first.
                "accessors" | "bufferViews" | "animations" => {
                    let old = value.as_array().unwrap();
                    assert_eq!(
                        &now.as_array().unwrap()[..old.len()],
                        old.as_slice(),
                        "{key}"
                    );
                    assert!(now.as_array().unwrap().len() > old.len());
                }
                "buffers" => assert_eq!(now[0]["uri"], value[0]["uri"]),
                // The node with a matrix is animated now, so the matrix is replaced by separate properties.
                "nodes" => assert_eq!(now.as_array().unwrap()[..3], value.as_array().unwrap()[..3]),
                _ => assert_eq!(now, value, "{key}"),
            }
        }
    }
}

#[test]
fn buffers_keep_their_bytes() {
    let (numbers, rest, view) = file();
    let before = numbers.glb(&rest);
    let after = with_wave(&before);
    assert!(binary(&after).starts_with(binary(&before)));
    let document: Value = serde_json::from_str(&text(&after)).unwrap();
    let offset = document["bufferViews"][view]["byteOffset"]
        .as_u64()
        .unwrap() as usize;
    assert_eq!(binary(&after)[offset..offset + IMAGE.len()], IMAGE);
}

#[test]
fn added_clip_is_read_after_the_others() {
    let (numbers, rest, _) = file();
    for before in [numbers.document(&rest).into_bytes(), numbers.glb(&rest)] {
        let (old, new) = (scene(&before), scene(&with_wave(&before)));
        assert_eq!(new.clips.len(), old.clips.len() + 1);
        assert_eq!(new.clips[0], old.clips[0]);
        let clip = wave(&old);
        assert_eq!(new.clips[1].name(), "wave");
        let expected = Scene {
            clips: vec![clip],
            ..old.clone()
        };
        assert_eq!(sampled(&new, 1), sampled(&expected, 0));
        assert_eq!((new.armature, new.meshes), (old.armature, old.meshes));
    }
}

#[test]
fn second_clip_is_added_after_the_first() {
    let (numbers, rest, _) = file();
    let once = with_wave(&numbers.glb(&rest));
    let mut file = opened(&once);
    let other = wave(file.scene()).renamed("wave back");
    file.add_clip(&other, &WriteOptions::default()).unwrap();
    let twice = scene(&file.to_bytes().unwrap());
    assert_eq!(twice.clips[1].clone().renamed("wave back"), twice.clips[2]);
    assert_eq!(file.scene().clips.len(), 3);
}

#[test]
fn unchanged_document_stays_the_same() {
    let (numbers, rest, _) = file();
    let glb = opened(&numbers.glb(&rest)).to_bytes().unwrap();
    let [old, new]: [Value; 2] =
        [text(&numbers.glb(&rest)), text(&glb)].map(|text| serde_json::from_str(&text).unwrap());
    assert_eq!(old, new);
    assert_eq!(binary(&glb), binary(&numbers.glb(&rest)));
}

#[test]
fn chunks_of_other_kinds_are_kept() {
    let (numbers, rest, _) = file();
    // The last chunk is padded with zeros, because chunks end at multiples of four.
    for (length, chunk, expected) in [(4_u32, "ACMEfurs", "ACMEfurs"), (3, "ACMEfur", "ACMEfur\0")]
    {
        let mut before = numbers.glb(&rest);
        before.extend(length.to_le_bytes());
        before.extend(chunk.bytes());
        let length = before.len() as u32;
        before[8..12].copy_from_slice(&length.to_le_bytes());
        let expected = [b"\x04\0\0\0", expected.as_bytes()].concat();
        assert!(with_wave(&before).ends_with(&expected));
    }
}

/// Other programs write chunks whose length is not a multiple of four.
#[test]
fn clip_after_a_buffer_of_any_length_is_aligned() {
    let (numbers, rest, _) = file();
    let whole = numbers.glb(&rest);
    let odd = [binary(&whole), &[9]].concat();
    let before = glb(&text(&whole), &odd);
    let after = with_wave(&before);
    let after_binary = binary(&after);
    assert!(after_binary.starts_with(&odd));
    assert_eq!(after_binary[odd.len()..odd.len() + 3], [0; 3]);
    let (old, new) = (scene(&before), scene(&after));
    assert_eq!(new.clips[0], old.clips[0]);
    let expected = Scene {
        clips: vec![wave(&old)],
        ..old
    };
    assert_eq!(sampled(&new, 1), sampled(&expected, 0));
    // Without a new clip the chunk is padded as the format requires.
    let same = opened(&before).to_bytes().unwrap();
    assert_eq!(binary(&same), [&odd[..], &[0; 3]].concat());
}

/// A node without animation keeps its matrix.
#[test]
fn node_without_animation_keeps_its_matrix() {
    let (numbers, rest) = small();
    let before = numbers.document(&rest);
    let matrix = r#""matrix":[2,0,0,0,0,2,0,0,0,0,2,0,1,2,3,1]"#;
    assert!(before.contains(matrix));
    let mut file = opened(before.as_bytes());
    let (armature, upper) = (&file.scene().armature, "upper");
    let mut builder = Clip::builder("nod", armature);
    let turns = vec![Quat::IDENTITY, Quat::from_rotation_x(1.0)];
    let turn = RotationCurve::slerp(vec![0.0, 1.0], turns).unwrap();
    let bone = armature.bone(upper).unwrap();
    builder.channel(bone, Channel::Rotation(turn)).unwrap();
    file.add_clip(&builder.build(), &WriteOptions::default())
        .unwrap();
    let after = String::from_utf8(file.to_bytes().unwrap()).unwrap();
    assert!(after.contains(matrix), "{after}");
}

/// Only the buffer that grows is encoded again.
#[test]
fn second_buffer_keeps_its_text() {
    let (numbers, rest, _) = file();
    let whole = numbers.glb(&rest);
    let other = r#"{ "uri" : "data:application/octet-stream;base64,AAAA" , "byteLength" : 3 }"#;
    let text = text(&whole);
    let (before, after) = text.split_once(r#"],"bufferViews""#).unwrap();
    let two = format!(r#"{before},{other}],"bufferViews"{after}"#);
    let after_text = self::text(&with_wave(&glb(&two, binary(&whole))));
    assert!(after_text.contains(other), "{after_text}");
}

#[test]
fn taken_clip_name_is_rejected_with_all_names() {
    let (numbers, rest, _) = file();
    let mut file = opened(&numbers.glb(&rest));
    let clip = wave(file.scene()).renamed("bend");
    let refused = file.add_clip(&clip, &WriteOptions::default());
    assert!(matches!(
        &refused,
        Err(UnwritableScene::ClipNameTaken { .. })
    ));
    refused.says("`bend`");
    assert_eq!(
        file.to_bytes().unwrap(),
        opened(&numbers.glb(&rest)).to_bytes().unwrap()
    );
}

#[test]
fn posed_file_has_the_pose_and_keeps_its_clips() {
    let (numbers, rest, _) = file();
    let mut file = opened(&numbers.glb(&rest));
    let old = file.scene().clone();
    let mut pose = old.armature.rest().clone();
    for (index, bone) in old.armature.bone_ids().enumerate() {
        let local = LocalTransform {
            rotation: Quat::from_rotation_z(0.1 * (index as f32 + 1.0)),
            ..old.armature.rest().local(bone).unwrap()
        };
        pose.set_local(bone, local).unwrap();
    }
    pose.morph_weights_mut()[0] = 0.25;
    file.set_rest(&pose).unwrap();
    let new = scene(&file.to_bytes().unwrap());
    assert_eq!(new.armature.rest(), &pose);
    assert_eq!(file.scene().armature, new.armature);
    assert_eq!(file.scene().clips, new.clips);
    let posed = |scene: &Scene, pose: &Pose| {
        let mut posing = ScenePosing::new(scene, SkinningMethod::LinearBlend).unwrap();
        posing.mesh(pose).unwrap()
    };
    assert_eq!(posed(&new, new.armature.rest()), posed(&old, &pose));
    assert_eq!(new.clips[0].span(), old.clips[0].span());
}

#[test]
fn referenced_files_are_copied_to_another_folder() {
    let folder = Folder::new("beside");
    std::fs::create_dir(folder.path("elsewhere")).unwrap();
    let path = |file: &str| folder.path(file);
    let (numbers, rest) = small();
    let images = r#""images":[{"uri":"a%20coat.png"},{ "uri" : "gone.png" },{ "uri":"data:image/png;base64,AAAA" }]"#;
    let before = numbers.document(&format!("{rest},{images}"));
    std::fs::write(path("fox.gltf"), &before).unwrap();
    let file = SceneFile::read(path("fox.gltf")).unwrap();
    // A missing image cannot be copied; its name is kept.
    file.write(path("elsewhere/bare.gltf")).unwrap();
    std::fs::write(path("a coat.png"), b"\x89PNG\r\n\x1a\n\x00\xff\x07").unwrap();
    file.write(path("same.gltf")).unwrap();
    file.write(path("elsewhere/fox.gltf")).unwrap();
    let uri = |file: &str| {
        let text = std::fs::read_to_string(path(file)).unwrap();
        let document: Value = serde_json::from_str(&text).unwrap();
        document["images"][0]["uri"].as_str().unwrap().to_owned()
    };
    assert_eq!(uri("same.gltf"), "a%20coat.png");
    assert_eq!(uri("elsewhere/bare.gltf"), "a%20coat.png");
    // Eleven bytes in base64, encoded by hand.
    assert_eq!(
        uri("elsewhere/fox.gltf"),
        "data:image/png;base64,iVBORw0KGgoA/wc="
    );
    // References to files that are not copied are unchanged.
    let text = std::fs::read_to_string(path("elsewhere/fox.gltf")).unwrap();
    for (_, image) in images.split_once("},").into_iter() {
        let image = image.strip_suffix(']').unwrap();
        assert!(text.contains(image), "{image} is not in {text}");
    }
    file.write(path("fox.obj")).says(".gltf");
}

/// If it were omitted silently, the new file would refer to a missing file.
#[test]
fn unreadable_referenced_file_is_named() {
    let folder = Folder::new("unread");
    for folder_name in ["elsewhere", "coat.png"] {
        std::fs::create_dir(folder.path(folder_name)).unwrap();
    }
    let (numbers, rest) = small();
    let before = numbers.document(&format!(r#"{rest},"images":[{{"uri":"coat.png"}}]"#));
    std::fs::write(folder.path("fox.gltf"), before).unwrap();
    let file = SceneFile::read(folder.path("fox.gltf")).unwrap();
    let other_path = folder.path("elsewhere/fox.gltf");
    let error = file.write(&other_path).unwrap_err().to_string();
    for word in ["images[0].uri", "coat.png", "not a regular file"] {
        assert!(error.contains(word), "no {word} in {error}");
    }
    assert!(!other_path.exists());
}

/// A binary file may have a buffer in its JSON text.
#[test]
fn text_buffer_in_a_binary_file_keeps_its_text() {
    let folder = Folder::new("text-in-binary");
    let (numbers, rest) = small();
    let whole = numbers.document(&rest);
    let file = opened(&glb(&whole, &IMAGE));
    file.write(folder.path("fox.gltf")).unwrap();
    let written = std::fs::read(folder.path("fox.gltf")).unwrap();
    let read = scene(&written);
    assert_eq!(read.meshes, file.scene().meshes);
    assert_eq!(read.clips, file.scene().clips);
}

#[test]
fn text_and_binary_files_are_converted() {
    let folder = Folder::new("kinds");
    let path = |file: &str| folder.path(file);
    let (numbers, rest, _) = file();
    std::fs::write(path("text.gltf"), numbers.document(&rest)).unwrap();
    std::fs::write(path("binary.glb"), numbers.glb(&rest)).unwrap();
    for (from, to) in [("text.gltf", "text.glb"), ("binary.glb", "binary.gltf")] {
        let mut file = SceneFile::read(path(from)).unwrap();
        let clip = wave(file.scene());
        file.add_clip(&clip, &WriteOptions::default()).unwrap();
        file.write(path(to)).unwrap();
        let (original, other) = (file.scene(), gltf::read(path(to)).unwrap());
        assert_eq!(
            (&original.armature, &original.meshes),
            (&other.armature, &other.meshes)
        );
        assert_eq!(sampled(original, 1), sampled(&other, 1));
        let written = std::fs::read(path(to)).unwrap();
        assert_eq!(written.starts_with(b"glTF"), to.ends_with(".glb"));
        assert!(text(&written).contains(r#""wind" :[ 0,0 , 1.50 ]"#));
    }
}
