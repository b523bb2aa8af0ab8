//! Promise: a mesh at `package://NAME/…` is found in the package whose `package.xml` has that name, whatever its folder
//! is called.

use std::fs;
use std::path::Path;

use kinopt::collision::CollisionModel;
use kinopt::robot::Robot;

/// A tetrahedron as OBJ.
const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

fn write(file: &Path, text: &str) {
    fs::create_dir_all(file.parent().unwrap()).unwrap();
    fs::write(file, text).unwrap();
}

fn manifest(name: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<package format=\"2\">\n  <name> {name} </name>\n</package>\n"
    )
}

fn robot(package: &str) -> String {
    format!(
        "<robot name='r'><link name='a'><collision><geometry><mesh filename='package://{package}/meshes/a.obj'/></geometry>\
         </collision></link></robot>"
    )
}

#[test]
fn package_is_found_by_the_name_in_its_manifest() {
    let root = std::env::temp_dir().join(format!("kinopt-manifests-{}", std::process::id()));
    let own = root.join("src/arm-support-main");
    write(&own.join("package.xml"), &manifest("arm_support"));
    write(&own.join("meshes/a.obj"), MESH);
    write(&root.join("src/other-1.2/package.xml"), &manifest("other"));
    write(&root.join("src/other-1.2/meshes/a.obj"), MESH);
    write(
        &root.join("elsewhere/far-away/package.xml"),
        &manifest("far"),
    );
    write(&root.join("elsewhere/far-away/meshes/a.obj"), MESH);
    let read = |package: &str| {
        let file = own.join("urdf/arm.urdf");
        write(&file, &robot(package));
        Robot::read(&file).unwrap()
    };
    // The package of the file, and a sibling.
    for package in ["arm_support", "other"] {
        let model = CollisionModel::of(&read(package));
        assert_eq!(model.unwrap().objects().len(), 1, "{package}");
    }
    // A package in a given folder, or that folder itself.
    for folder in ["elsewhere", "elsewhere/far-away"] {
        let robot = read("far");
        assert!(CollisionModel::of(&robot).is_err());
        let model = CollisionModel::builder(&robot).with_package_folder(root.join(folder));
        assert_eq!(model.build().unwrap().objects().len(), 1, "{folder}");
    }
    assert!(CollisionModel::of(&read("nowhere")).is_err());
    fs::remove_dir_all(&root).unwrap();
}
