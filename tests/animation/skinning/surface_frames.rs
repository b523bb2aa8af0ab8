//! Promise: normals stay orthogonal to a skinned surface and tangents stay in it. This includes bones with uneven
//! scale, shear or reflection, and their blends.

use glam::{Affine3A, DMat3, DVec3, Mat3A, Vec3, Vec4};
use kinopt::skinning::{Deformation, LinearBlend, SkinWeights};
use support::random::Random;

const VERTICES: usize = 60;

fn direction(random: &mut Random) -> DVec3 {
    DVec3::from(<[f64; 3]>::from(*random.direction()))
}

/// A well-conditioned map; every other one is a reflection.
fn map(random: &mut Random, mirrors: bool) -> DMat3 {
    loop {
        let columns = [0, 1, 2].map(|_| DVec3::from(<[f64; 3]>::from(random.vector(1.5))));
        let m = DMat3::from_cols_array_2d(&columns.map(|c| c.to_array()));
        let m = if (m.determinant() < 0.0) == mirrors {
            m
        } else {
            -m
        };
        if m.determinant().abs() > 0.3 {
            return m;
        }
    }
}

fn single(m: DMat3, random: &mut Random) -> Affine3A {
    Affine3A {
        matrix3: Mat3A::from(m.as_mat3()),
        translation: Vec3::from_array(<[f64; 3]>::from(random.vector(2.0)).map(|v| v as f32))
            .into(),
    }
}

#[test]
fn frames_stay_orthonormal_under_any_bones() {
    let mut random = Random::new(1);
    for case in 0..20 {
        // Two similar maps, so that their blend is regular; both may be reflections.
        let first = map(&mut random, case % 2 == 1);
        let second =
            DMat3::from_rotation_y(0.3) * first * DMat3::from_diagonal(DVec3::new(1.2, 0.8, 1.0));
        let bones = [first, second];
        let transforms = bones.map(|m| single(m, &mut random));
        let mut builder = SkinWeights::builder(VERTICES, 2);
        let mut rest = Vec::new();
        for vertex in 0..VERTICES {
            let share = random.unit();
            builder.add(vertex, 0, share).unwrap();
            builder.add(vertex, 1, 1.0 - share).unwrap();
            let normal = direction(&mut random);
            let tangent = normal.cross(direction(&mut random)).normalize();
            let sign = if random.unit() < 0.5 { -1.0 } else { 1.0 };
            rest.push((share, normal, tangent, sign));
        }
        let weights = builder.build().unwrap();
        let blend = LinearBlend::new(&weights, &transforms).unwrap();
        let normals: Vec<Vec3> = rest.iter().map(|(_, n, _, _)| n.as_vec3()).collect();
        let tangents: Vec<Vec4> = rest
            .iter()
            .map(|(_, _, t, w)| t.as_vec3().extend(*w as f32))
            .collect();
        let (mut turned, mut moved) = (vec![Vec3::ZERO; VERTICES], vec![Vec4::ZERO; VERTICES]);
        blend.normals(&normals, &mut turned).unwrap();
        blend.tangents(&tangents, &mut moved).unwrap();

        for (vertex, (share, normal, tangent, sign)) in rest.into_iter().enumerate() {
            let m = first * share + second * (1.0 - share);
            let (n, t) = (
                turned[vertex].as_dvec3(),
                moved[vertex].truncate().as_dvec3(),
            );
            // Directions of the surface follow the map.
            let bitangent = normal.cross(tangent) * sign;
            let [along, across] = [m * tangent, m * bitangent];
            assert!((t - along.normalize()).length() < 1e-4, "case {case}");
            for inside in [along, across] {
                assert!(n.dot(inside.normalize()).abs() < 1e-4, "case {case}");
            }
            assert!((n.length() - 1.0).abs() < 1e-6);
            // The outside stays outside, and the bitangent is on its side of the tangent.
            assert!(n.dot((m * normal).normalize()) > 0.0, "case {case}");
            let w = f64::from(moved[vertex].w);
            assert_eq!(w.abs(), 1.0);
            assert!((n.cross(t) * w).dot(across) > 0.0, "case {case}");
        }
    }
}
