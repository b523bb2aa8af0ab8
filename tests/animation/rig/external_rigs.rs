//! Promise: rigs of other programs are read and round trip through files.
//!
//! They have no licence and are not shipped: `KINOPT_SHARED` names the folder that has them under `rigs/`.
#![allow(clippy::print_stderr)] // Reports that nothing was tested.

use kinopt::io::rig::Rig;

#[test]
fn external_rigs_are_read_and_round_trip() {
    let Some(shared) = std::env::var_os("KINOPT_SHARED") else {
        eprintln!("SKIPPED: KINOPT_SHARED is not set, so no rigs of others were read");
        return;
    };
    let mut read = 0;
    for entry in std::fs::read_dir(std::path::Path::new(&shared).join("rigs")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let rig = Rig::read(&path).unwrap();
        let (mesh, weights) = (rig.mesh.as_ref().unwrap(), rig.weights.as_ref().unwrap());
        assert_eq!(mesh.positions().len(), weights.vertex_count());
        assert!(mesh.size() > 0.0 && !rig.constrained.is_empty());

        let folder = std::env::temp_dir().join(format!("kinopt-others-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let written = rig.write(folder.join("rig.json"));
        let again = Rig::read(folder.join("rig.json"));
        std::fs::remove_dir_all(&folder).unwrap();
        written.unwrap();
        let again = again.unwrap();
        assert_eq!(again.skeleton.bones(), rig.skeleton.bones());
        assert_eq!(again.mesh, rig.mesh);
        assert_eq!(again.weights, rig.weights);
        assert_eq!(again.clip, rig.clip);
        assert_eq!(again.constrained, rig.constrained);
        read += 1;
    }
    assert!(read > 0, "the folder has no rigs");
}
