//! Promise: a twisted tube collapses under linear blend by the theoretical amount, to a point in the middle of a half
//! turn. Under dual quaternions it keeps its shape.

use std::f64::consts::PI;
use support::twisted_tube::TwistedTube;

use kinopt::mesh::TriangleMesh;
use kinopt::skinning::SkinningMethod;

fn twisted(tube: &TwistedTube, method: SkinningMethod, twist: f64) -> TriangleMesh {
    let transforms = TwistedTube::transforms(twist);
    method
        .mesh(&tube.mesh().unwrap(), &tube.weights().unwrap(), &transforms)
        .unwrap()
}

/// Position along the axis and radius of the narrowest ring.
fn waist(tube: &TwistedTube, posed: &TriangleMesh) -> (f64, f64) {
    let rings = tube.ring_radii(posed);
    assert_eq!(rings.len(), tube.rings as usize);
    rings
        .into_iter()
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap()
}

#[test]
fn tube_is_closed_with_the_volume_of_a_prism() {
    for tube in [
        TwistedTube::default(),
        TwistedTube {
            radius: 0.25,
            length: 3.0,
            sides: 5,
            rings: 2,
            ..TwistedTube::default()
        },
    ] {
        let mesh = tube.mesh().unwrap();
        assert!(mesh.is_closed());
        let sides = f64::from(tube.sides);
        let area = 0.5 * sides * (2.0 * PI / sides).sin() * tube.radius * tube.radius;
        assert!((mesh.signed_volume() / (area * tube.length) - 1.0).abs() < 1e-6);
        assert_eq!(
            tube.weights().unwrap().vertex_count(),
            mesh.positions().len()
        );
    }
}

#[test]
fn linear_blend_collapses_like_a_candy_wrapper() {
    let tube = TwistedTube::default();
    let rest_volume = tube.mesh().unwrap().signed_volume();
    for degrees in [0.0_f64, 45.0, 90.0, 135.0, 180.0] {
        let twist = degrees.to_radians();
        let posed = twisted(&tube, SkinningMethod::LinearBlend, twist);
        // The middle ring is the mean of two rings: |½ + ½ e^{iφ}| = cos(φ/2).
        let (centre, radius) = waist(&tube, &posed);
        assert!(
            (radius - (twist / 2.0).cos()).abs() < 1e-6,
            "{degrees}: {radius}"
        );
        assert!(degrees == 0.0 || centre == tube.length / 2.0);
        let volume_ratio = posed.signed_volume() / rest_volume;
        let expected = 1.0 - tube.blended_share * (1.0 - twist.cos()) / 3.0;
        assert!(
            (volume_ratio - expected).abs() < 2e-3,
            "{degrees}°: {volume_ratio}, not {expected}"
        );
    }
    // At half a turn it vanishes.
    let half_turn = twisted(&tube, SkinningMethod::LinearBlend, PI);
    assert!(waist(&tube, &half_turn).1 < 1e-6);
}

#[test]
fn dual_quaternions_keep_the_radius_of_every_ring() {
    let tube = TwistedTube::default();
    let rest_volume = tube.mesh().unwrap().signed_volume();
    for degrees in [0.0_f64, 45.0, 90.0, 135.0, 180.0] {
        let posed = twisted(&tube, SkinningMethod::DualQuaternion, degrees.to_radians());
        let rings = &posed.positions()[..(tube.rings * tube.sides) as usize];
        for p in rings {
            let distance = f64::from(p.y).hypot(f64::from(p.z));
            assert!(
                (distance - tube.radius).abs() < 1e-6,
                "{degrees}°: {distance}"
            );
        }
        // The rest is the loss of flat triangles between rings that rotate against each other.
        let volume_ratio = posed.signed_volume() / rest_volume;
        assert!(
            (0.995..1.0001).contains(&volume_ratio),
            "{degrees}°: {volume_ratio}"
        );
    }
}
